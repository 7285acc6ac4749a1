#pragma once

// Makes a mesh of each of several meshes.

#include <raymap/io.h>
#include <raymap/json.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "checks.h"
#include "report.h"

namespace raymap {

/// Result of a job, for the table and the figures.
struct Outcome {
  std::string done;  ///< "kept", for example.
  size_t trianglesBefore = 0, trianglesAfter = 0;
  std::optional<double> volume;
  Json figures;  ///< Figures that --stats writes.
};

/// A line of a table.
using Row = std::vector<std::string>;
std::string numberText(const char* format, double number);
/// Prints a table. Its columns from the third to the last but one are numbers.
void printTable(const std::vector<Row>& rows);

/// A mesh to read, and the file to make of it.
struct FileJob {
  std::filesystem::path input, output;
};

/// Returns whether --output names a folder: one that exists, or a name that ends in a slash.
bool isFolder(const std::filesystem::path& output);

/// Returns a job for each input, after `prepareFiles` for all files. In a folder each output has the name of
/// its input, and the format that --format names, or that of the input if it is `writable`, or else `usual`.
/// Makes the folder if there is none. Throws `Error(Usage)` if two inputs have one name, or if several are to
/// become one file.
std::vector<FileJob> prepareJobs(StreamFormat& format, const std::vector<std::filesystem::path>& inputs,
                                 const std::filesystem::path& output,
                                 const std::vector<std::string>& readable,
                                 const std::vector<std::string>& writable, std::filesystem::path& stats,
                                 const char* usual = ".stl");

/// Does jobs one after the other, also after one that fails, and prints a table. Writes all figures as an
/// array to `stats`, unless that is empty. Throws `ExitCode` with the highest exit code of a job, unless that
/// is 0.
void doAll(const std::vector<FileJob>& jobs, const std::filesystem::path& stats,
           const std::function<Outcome(const FileJob&)>& work);

/// Prepares the files of a command with `addMeshFileOptions`, and does its work: on a mesh with an output, or
/// on each of several meshes with a folder.
template <class Arguments>
void runOnEach(const Arguments& arguments, Outcome (*work)(Arguments&)) {
  Arguments all = arguments;
  const std::vector<FileJob> jobs =
      prepareJobs(all.format, all.meshes, all.result, meshExtensions(), writableMeshExtensions(), all.stats);
  const auto workOn = [&](const FileJob& job) {
    Arguments each = all;
    each.mesh = job.input;
    each.result = job.output;
    Outcome outcome = work(each);
    const bool isSplit = outcome.figures.contains("parts") && !outcome.figures["parts"].is_null();
    outcome.figures["result"] = isSplit ? Json() : Json(job.output.string());
    return outcome;
  };
  if (isFolder(all.result)) return doAll(jobs, all.stats, workOn);
  const Outcome outcome = workOn(jobs.front());
  if (all.stats.empty()) return;
  writeJson(all.stats, outcome.figures);
  printWritten(all.stats);
}

}  // namespace raymap
