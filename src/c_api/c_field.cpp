// The functions of raymap/c.h about fields in memory.

#include <raymap/c.h>

#include <cstring>
#include <string>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"
#include "field/field_sampler.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

Outside outsideOf(const raymap_outside& outside) {
  int value = 0;  // C passes any number; C++ must not read one that the enum lacks as the enum.
  static_assert(sizeof value == sizeof outside);
  std::memcpy(&value, &outside, sizeof value);
  switch (value) {
    case RAYMAP_OUTSIDE_BOUND:
      return Outside::Bound;
    case RAYMAP_OUTSIDE_NAN:
      return Outside::NaN;
    default:
      throw Error(ErrorCode::Usage, "there is no raymap_outside " + std::to_string(value) +
                                        "; use RAYMAP_OUTSIDE_BOUND or RAYMAP_OUTSIDE_NAN");
  }
}

template <class Handle>
raymap_result sampleField(const Handle* handle, const double* points, size_t count,
                          const raymap_outside& outside, float* distances, float* gradients) {
  return guard([&] {
    const auto& sampled = need(handle, "the field").field;
    if (count > 0) need(points, "the array of points");
    sampleInto(sampled, {reinterpret_cast<const glm::dvec3*>(points), count}, outsideOf(outside), distances,
               reinterpret_cast<glm::vec3*>(gradients));
  });
}

}  // namespace

raymap_field* raymap_field_create(void) {
  return create([] { return std::make_unique<raymap_field>(); });
}

void raymap_field_free(raymap_field* field) {
  delete field;
}

raymap_field* raymap_generate(const raymap_mesh* mesh, const raymap_grid* grid,
                              const raymap_options* options) {
  return create([&] {
    const raymap_options& given = c::optionsOr(options);
    auto [field, stats] =
        generate(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")), given.field, given.machine);
    auto handle = std::make_unique<raymap_field>();
    handle->field = std::move(field);
    handle->stats = std::move(stats);
    return handle;
  });
}

raymap_generator* raymap_generator_create(void) {
  return create([] { return std::make_unique<raymap_generator>(); });
}

void raymap_generator_free(raymap_generator* generator) {
  delete generator;
}

raymap_result raymap_generator_run(raymap_generator* generator, const raymap_mesh* mesh,
                                   const raymap_grid* grid, const raymap_options* options,
                                   raymap_field* field) {
  return guard([&] {
    raymap_field& filled = need(field, "the field");
    const raymap_options& given = c::optionsOr(options);
    filled.stats = {};
    filled.stats = need(generator, "the generator")
                       .generator.generate(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")),
                                           given.field, filled.field, given.machine);
  });
}

raymap_result raymap_field_grid(const raymap_field* field, raymap_grid* grid) {
  return guard([&] { need(grid, "the grid") = c::toC(need(field, "the field").field.grid); });
}

double raymap_field_clamp_distance(const raymap_field* field) {
  return field ? field->field.clampDistance : 0.0;
}

const float* raymap_field_distance(const raymap_field* field) {
  return c::dataOf(field, &Field::distance);
}

const uint32_t* raymap_field_triangle(const raymap_field* field) {
  return c::dataOf(field, &Field::triangle);
}

const float* raymap_field_winding(const raymap_field* field) {
  return c::dataOf(field, &Field::winding);
}

const float* raymap_field_confidence(const raymap_field* field) {
  return c::dataOf(field, &Field::confidence);
}

raymap_result raymap_field_stats(const raymap_field* field, raymap_stats* stats) {
  return guard([&] {
    const Stats& found = need(field, "the field").stats;
    c::write(c::toC(found), stats);
  });
}

const char* raymap_field_device(const raymap_field* field) {
  return field ? field->stats.device.c_str() : "";
}

raymap_result raymap_field_sample(const raymap_field* field, const double* points, size_t count,
                                  raymap_outside outside, float* distances, float* gradients) {
  return sampleField(field, points, count, outside, distances, gradients);
}

raymap_result raymap_sparse_field_sample(const raymap_sparse_field* field, const double* points, size_t count,
                                         raymap_outside outside, float* distances, float* gradients) {
  return sampleField(field, points, count, outside, distances, gradients);
}
