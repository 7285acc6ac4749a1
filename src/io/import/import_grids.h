#pragma once

#include <openvdb/openvdb.h>

#include <cstdint>
#include <functional>
#include <string>

namespace raymap {

/// Returns the grid of a file with this name.
using GridReader = std::function<openvdb::GridBase::Ptr(const std::string& name)>;

/// Writes grids of a file to standard output. `grids` tells what all of them are, without their values. See
/// `sendVdb`.
void sendGrids(const openvdb::GridPtrVec& grids, const GridReader& read, const std::string& gridName,
               uint64_t mostDense);

/// Keeps oneTBB, which OpenVDB uses even to free its trees, from starting threads. They would need address
/// space for their stacks, and a confined process cannot start any.
void useOneThread();

}  // namespace raymap
