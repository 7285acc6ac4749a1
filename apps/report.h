#pragma once

#include <raymap/repair.h>
#include <raymap/words.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "terminal.h"

namespace raymap {

using Json = nlohmann::ordered_json;  // Files that make some include raymap/json.h.

/// Returns a number of bytes as "1.23 GB".
std::string sizeText(size_t bytes);

inline double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Does the work of a step of a command, and appends its name and time to `steps`.
template <class Work>
void timeStep(std::vector<Stats::Stage>& steps, const char* name, Work&& work) {
  const Clock::time_point start = Clock::now();
  work();
  steps.push_back({name, millisecondsSince(start)});
}

/// Returns a line for each step, one for the rest of the time that has elapsed, and one for all of it. The
/// rest lies between the steps: checks of the mesh, and freeing memory.
std::string describeTimes(const std::vector<Stats::Stage>& steps, double elapsedMilliseconds);

/// Returns the step that took the longest, with all steps of its name taken together.
Stats::Stage slowestStep(const std::vector<Stats::Stage>& steps);

/// Returns why a repair on this grid takes long, and what to do about it; empty if it does not.
std::string whyItTakesLong(const RepairGrid& grid);

/// Prints which faces were reversed and left out, if any.
void printOrientation(const Stats& stats);

/// Returns what all figures say about a grid.
Json figuresOf(const Grid& grid);

/// Writes a file of JSON.
void writeJson(const std::filesystem::path& path, const Json& json);

/// Prints "wrote scan.vdb, 1.23 MB".
void printWritten(const std::filesystem::path& path);

/// Returns the most memory that this process has held, in bytes.
size_t peakMemory();

}  // namespace raymap
