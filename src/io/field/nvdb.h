#pragma once

#include <openvdb/Grid.h>

#include <ostream>

namespace raymap {

/// Name of the blind data of a grid in a .nvdb that holds OpenVDB's metadata, as OpenVDB writes it.
inline constexpr const char* kNvdbMetadataName = "openvdb_metadata";

/// Writes grids of floats and 32-bit integers as a file of NanoVDB without compression. Floats that OpenVDB
/// would save as halves become NanoVDB's Fp16, which must be finite: each leaf divides the range of its
/// values into 65,535 equal steps. Takes each grid from the list, so that no two copies of all exist.
void putNvdb(std::ostream& out, openvdb::GridPtrVec& grids);

}  // namespace raymap
