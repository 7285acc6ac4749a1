#include "terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/io.h>
#include <raymap/json.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <string>
#include <utility>

#include "warnings.h"

namespace raymap {

namespace {

constexpr auto kQuietTime = std::chrono::seconds(1);

std::atomic<int> caught{0};
std::atomic<bool> isCancellable{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

constexpr unsigned kPatience = 2;  // Seconds that the work has to stop after a cancellation.

extern "C" void onSignal(int signal) {
  if (signal == SIGALRM)
    signal = caught;
  else if (isCancellable && caught.exchange(signal) == 0) {
    alarm(kPatience);
    return;
  }
  removeTemporaries();
  _exit(128 + signal);
}

extern "C" void onQuit(int signal) {
  removeTemporaries();
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // For the core that the user wants.
}

/// Keeps ignoring a signal that the program was started to ignore, as nohup does.
void catchUnlessIgnored(int signal, void (*handler)(int)) {
  if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

std::string dataPath;        // Path of stdout, if that is kept for data.
int dataFile = -1;           // Its descriptor.
bool isPipeIgnored = false;  // Whether the program was started to ignore SIGPIPE.

TextLevel textLevel = TextLevel::Normal;
bool isTextKept = false;
std::optional<ProgressStyle> askedStyle;
std::string subject;  // What warnings and errors are about, with a colon; empty if they say it.
const auto kStartTime = Clock::now();

/// Ends the program as a closed pipe ends other tools; returns if it was started to ignore that.
void endByPipe() {
  if (isPipeIgnored) return;
  removeTemporaries();
  std::signal(SIGPIPE, SIG_DFL);
  std::raise(SIGPIPE);
}

/// Replaces a path by a name wherever it is a word of its own.
void rename(std::string& text, const std::string& path, std::string_view name) {
  const auto isOfWord = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '_' || c == '.' || c == '-';
  };
  for (size_t at = text.find(path); at != std::string::npos; at = text.find(path, at)) {
    const size_t end = at + path.size();
    const bool isWord = (at == 0 || !isOfWord(text[at - 1])) && (end == text.size() || !isOfWord(text[end]));
    if (isWord) text.replace(at, path.size(), name);
    at += isWord ? name.size() : path.size();
  }
}

std::string withSubject(const std::string& message) {
  return withDisplayNames((message.starts_with(subject) ? "" : subject) + message);
}

/// Returns the one printer of the program.
ProgressPrinter& printer() {
  static ProgressPrinter only(
      stderr, askedStyle.value_or(defaultProgressStyle(textLevel, isatty(STDERR_FILENO) == 1)), kStartTime);
  return only;
}

/// Returns how long to wait after a line of progress.
Clock::duration pauseOf(ProgressStyle style) {
  switch (style) {
    case ProgressStyle::Moving:
      return std::chrono::milliseconds(100);
    case ProgressStyle::Plain:
      return std::chrono::minutes(1);
    default:
      return std::chrono::seconds(1);
  }
}

double secondsBetween(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// A character of a text in UTF-8, or a byte that is none.
struct Character {
  size_t bytes;
  bool isShown;  ///< Whether it neither commands a terminal, nor turns the text's direction, nor ends a line.
};

Character firstOf(std::string_view text) {
  const auto byte = [&](size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
  const unsigned lead = byte(0);
  const size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : lead >= 0xc0 ? 2 : 1;
  uint32_t code = bytes > 1 ? lead & (0xffu >> (bytes + 1)) : lead;
  for (size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xc0u) != 0x80) return {1, true};
    code = code << 6 | (byte(k) & 0x3fu);
  }
  const auto isIn = [code](uint32_t first, uint32_t last) { return code >= first && code <= last; };
  const bool isControl = isIn(0, 0x1f) || isIn(0x7f, 0x9f);
  const bool isTurn = code == 0x61c || isIn(0x200e, 0x200f) || isIn(0x2028, 0x202e) || isIn(0x2066, 0x2069);
  return {bytes, !isControl && !isTurn};
}

void appendEscaped(std::string& text, char byte) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto value = static_cast<unsigned char>(byte);
  text += {'\\', 'x', kDigits[value / 16], kDigits[value % 16]};
}

/// Fails because a file is of the other kind than a command reads. Names the command that converts it.
[[noreturn]] void failKind(const std::filesystem::path& path, const std::string& kinds,
                           const std::string& command, const char* extension) {
  std::filesystem::path result = path.string().starts_with("/dev/") ? "result" : path.filename();
  result.replace_extension(extension);
  throw Error(ErrorCode::Usage, path.string() + ": it is " + kinds +
                                    " is needed; this makes one of it: raymap " + command + " " +
                                    asArgument(path) + " -o " + quoted(result.string()));
}

std::variant<Mesh, Field> load(const std::filesystem::path& path, ReadOptions options) {
  const WaitingLine line("reading " + briefName(path));
  options.warn = warn;
  options.levelSet = LevelSet::NarrowIfLarge;
  return read(path, options);
}

}  // namespace

std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const Character first = firstOf(text);
    for (const char byte : text.substr(0, first.bytes))
      if (first.isShown)
        result += byte;
      else
        appendEscaped(result, byte);
    text.remove_prefix(first.bytes);
  }
  return result;
}

std::string quoted(const std::string& argument) {
  const auto isPlain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string("._-/+,:=@%").find(c) != std::string::npos || (c & 0x80) != 0;
  };
  if (!argument.empty() && std::ranges::all_of(argument, isPlain)) return argument;
  const bool isEscaped = printable(argument) != argument;
  std::string words = isEscaped ? "$'" : "'";
  for (const char c : argument) {
    if (c == '\'') words += isEscaped ? "\\" : "'\\'";
    if (c == '\\' && isEscaped) words += c;
    words += c;
  }
  return printable(words) + "'";
}

void setSubject(const std::filesystem::path& file) {
  subject = file.empty() ? "" : file.string() + ": ";
}

void printWarning(std::string_view message) {
  printer().interrupt("raymap: warning: " + withSubject(std::string(message)));
}

void printError(const std::string& message) {
  printer().interrupt("raymap: error: " + withSubject(message));
}

void printNote(const std::string& line) {
  std::fprintf(isTextKept ? stderr : stdout, "%s\n", withDisplayNames(line).c_str());
}

void catchSignals() {
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) std::signal(signal, onSignal);
  for (const int signal : {SIGHUP, SIGXCPU}) catchUnlessIgnored(signal, onSignal);
  catchUnlessIgnored(SIGQUIT, onQuit);
  // Writing to a closed pipe fails; what becomes of it depends on the pipe.
  isPipeIgnored = std::signal(SIGPIPE, SIG_IGN) == SIG_IGN;
}

int caughtSignal() {
  return caught;
}

std::vector<std::string> progressStyleNames() {
  return {"plain", "json", "off"};
}

void setProgressStyle(const std::string& name) {
  askedStyle = name == "plain"  ? ProgressStyle::Plain
               : name == "json" ? ProgressStyle::Json
                                : ProgressStyle::Off;
}

ProgressStyle defaultProgressStyle(TextLevel level, bool isTerminal) {
  if (level == TextLevel::Quiet) return ProgressStyle::Off;
  return level == TextLevel::Normal && isTerminal ? ProgressStyle::Moving : ProgressStyle::Plain;
}

ProgressPrinter::ProgressPrinter(std::FILE* file, ProgressStyle style, Clock::time_point start)
    : file_(file), style_(style), start_(start), begun_(start), next_(start + pauseOf(style)) {}

void ProgressPrinter::begin(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  begun_ = now;
  stage_.clear();
  if (style_ == ProgressStyle::Moving) next_ = now + kQuietTime;
}

void ProgressPrinter::show(std::string_view stage, std::optional<double> done, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const bool isNew = style_ == ProgressStyle::Json && stage != stage_;
  if (style_ == ProgressStyle::Off || (now < next_ && !isNew)) return;
  stage_ = stage;
  next_ = now + pauseOf(style_);
  print(stage, done, now);
}

void ProgressPrinter::print(std::string_view stage, std::optional<double> done, Clock::time_point now) {
  const std::string name(stage);
  const double seconds = secondsBetween(start_, now);
  const int percent = int(std::lround(100.0 * done.value_or(0.0)));
  if (style_ == ProgressStyle::Json) {
    nlohmann::ordered_json json{
        {"stage", name}, {"done", nullptr}, {"seconds", std::round(100.0 * seconds) / 100.0}};
    if (done) json["done"] = std::round(1000.0 * *done) / 1000.0;
    std::fputs(textOf(json, -1).c_str(), file_);
  } else if (style_ == ProgressStyle::Plain && done)
    std::fprintf(file_, "raymap: %.0f s: %s %d %%\n", seconds, name.c_str(), percent);
  else if (style_ == ProgressStyle::Plain)
    std::fprintf(file_, "raymap: %.0f s: %s\n", seconds, name.c_str());
  else if (done)
    std::fprintf(file_, "\r\033[K  %s %3d %%", name.c_str(), percent);
  else
    std::fprintf(file_, "\r\033[K  %s, %.0f s", name.c_str(), secondsBetween(begun_, now));
  isShown_ = style_ == ProgressStyle::Moving;
}

void ProgressPrinter::interrupt(const std::string& line) {
  const std::lock_guard lock(mutex_);
  removeMovingLine();
  std::fprintf(file_, "%s\n", line.c_str());
}

void ProgressPrinter::clear() {
  const std::lock_guard lock(mutex_);
  removeMovingLine();
}

void ProgressPrinter::removeMovingLine() {
  if (isShown_) std::fputs("\r\033[K", file_);
  isShown_ = false;
}

ProgressLine::ProgressLine() {
  isCancellable = true;
  printer().begin(Clock::now());
}

ProgressLine::~ProgressLine() {
  isCancellable = false;
  clear();
}

void ProgressLine::clear() {
  printer().clear();
}

void ProgressLine::nameStage(std::string_view stage) {
  if (stage == stage_) return;
  stage_ = stage;
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.2f", secondsBetween(kStartTime, Clock::now()));
  printer().interrupt("raymap: " + std::string(seconds.data()) + " s: " + stage_);
}

bool ProgressLine::report(std::string_view stage, double done) {
  if (textLevel == TextLevel::Verbose) nameStage(stage);
  printer().show(stage, done, Clock::now());
  return caught == 0;
}

WaitingLine::WaitingLine(const std::string& task) {
  if (textLevel == TextLevel::Verbose) printer().interrupt("raymap: " + task);
  printer().begin(Clock::now());
  if (printer().style() != ProgressStyle::Off) thread_ = std::thread([this, task] { show(task); });
}

WaitingLine::~WaitingLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    isOver_ = true;
  }
  end_.notify_one();
  thread_.join();
  printer().clear();
}

void WaitingLine::show(const std::string& task) {
  std::unique_lock lock(mutex_);
  while (!end_.wait_for(lock, kQuietTime, [this] { return isOver_; }))
    printer().show(task, std::nullopt, Clock::now());
}

void setTextLevel(TextLevel level) {
  textLevel = level;
}

bool isVerbose() {
  return textLevel == TextLevel::Verbose;
}

void keepText() {
  isTextKept = true;
}

void silenceText() {
  if (textLevel != TextLevel::Quiet || isTextKept) return;
  std::fflush(stdout);
  if (std::freopen("/dev/null", "w", stdout) == nullptr)
    throw Error(ErrorCode::File, "/dev/null: cannot be opened");
}

std::filesystem::path keepStdoutForData() {
  std::fflush(stdout);
  constexpr int kFirst = 10;  // Above the descriptors that shells use.
  const int data = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, kFirst);
  if (data < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    throw Error(ErrorCode::File, "standard output: cannot write: it is closed");
  dataFile = data;
  dataPath = "/dev/fd/" + std::to_string(data);
  return dataPath;
}

std::string displayName(const std::filesystem::path& path) {
  return withDisplayNames(path.string());
}

std::string briefName(const std::filesystem::path& path) {
  const std::string name = displayName(path);
  return name == printable(path.string()) ? printable(path.filename().string()) : name;
}

std::string asArgument(const std::filesystem::path& path) {
  return path == "/dev/stdin" ? "-" : quoted(path.string());
}

std::string withDisplayNames(std::string message) {
  rename(message, "/dev/stdin", "standard input");
  rename(message, "/dev/stdout", "standard output");
  if (!dataPath.empty()) rename(message, dataPath, "standard output");
  return printable(message);
}

void finishText() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  const int error = errno;
  if (error == EPIPE) endByPipe();
  throw Error(ErrorCode::File,
              std::string("standard output: cannot write the text: ") +
                  (error == EPIPE ? "the program that reads it has ended" : std::strerror(error)));
}

void endIfReaderEnded(const Error& error) {
  if (dataPath.empty() || !std::string_view(error.what()).starts_with(dataPath + ":")) return;
  pollfd file{.fd = dataFile, .events = 0, .revents = 0};
  if (poll(&file, 1, 0) == 1 && (file.revents & POLLERR) != 0) endByPipe();
}

std::variant<Mesh, Field> loadMeshOrField(const std::filesystem::path& path, const std::string& format,
                                          const std::string& grid, std::vector<glm::dvec3>* exact,
                                          MeshAttributes* attributes) {
  return load(path, {.format = format, .gridName = grid, .exact = exact, .attributes = attributes});
}

Mesh loadMesh(const std::filesystem::path& path, const std::string& format, bool allowEmpty,
              MeshAttributes* attributes) {
  std::variant<Mesh, Field> read =
      load(path, {.format = format, .allowEmpty = allowEmpty, .attributes = attributes});
  if (Mesh* mesh = std::get_if<Mesh>(&read)) return std::move(*mesh);
  failKind(path, "a field, and a mesh", "mesh", ".ply");
}

Field loadField(const std::filesystem::path& path, const std::string& format, const std::string& grid) {
  std::variant<Mesh, Field> read = load(path, {.format = format, .gridName = grid});
  if (Field* field = std::get_if<Field>(&read)) return std::move(*field);
  failKind(path, "a mesh, and a field", "generate", ".npz");
}

}  // namespace raymap
