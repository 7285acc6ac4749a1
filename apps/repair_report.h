#pragma once

#include <raymap/repair.h>

#include <filesystem>
#include <vector>

#include "checks.h"
#include "field_options.h"
#include "mesh_output.h"
#include "mesh_units.h"
#include "report.h"

namespace raymap {

struct RepairArguments : FieldArguments {
  StreamFormat format;
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path mesh, result, stats;
  RepairOptions repair;
  std::vector<double> down, cutPlane;
  bool isSplit = false;
};

/// Returns whether a result is what `raymap repair` promises: watertight, with its faces outwards.
bool isSound(const Diagnostics& found);

/// Returns all figures of a repair, as `--stats` writes them.
Json describe(const RepairArguments& arguments, const Grid& grid, const RepairReport& report,
              const std::vector<Stats::Stage>& steps, const MeshWriteOptions& written);

/// Returns what a repair did, in a word.
const char* wordFor(const RepairReport& report);

/// Prints what a repair did, for people.
void print(const RepairArguments& arguments, const RepairGrid& grid, const RepairReport& report);

}  // namespace raymap
