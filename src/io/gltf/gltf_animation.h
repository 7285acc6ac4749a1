#pragma once

#include <raymap/animation.h>

#include <span>

#include "io/gltf/gltf_scene.h"

namespace raymap {

/// What `animations[animation]` of a file does to the nodes of its scene; `places` says where among the
/// scene's each of the file's nodes is, -1 = nowhere. Nothing if the file has no animation at all.
std::vector<AnimatedMesh::Track> readTracks(const MeshFile& file, const GltfScene& scene, uint64_t animation,
                                            std::span<const int> places);

}  // namespace raymap
