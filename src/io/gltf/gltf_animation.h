#pragma once

#include <raymap/animation.h>

#include <span>

#include "io/gltf/gltf_scene.h"

namespace raymap {

/// Consecutive elements of a list.
struct IndexRange {
  uint32_t first = 0;
  uint32_t count = 0;
};

/// Returns the tracks of `animations[animation]` of a file for the nodes of its scene. `places` maps the
/// file's nodes to the scene's, -1 for nodes outside the scene. `morphs` are those of each node of the scene.
/// If the file has no animation, 0 gives no tracks; any other missing animation throws `Error(Usage)`.
std::vector<AnimatedMesh::Track> readTracks(const MeshFile& file, const GltfScene& scene, uint64_t animation,
                                            std::span<const int> places, std::span<const IndexRange> morphs);

/// Returns the names of all animations; the number of one without a name.
std::vector<std::string> animationNames(const GltfDocument& document);

/// Returns the index of the animation with this name, or else with this number; of the first one, if `clip`
/// is empty. Throws `Error`: Input if the file has no animation, Usage if it has no such.
uint64_t animationNamed(const MeshFile& file, const GltfDocument& document, const std::string& clip);

}  // namespace raymap
