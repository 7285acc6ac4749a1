#include "io/gltf/gltf_extensions.h"

#include <algorithm>
#include <array>

namespace raymap {

namespace {

/// Extensions of vertices, buffers and nodes that are read.
constexpr std::array<std::string_view, 6> kRead{"EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
                                                "KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                                "KHR_meshopt_compression",    "KHR_node_visibility"};

/// Beginnings of names, without the vendor, whose extensions change no shape: looks, light and sound.
constexpr std::array<std::string_view, 5> kLookNames{"materials_", "texture_", "lights_", "audio",
                                                     "environment_"};

/// More that change no shape at rest: notes, properties of features, physics, movement, and encodings of
/// polygons beside their triangles.
constexpr std::array<std::string_view, 28> kOthers{"AGI_articulations",
                                                   "AGI_stk_metadata",
                                                   "CESIUM_primitive_outline",
                                                   "EXT_collision",
                                                   "EXT_feature_metadata",
                                                   "EXT_instance_features",
                                                   "EXT_mesh_features",
                                                   "EXT_mesh_manifold",
                                                   "EXT_structural_metadata",
                                                   "FB_ngon_encoding",
                                                   "FB_geometry_metadata",
                                                   "KHR_animation_pointer",
                                                   "KHR_collision_shapes",
                                                   "KHR_implicit_shapes",
                                                   "KHR_interactivity",
                                                   "KHR_node_hoverability",
                                                   "KHR_node_selectability",
                                                   "KHR_physics_rigid_bodies",
                                                   "KHR_rigid_bodies",
                                                   "KHR_techniques_webgl",
                                                   "KHR_xmp",
                                                   "KHR_xmp_json_ld",
                                                   "MSFT_packing_normalRoughnessMetallic",
                                                   "MSFT_packing_occlusionRoughnessMetallic",
                                                   "OMI_physics_body",
                                                   "OMI_physics_shape",
                                                   "VRM",
                                                   "VRMC_vrm"};

}  // namespace

bool isReadableExtension(std::string_view name) {
  const std::string_view plain = name.substr(std::min(name.find('_') + 1, name.size()));
  const bool isLook =
      name.find("displacement") == name.npos &&
      std::ranges::any_of(kLookNames, [&](std::string_view each) { return plain.starts_with(each); });
  return isLook || std::ranges::find(kRead, name) != kRead.end() ||
         std::ranges::find(kOthers, name) != kOthers.end();
}

}  // namespace raymap
