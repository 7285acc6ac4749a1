#pragma once

#include <raymap/callbacks.h>
#include <raymap/error.h>
#include <raymap/field.h>
#include <raymap/mesh.h>
#include <raymap/mesh_attributes.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

namespace raymap {

/// Returns a text without characters that a terminal would obey, or that turn the direction of the text
/// around them: "\x1b" stands for the escape character. File names may hold any.
std::string printable(std::string_view text);

/// Returns an argument as a shell takes it; as bash does, if it has control characters.
std::string quoted(const std::string& argument);

/// Names the file that warnings and errors are about from now on. They begin with it; an
/// empty path: none.
void setSubject(const std::filesystem::path& file);

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

/// Returns whether figures for experts are wanted, such as the time of each stage.
bool isVerbose();

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

/// How progress is shown.
enum class ProgressStyle : uint8_t {
  Moving,  ///< One line that changes, after the first second of each piece of work.
  Plain,   ///< A line a minute, without control characters.
  Json,    ///< An object a line: as each stage begins, and every second.
  Off,
};

/// Returns the names of the styles that can be asked for.
std::vector<std::string> progressStyleNames();

/// Sets the style by its name, before any work begins.
void setProgressStyle(const std::string& name);

/// Returns the style unless one was asked for. The lines of `TextLevel::Verbose` leave no place for a moving
/// one.
ProgressStyle defaultProgressStyle(TextLevel level, bool isTerminal);

using Clock = std::chrono::steady_clock;

/// Prints where the work is, as often as the style asks for. Any thread may call it.
class ProgressPrinter {
 public:
  /// `start` is when the program began.
  ProgressPrinter(std::FILE* file, ProgressStyle style, Clock::time_point start);

  ProgressStyle style() const { return style_; }
  /// Begins a piece of work.
  void begin(Clock::time_point now);
  /// Prints the stage if it is time to. `done` is its share, 0 to 1, if that is known.
  void show(std::string_view stage, std::optional<double> done, Clock::time_point now);
  /// Prints another line, and removes the moving one.
  void interrupt(const std::string& line);
  /// Removes the moving line.
  void clear();

 private:
  void print(std::string_view stage, std::optional<double> done, Clock::time_point now);
  void removeMovingLine();

  std::FILE* file_;
  ProgressStyle style_;
  Clock::time_point start_, begun_, next_;
  std::mutex mutex_;
  std::string stage_;
  bool isShown_ = false;
};

/// Shows the progress on stderr, and lets signals cancel the work. With `TextLevel::Verbose`, also names each
/// stage as it begins.
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
  /// Removes the moving line.
  void clear();

 private:
  bool report(std::string_view stage, double done);
  void nameStage(std::string_view stage);

  std::string stage_;
};

/// Shows on stderr how long a task has taken that cannot tell its progress.
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

/// Returns "standard input" or "standard output" for a path that leads there, any other path as printable
/// text.
std::string displayName(const std::filesystem::path& path);

/// Returns the same without folders.
std::string briefName(const std::filesystem::path& path);

/// Returns a message as printable text, with these names in place of the paths.
std::string withDisplayNames(std::string message);

/// Returns a path as an argument of a command: "-" for standard input.
std::string asArgument(const std::filesystem::path& path);

/// Throws `Error(File)` unless all text has reached stdout. Ends the program by SIGPIPE, as other tools end,
/// if the program that reads stdout has ended.
void finishText();

/// Ends the program by SIGPIPE if this error came from data for a program that has ended.
void endIfReaderEnded(const Error& error);

/// Reads a mesh or a field. Prints warnings and, after a second, how long it takes. `format` counts if the
/// name does not tell, and `grid` names that of a field to read. A large level set is read as a narrow band.
/// `exact` receives the positions of a mesh that are rounded in it; see `ReadOptions`.
std::variant<Mesh, Field> loadMeshOrField(const std::filesystem::path& path, const std::string& format = "",
                                          const std::string& grid = "",
                                          std::vector<glm::dvec3>* exact = nullptr,
                                          MeshAttributes* attributes = nullptr);
// Read one of both. Throw `Error(Usage)` that names the command which converts the other one. A mesh without
// triangles is an error, unless `allowEmpty`.
Mesh loadMesh(const std::filesystem::path& path, const std::string& format = "", bool allowEmpty = false,
              MeshAttributes* attributes = nullptr);
Field loadField(const std::filesystem::path& path, const std::string& format, const std::string& grid);

}  // namespace raymap
