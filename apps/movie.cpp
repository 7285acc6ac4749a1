#include "movie.h"

#include <fcntl.h>
#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ostream>
#include <sstream>
#include <string>

#include "terminal.h"

namespace raymap {

namespace {

/// Reads a file from its beginning, a part at a time. Throws `Error(File)`.
template <class Take>
void readAll(FILE* file, Take take) {
  std::array<char, 65536> part{};
  bool isGood = std::fseek(file, 0, SEEK_SET) == 0;
  for (size_t count = part.size(); isGood && count > 0;) {
    count = std::fread(part.data(), 1, part.size(), file);
    take(part.data(), count);
    isGood = std::ferror(file) == 0;
  }
  if (!isGood) throw Error(ErrorCode::File, "what ffmpeg has written into a temporary file cannot be read");
}

/// Starts ffmpeg, which reads pictures from its descriptor 0 and writes the movie into descriptor 3. Returns
/// an error number.
int start(const std::string& ffmpeg, pid_t& process, int pictures, int messages, int result, int width,
          int height, double fps) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height);
  std::array<char, 32> rate{};
  std::snprintf(rate.data(), rate.size(), "%.9g", fps);
  // H.264 with this layout of pixels plays everywhere, and wants even sides.
  const std::array<const char*, 22> words{
      "ffmpeg",         "-loglevel", "error",  "-f",        "rawvideo",
      "-pix_fmt",       "rgb24",     "-s",     size.data(), "-r",
      rate.data(),      "-i",        "pipe:0", "-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
      "-pix_fmt",       "yuv420p",   "-f",     "mp4",       "-y",
      "file:/dev/fd/3", nullptr};
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, pictures, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, messages, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&files, result, 3);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  rlimit own{};  // A strict limit of this process (limitMemory) is not one of ffmpeg.
  getrlimit(RLIMIT_DATA, &own);
  const rlimit whole{own.rlim_max, own.rlim_max};
  setrlimit(RLIMIT_DATA, &whole);
  const int error =
      posix_spawn(&process, ffmpeg.c_str(), &files, nullptr, const_cast<char* const*>(words.data()), environ);
  setrlimit(RLIMIT_DATA, &own);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

/// Returns a descriptor above those that ffmpeg gets, which it does not inherit.
int moved(int descriptor) {
  const int result = fcntl(descriptor, F_DUPFD_CLOEXEC, 10);
  close(descriptor);
  return result;
}

int closeFile(FILE* file) {
  return file == nullptr ? 0 : std::fclose(file);
}

}  // namespace

std::filesystem::path findFfmpeg(const std::filesystem::path& movie) {
  const char* const folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');)
    if (const auto path = std::filesystem::path(folder) / "ffmpeg";
        !folder.empty() && std::filesystem::is_regular_file(path) && access(path.c_str(), X_OK) == 0)
      return path;
  throw Error(ErrorCode::Unsupported, displayName(movie) +
                                          ": an MP4 needs ffmpeg, which no folder of PATH has; install it, "
                                          "or write pictures: " +
                                          movie.stem().string() + ".%04d.png");
}

Movie::Movie(const std::filesystem::path& path, int width, int height, double fps)
    : path_(path),
      width_(width),
      height_(height),
      result_(std::tmpfile(), closeFile),
      messages_(std::tmpfile(), closeFile),
      pictures_(nullptr, closeFile) {
  const std::string ffmpeg = findFfmpeg(path);
  int ends[2] = {-1, -1};
  if (!result_ || !messages_ || pipe2(ends, O_CLOEXEC) != 0)
    throw Error(ErrorCode::File, displayName(path_) + ": cannot make a temporary: " + std::strerror(errno));
  const int from = moved(ends[0]), result = fcntl(fileno(result_.get()), F_DUPFD_CLOEXEC, 10);
  const int messages = fcntl(fileno(messages_.get()), F_DUPFD_CLOEXEC, 10);
  pictures_.reset(fdopen(moved(ends[1]), "wb"));
  const int error = start(ffmpeg, process_, from, messages, result, width, height, fps);
  for (const int each : {from, messages, result}) close(each);
  if (error != 0) {
    process_ = -1;
    throw Error(ErrorCode::Unsupported,
                displayName(path_) + ": " + ffmpeg + " cannot be started: " + std::strerror(error));
  }
}

Movie::~Movie() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  wait();
}

/// Returns the exit code of ffmpeg; -1 if a signal ended it.
int Movie::wait() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Throws an error with the last line that ffmpeg printed.
void Movie::fail(const std::string& what) {
  std::string text;
  readAll(messages_.get(), [&](const char* data, size_t count) { text.append(data, count); });
  while (text.ends_with('\n')) text.pop_back();
  const size_t line = text.rfind('\n');
  throw Error(ErrorCode::File,
              displayName(path_) + ": ffmpeg " + what +
                  (text.empty() ? "" : ": " + text.substr(line == std::string::npos ? 0 : line + 1)));
}

void Movie::add(const Picture& picture) {
  if (picture.width != width_ || picture.height != height_)
    throw Error(ErrorCode::Input, displayName(path_) + ": a picture of " + std::to_string(picture.width) +
                                      " x " + std::to_string(picture.height) + " follows one of " +
                                      std::to_string(width_) + " x " + std::to_string(height_) +
                                      ": the frames have different grids");
  if (std::fwrite(picture.rgb.data(), 1, picture.rgb.size(), pictures_.get()) == picture.rgb.size()) return;
  wait();
  fail("ended before all pictures were written");
}

void Movie::finish() {
  const bool isWritten = std::fclose(pictures_.release()) == 0;
  if (const int code = wait(); code != 0 || !isWritten) fail("failed with the code " + std::to_string(code));
  writeAtomically(path_, [&](std::ostream& out) {
    readAll(result_.get(), [&](const char* data, size_t count) { out.write(data, std::streamsize(count)); });
  });
}

}  // namespace raymap
