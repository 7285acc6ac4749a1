#include "batch.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "commands.h"
#include "terminal.h"
#include "text.h"

namespace raymap {

namespace fs = std::filesystem;

namespace {

Row rowOf(const FileJob& job, const Outcome& outcome, double seconds) {
  const auto number = [](size_t count) { return count > 0 ? grouped(count) : "-"; };
  const size_t parts = outcome.figures.contains("parts") ? outcome.figures["parts"].size() : 0;
  return {displayName(job.input),
          outcome.done,
          number(outcome.trianglesBefore),
          number(outcome.trianglesAfter),
          outcome.volume ? numberText("%.6g", *outcome.volume) : "-",
          numberText("%.1f", seconds),
          displayName(job.output) + (parts > 0 ? " in " + counted(parts, "part") : "")};
}

/// Returns the extension of an output in a folder.
std::string extensionFor(const fs::path& input, const StreamFormat& format,
                         const std::vector<std::string>& writable, const char* usual) {
  if (format.given.empty()) return hasExtension(input, writable) ? input.extension().string() : usual;
  const std::string extension = lower((format.given.starts_with('.') ? "" : ".") + format.given);
  if (!hasExtension("x" + extension, writable))
    throw Error(ErrorCode::Usage, "--format " + format.given + ": must be one of " + joined(writable, " "));
  return extension;
}

/// Returns a job for each input. Takes --format if it is about files in a folder.
std::vector<FileJob> jobsOf(StreamFormat& format, const std::vector<fs::path>& inputs, const fs::path& output,
                            const std::vector<std::string>& writable, const char* usual) {
  const std::string start = "--output " + output.string() + ": ";
  if (!isFolder(output)) {
    if (inputs.size() > 1)
      throw Error(ErrorCode::Usage, start + "is one file for " + std::to_string(inputs.size()) +
                                        " meshes; name a folder for them, with a / at its end");
    return {{inputs.front(), output}};
  }
  std::vector<FileJob> jobs;
  std::map<fs::path, fs::path> named;
  for (const fs::path& input : inputs) {
    if (input == "-")
      throw Error(ErrorCode::Usage, start + "standard input has no name for a file in a folder; name a file");
    const auto [first, isNew] = named.emplace(input.stem(), input);
    if (!isNew)
      throw Error(ErrorCode::Usage, start + first->second.string() + " and " + input.string() +
                                        " would have the same name there; use a folder for each");
    jobs.push_back({input, output / (input.stem() += extensionFor(input, format, writable, usual))});
  }
  format.given.clear();  // It names no format of inputs.
  return jobs;
}

/// Does a job. Returns its exit code, and sets its row of the table and its figures.
int doOne(const FileJob& job, const std::function<Outcome(const FileJob&)>& work, Row& row, Json& figures) {
  const Clock::time_point start = Clock::now();
  try {
    Outcome outcome = work(job);
    row = rowOf(job, outcome, millisecondsSince(start) / 1000.0);
    figures = std::move(outcome.figures);
    return 0;
  } catch (const std::exception&) {
    const Failure failure = describeFailure();
    printError(failure.message);
    row = rowOf(job, {.done = "failed", .figures = {}}, millisecondsSince(start) / 1000.0);
    row[6] = "-";
    figures = {{"mesh", job.input.string()}, {"error", failure.kind}, {"message", failure.message}};
    return failure.code;
  }
}

}  // namespace

std::string numberText(const char* format, double number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, number);
  return text.data();
}

void printTable(const std::vector<Row>& rows) {
  std::vector<int> widths(rows.front().size());
  for (const Row& row : rows)
    for (size_t k = 0; k + 1 < row.size(); ++k) widths[k] = std::max(widths[k], int(row[k].size()));
  for (const Row& row : rows) {
    for (size_t k = 0; k < row.size(); ++k)
      std::printf("%s%*s", k == 0 ? "" : "  ", k < 2 ? -widths[k] : widths[k], row[k].c_str());
    std::printf("\n");
  }
}

bool isFolder(const fs::path& output) {
  return !output.has_filename() || fs::is_directory(output);
}

std::vector<FileJob> prepareJobs(StreamFormat& format, const std::vector<fs::path>& inputs,
                                 const fs::path& output, const std::vector<std::string>& readable,
                                 const std::vector<std::string>& writable, fs::path& stats,
                                 const char* usual) {
  std::vector<FileJob> jobs = jobsOf(format, inputs, output, writable, usual);
  std::vector<Input> read;
  std::vector<Output> written;
  for (FileJob& job : jobs) {
    read.push_back({job.input, readable});
    written.push_back({"--output", job.output, writable});
  }
  written.push_back({"--stats", stats, {".json"}});
  const bool isNew = isFolder(output) && !fs::exists(output);
  std::error_code failure;  // Whether there is a folder is checked with all files.
  if (isNew) fs::create_directories(output, failure);
  try {
    prepareFiles(format, read, written);
  } catch (...) {
    if (isNew) fs::remove(output, failure);
    throw;
  }
  return jobs;
}

void doAll(const std::vector<FileJob>& jobs, const fs::path& stats,
           const std::function<Outcome(const FileJob&)>& work) {
  std::vector<Row> rows{{"file", "done", "triangles", "after", "volume", "seconds", "output"}};
  Json figures = Json::array();
  int code = 0;
  for (size_t k = 0; k < jobs.size() && caughtSignal() == 0; ++k) {
    std::printf("file %zu of %zu: %s\n", k + 1, jobs.size(), displayName(jobs[k].input).c_str());
    setSubject(jobs[k].input);
    code = std::max(code, doOne(jobs[k], work, rows.emplace_back(), figures.emplace_back()));
    std::printf("\n");
    finishText();
  }
  setSubject({});
  printTable(rows);
  if (!stats.empty()) {
    writeJson(stats, figures);
    printWritten(stats);
  }
  finishText();
  if (code != 0) throw ExitCode(code);
}

}  // namespace raymap
