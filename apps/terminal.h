#pragma once

#include <raymap/callbacks.h>
#include <raymap/field.h>
#include <raymap/mesh.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <variant>

namespace raymap {

/// Returns a text without control characters, which a terminal would obey: "\x1b" stands for the escape
/// character. File names may hold any.
std::string printable(std::string_view text);

/// Returns an argument as a shell takes it; as bash does, if it has control characters.
std::string quoted(const std::string& argument);

/// Prints `raymap: warning: ...` on stderr.
void printWarning(std::string_view message);

/// Prints `raymap: error: ...` on stderr.
void printError(const std::string& message);

/// Prints a line that is no result: on stderr, if the text on stdout is one.
void printNote(const std::string& line);

/// How much text a command prints.
enum class TextLevel : uint8_t { Quiet, Normal, Verbose };

/// Sets the level of all text from now on.
void setTextLevel(TextLevel level);

/// Makes `silenceText` keep stdout: the text is the result that was asked for.
void keepText();

/// Drops all text that is printed on stdout from now on, if the level is Quiet.
void silenceText();

/// Makes SIGINT, SIGTERM, SIGHUP and SIGXCPU end the program at once, without a half-written file. While a
/// `ProgressLine` lives, the first signal cancels the work through its callback instead. It ends the program
/// only if the work does not stop within two seconds. SIGQUIT always ends it at once, and leaves a core.
void catchSignals();

/// Returns the signal that cancelled the work, or 0.
int caughtSignal();

/// A line on stderr that shows the progress: only on a terminal, and only after a second. With
/// `TextLevel::Verbose`, lines that name each stage as it begins.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// Returns a callback that cancels the work after a signal. Valid while the line lives.
  ProgressCallback callback() {
    return [this](std::string_view stage, double done) { return report(stage, done); };
  }
  void clear();

 private:
  bool report(std::string_view stage, double done);
  void nameStage(std::string_view stage);

  using Clock = std::chrono::steady_clock;
  Clock::time_point next_;
  bool isTerminal_;
  bool isShown_ = false;
  std::string stage_;
};

/// A line on stderr that shows how long a task has taken that cannot tell its progress: only on a terminal,
/// and only after a second.
class WaitingLine {
 public:
  explicit WaitingLine(const std::string& task);
  ~WaitingLine();
  WaitingLine(const WaitingLine&) = delete;
  WaitingLine& operator=(const WaitingLine&) = delete;

 private:
  void show(const std::string& task);

  std::mutex mutex_;
  std::condition_variable end_;
  bool isOver_ = false;
  std::thread thread_;
};

/// Keeps stdout for data: text that is printed from now on goes to stderr. Returns the path that leads to
/// stdout. Throws `Error(File)` if it is closed.
std::filesystem::path keepStdoutForData();

/// Returns "standard output" for the path that `keepStdoutForData` returned, any other path as printable
/// text.
std::string displayName(const std::filesystem::path& path);

/// Returns a message as printable text, with that path replaced by its name.
std::string withDisplayNames(std::string message);

/// Throws `Error(File)` unless all text has reached stdout.
void finishText();

/// Reads a mesh or a field. Prints warnings and, after a second, how long it takes. `format` counts if the
/// name does not tell.
std::variant<Mesh, Field> loadMeshOrField(const std::filesystem::path& path, const std::string& format = "");
// Read one of both. Throw `Error(Usage)` that names the command which converts the other one.
Mesh loadMesh(const std::filesystem::path& path, const std::string& format = "");
Field loadFieldOnly(const std::filesystem::path& path, const std::string& format = "");

}  // namespace raymap
