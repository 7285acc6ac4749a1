#pragma once

#include <raymap/picture.h>
#include <sys/types.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace raymap {

/// Returns the path of ffmpeg. Throws `Error(Unsupported)` that names the movie if it is not installed.
std::filesystem::path findFfmpeg(const std::filesystem::path& movie);

/// An MP4 file of pictures. ffmpeg, a child process without a shell, gets them through a pipe. Nothing is
/// left of a movie that is not finished.
class Movie {
 public:
  /// Throws as `findFfmpeg` does.
  Movie(const std::filesystem::path& path, int width, int height, double fps);
  ~Movie();
  Movie(const Movie&) = delete;
  Movie& operator=(const Movie&) = delete;

  /// Throws `Error(Input)` if the picture has another size.
  void add(const Picture& picture);
  /// Waits for ffmpeg, and writes the file.
  void finish();

 private:
  using File = std::unique_ptr<FILE, int (*)(FILE*)>;

  [[noreturn]] void fail(const std::string& what);
  int wait();

  std::filesystem::path path_;
  int width_, height_;
  File result_, messages_;  ///< Files without a name.
  File pictures_;           ///< Pipe to ffmpeg.
  pid_t process_ = -1;
};

}  // namespace raymap
