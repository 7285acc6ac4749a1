// The functions of raymap/c.h about scenes.

#include <raymap/c.h>
#include <raymap/scene.h>

#include <memory>
#include <vector>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::copyTo;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

/// Adds a body that the caller owns.
template <class Shape>
void add(raymap_scene* scene, const char* name, const Shape& shape, const double* pose) {
  const std::shared_ptr<const Shape> referred(std::shared_ptr<const Shape>(), &shape);
  need(scene, "the scene").scene.add(&need(name, "the name"), referred, c::poseOf(pose));
}

/// Poses in many configurations, and what the library takes of them.
struct GivenConfigurations {
  std::vector<glm::dmat4> poses;
  Configurations view;
};

GivenConfigurations configurationsOf(const raymap_configurations& given, size_t bodies) {
  GivenConfigurations made;
  made.poses.resize(given.count * bodies);
  if (!made.poses.empty()) need(given.poses, "the array of poses");
  for (size_t i = 0; i < made.poses.size(); ++i) made.poses[i] = c::poseOf(given.poses + 16 * i);
  made.view = {made.poses, given.count, given.has_own_points};
  return made;
}

}  // namespace

raymap_scene* raymap_scene_create(void) {
  return create([] { return std::make_unique<raymap_scene>(); });
}

void raymap_scene_free(raymap_scene* scene) {
  delete scene;
}

raymap_result raymap_scene_add_surface(raymap_scene* scene, const char* name, const raymap_surface* surface,
                                       const double pose[16]) {
  return guard([&] { add(scene, name, need(surface, "the surface").surface, pose); });
}

raymap_result raymap_scene_add_field(raymap_scene* scene, const char* name, const raymap_field* field,
                                     const double pose[16]) {
  return guard([&] { add(scene, name, c::fieldOf(field), pose); });
}

raymap_result raymap_scene_remove(raymap_scene* scene, const char* name) {
  return guard([&] { need(scene, "the scene").scene.remove(&need(name, "the name")); });
}

raymap_result raymap_scene_set_pose(raymap_scene* scene, const char* name, const double pose[16]) {
  return guard([&] {
    need(scene, "the scene").scene.setPose(&need(name, "the name"), c::poseOf(&need(pose, "the pose")));
  });
}

size_t raymap_scene_size(const raymap_scene* scene) {
  return scene ? scene->scene.size() : 0;
}

raymap_result raymap_scene_number(const raymap_scene* scene, const char* name, uint32_t* number) {
  return guard(
      [&] { need(number, "the number") = need(scene, "the scene").scene.number(&need(name, "the name")); });
}

raymap_result raymap_scene_query(const raymap_scene* scene, const double* points, size_t count,
                                 const raymap_configurations* configurations, const raymap_options* options,
                                 const raymap_scene_arrays* arrays) {
  return guard([&] {
    const Scene& queried = need(scene, "the scene").scene;
    need(arrays, "raymap_scene_arrays");
    const raymap_scene_arrays wanted = c::read(arrays);
    if (count > 0) need(points, "the array of points");
    if (wanted.without_count > 0) need(wanted.without, "the array of bodies to leave out");
    const SceneOptions how{.distance = wanted.distance != nullptr,
                           .body = wanted.body != nullptr,
                           .closest = wanted.closest != nullptr,
                           .gradient = wanted.gradient != nullptr,
                           .distances = wanted.distances != nullptr,
                           .triangle = wanted.triangle != nullptr,
                           .maxDistance = c::optionsOr(options).scene.maxDistance,
                           .without = {wanted.without, wanted.without_count}};
    const PointsView view(points, count);
    const MachineOptions& machine = c::optionsOr(options).machine;
    SceneResult found;
    if (configurations) {
      const auto given = configurationsOf(c::read(configurations), queried.size());
      found = queried.query(view, given.view, how, machine);
    } else {
      found = queried.query(view, how, machine);
    }
    copyTo(wanted.distance, found.distance);
    copyTo(wanted.body, found.body);
    copyTo(wanted.closest, found.closest);
    copyTo(wanted.gradient, found.gradient);
    copyTo(wanted.distances, found.distances);
    copyTo(wanted.triangle, found.triangle);
  });
}

raymap_field* raymap_scene_generate(const raymap_scene* scene, const raymap_grid* grid,
                                    const raymap_options* options) {
  return create([&] {
    const AllOptions& how = c::optionsOr(options);
    return c::ownField(need(scene, "the scene")
                           .scene.generate(c::fromC(need(grid, "the grid")), how.field.band, how.machine));
  });
}

raymap_field* raymap_scene_generate_band(const raymap_scene* scene, const raymap_grid* grid,
                                         const raymap_options* options) {
  return create([&] {
    const AllOptions& how = c::optionsOr(options);
    return c::ownField(
        need(scene, "the scene").scene.generateBand(c::fromC(need(grid, "the grid")), how.band, how.machine));
  });
}

raymap_result raymap_scene_distances(const raymap_scene* scene, const uint32_t* pairs, size_t count,
                                     const raymap_configurations* configurations,
                                     const raymap_options* options, raymap_surface_pair* found) {
  return guard([&] {
    const Scene& measured = need(scene, "the scene").scene;
    if (count > 0) need(pairs, "the array of pairs");
    std::vector<glm::uvec2> asked(count);
    for (size_t i = 0; i < count; ++i) asked[i] = {pairs[2 * i], pairs[2 * i + 1]};
    const AllOptions& how = c::optionsOr(options);
    std::vector<SurfacePair> all;
    if (configurations) {
      const auto given = configurationsOf(c::read(configurations), measured.size());
      all = measured.distancesBetween(asked, given.view, how.scene.maxDistance, how.machine);
    } else {
      all = measured.distancesBetween(asked, how.scene.maxDistance, how.machine);
    }
    if (!all.empty()) need(found, "the array of distances");
    for (size_t i = 0; i < all.size(); ++i) found[i] = c::toC(all[i]);
  });
}
