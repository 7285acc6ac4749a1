#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/3mf/model_part.h"

namespace raymap {

/// A part of an object: some of its triangles, or one of its components.
struct SlicerPart {
  PartUse use = PartUse::Print;
  std::optional<std::pair<uint32_t, uint32_t>> triangles;  ///< First and last one.
  std::optional<uint32_t> component;                       ///< The object that the component places.
  std::string where;                                       ///< Part of the package and line, for messages.
};

/// Reads what the projects of PrusaSlicer, Orca and Bambu Studio say about the parts of objects. Returns
/// those of each object of the root part by its id; none for files of other programs.
std::map<uint32_t, std::vector<SlicerPart>> readSlicerParts(ZipParts& parts);

/// Removes all parts from `object` that are not printed, and returns their counts. Fails if a part has
/// triangles that the object lacks.
PartCounts removeUnprinted(const MeshFile& file, Object3mf& object, const std::vector<SlicerPart>& parts);

/// Returns the parts that steer the slicer, in words: "2 modifiers and 1 support blocker".
std::string unprintedParts(const PartCounts& counts);

}  // namespace raymap
