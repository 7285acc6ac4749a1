// The functions of raymap/c.h about fields in memory.

#include <raymap/c.h>
#include <raymap/isosurface.h>

#include <cstring>
#include <string>

#include "c_api/c_report.h"
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

/// Returns the data of an array; null if it is empty, or the handle is null.
template <class T>
const T* dataOf(const raymap_field* field, Buffer<T> Field::*array) noexcept {
  return field && !(field->field.*array).empty() ? (field->field.*array).data() : nullptr;
}

/// Returns the narrow band of a handle; null if it is dense or null.
const NarrowBand* bandOf(const raymap_field* field) noexcept {
  return field && field->field.narrow ? &*field->field.narrow : nullptr;
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
    const AllOptions& given = c::optionsOr(options);
    auto [field, stats] =
        generate(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")), given.field, given.machine);
    return c::ownField(std::move(field), std::move(stats));
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
    const AllOptions& given = c::optionsOr(options);
    filled.stats = {};
    filled.stats = need(generator, "the generator")
                       .generator.generate(need(mesh, "the mesh").view, c::fromC(need(grid, "the grid")),
                                           given.field, filled.field, given.machine);
  });
}

raymap_result raymap_field_grid(const raymap_field* field, raymap_grid* grid) {
  return guard([&] { need(grid, "the grid") = c::toC(c::fieldOf(field).grid); });
}

double raymap_field_clamp_distance(const raymap_field* field) {
  return field ? field->field.clamp() : 0.0;
}

const float* raymap_field_distance(const raymap_field* field) {
  return dataOf(field, &Field::distance);
}

const uint32_t* raymap_field_triangle(const raymap_field* field) {
  return dataOf(field, &Field::triangle);
}

const float* raymap_field_winding(const raymap_field* field) {
  return dataOf(field, &Field::winding);
}

const float* raymap_field_confidence(const raymap_field* field) {
  return dataOf(field, &Field::confidence);
}

bool raymap_field_is_narrow(const raymap_field* field) {
  return bandOf(field) != nullptr;
}

size_t raymap_field_leaf_count(const raymap_field* field) {
  return bandOf(field) ? bandOf(field)->leaves.size() : 0;
}

const int32_t* raymap_field_leaves(const raymap_field* field) {
  return raymap_field_leaf_count(field) > 0 ? &bandOf(field)->leaves[0].x : nullptr;
}

size_t raymap_field_tile_count(const raymap_field* field) {
  return bandOf(field) ? bandOf(field)->tiles.size() : 0;
}

const int32_t* raymap_field_tiles(const raymap_field* field) {
  static_assert(sizeof(NarrowBand::Tile) == 4 * sizeof(int32_t));
  return raymap_field_tile_count(field) > 0 ? &bandOf(field)->tiles[0].low.x : nullptr;
}

raymap_field* raymap_field_to_narrow(const raymap_field* field, const raymap_options* options) {
  return create([&] {
    const raymap_field& dense = need(field, "the field");
    const AllOptions& given = c::optionsOr(options);
    return c::ownField(toSparse(dense.field, given.band, given.machine), dense.stats);
  });
}

raymap_field* raymap_field_to_dense(const raymap_field* field, const raymap_options* options) {
  return create([&] {
    const raymap_field& band = need(field, "the field");
    return c::ownField(toDense(band.field, c::optionsOr(options).machine), band.stats);
  });
}

char* raymap_field_json(const raymap_field* field) {
  return c::report([&] {
    nlohmann::ordered_json json = toJson(need(field, "the field").stats);
    if (const NarrowBand* band = bandOf(field)) {
      json["outside"] = band->outside;
      json["inside"] = band->inside;  // Null if it is infinite.
      json["active"] = field->field.activeCount();
      json["bytes"] = field->field.bytes();
    }
    return json;
  });
}

raymap_result raymap_field_sample(const raymap_field* field, const double* points, size_t count,
                                  raymap_outside outside, float* distances, float* gradients) {
  return guard([&] {
    const Field& sampled = c::fieldOf(field);
    if (count > 0) need(points, "the array of points");
    sampleInto(sampled, {reinterpret_cast<const glm::dvec3*>(points), count}, outsideOf(outside), distances,
               reinterpret_cast<glm::vec3*>(gradients));
  });
}

raymap_mesh* raymap_isosurface(const raymap_field* field, const raymap_options* options) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    return c::ownMesh(isosurface(c::fieldOf(field), given.isosurface, given.machine));
  });
}
