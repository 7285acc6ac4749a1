#pragma once

#include <raymap/animation.h>

#include <span>

#include "io/gltf/gltf_scene.h"

namespace raymap {

/// Returns the tracks of `animations[animation]` of a file for the nodes of its scene. `places` maps the
/// file's nodes to the scene's, -1 for nodes outside the scene. If the file has no animation, 0 gives no
/// tracks; any other missing animation throws `Error(Usage)`.
std::vector<AnimatedMesh::Track> readTracks(const MeshFile& file, const GltfScene& scene, uint64_t animation,
                                            std::span<const int> places);

}  // namespace raymap
