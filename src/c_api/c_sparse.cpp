// The functions of raymap/c.h about regions and narrow bands.

#include <raymap/c.h>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

RegionOptions regionOptions(const raymap_options* options) {
  const FieldOptions& given = c::optionsOr(options).field;
  return {.band = given.band,
          .triangle = given.triangle,
          .winding = given.winding,
          .confidence = given.confidence};
}

BandOptions bandOptions(const raymap_band_options* band, const raymap_options* options) {
  const raymap_band_options widths = c::read(band);
  const FieldOptions& given = c::optionsOr(options).field;
  BandOptions wanted{.triangle = given.triangle, .winding = given.winding, .confidence = given.confidence};
  if (given.band != 0.0) wanted.outside = given.band;
  if (widths.outside != 0.0) wanted.outside = widths.outside;
  wanted.inside = widths.inside != 0.0 ? widths.inside : wanted.outside;
  return wanted;
}

/// Returns the vector behind a pointer to three numbers. Throws `Error(Usage)` that names it if that is null.
glm::ivec3 samplesOf(const int32_t* numbers, const char* name) {
  need(numbers, name);
  return {numbers[0], numbers[1], numbers[2]};
}

std::unique_ptr<raymap_field> own(Field field) {
  auto handle = std::make_unique<raymap_field>();
  handle->field = std::move(field);
  return handle;
}

Region regionOf(const int32_t* low, const int32_t* extent) {
  return {.low = samplesOf(low, "the first sample of the region"),
          .size = samplesOf(extent, "the extent of the region")};
}

std::unique_ptr<raymap_sparse_field> own(SparseField field) {
  auto handle = std::make_unique<raymap_sparse_field>();
  handle->field = std::move(field);
  return handle;
}

}  // namespace

raymap_field* raymap_surface_generate_region(const raymap_surface* surface, const raymap_grid* lattice,
                                             const int32_t low[3], const int32_t extent[3],
                                             const raymap_options* options) {
  return create([&] {
    const Surface& made = need(surface, "the surface").surface;
    return own(made.generateRegion(c::fromC(need(lattice, "the lattice")), regionOf(low, extent),
                                   regionOptions(options), c::optionsOr(options).machine));
  });
}

raymap_result raymap_surface_far_distance(const raymap_surface* surface, const raymap_grid* lattice,
                                          const int32_t low[3], const int32_t extent[3],
                                          const raymap_options* options, double* distance) {
  return guard([&] {
    const Surface& made = need(surface, "the surface").surface;
    need(distance, "the distance") = made.farDistance(c::fromC(need(lattice, "the lattice")),
                                                      regionOf(low, extent), regionOptions(options))
                                         .value_or(NAN);
  });
}

raymap_result raymap_surface_region_bytes(const raymap_surface* surface, const int32_t extent[3],
                                          const raymap_options* options, size_t* bytes) {
  return guard([&] {
    need(bytes, "the number of bytes") =
        need(surface, "the surface")
            .surface.regionBytes(samplesOf(extent, "the extent of the region"), regionOptions(options),
                                 c::optionsOr(options).machine);
  });
}

raymap_sparse_field* raymap_surface_generate_band(const raymap_surface* surface, const raymap_grid* grid,
                                                  const raymap_band_options* band,
                                                  const raymap_options* options) {
  return create([&] {
    return own(need(surface, "the surface")
                   .surface.generateBand(c::fromC(need(grid, "the grid")), bandOptions(band, options),
                                         c::optionsOr(options).machine));
  });
}

raymap_sparse_field* raymap_field_to_sparse(const raymap_field* field, const raymap_band_options* band,
                                            const raymap_options* options) {
  return create([&] {
    return own(
        toSparse(need(field, "the field").field, bandOptions(band, options), c::optionsOr(options).machine));
  });
}

raymap_field* raymap_sparse_field_to_dense(const raymap_sparse_field* field, const raymap_options* options) {
  return create([&] { return own(toDense(need(field, "the field").field, c::optionsOr(options).machine)); });
}

void raymap_sparse_field_free(raymap_sparse_field* field) {
  delete field;
}

raymap_result raymap_sparse_field_numbers(const raymap_sparse_field* field, raymap_sparse_numbers* numbers) {
  return guard([&] {
    const SparseField& counted = need(field, "the field").field;
    c::write({.size = sizeof(raymap_sparse_numbers),
              .leaves = counted.leaves.size(),
              .tiles = counted.tiles.size(),
              .active = counted.activeCount(),
              .bytes = counted.bytes(),
              .outside = counted.outside,
              .inside = counted.inside},
             numbers);
  });
}

raymap_result raymap_sparse_field_grid(const raymap_sparse_field* field, raymap_grid* grid) {
  return guard([&] { need(grid, "the grid") = c::toC(need(field, "the field").field.grid); });
}

const int32_t* raymap_sparse_field_leaves(const raymap_sparse_field* field) {
  const glm::ivec3* leaves = c::dataOf(field, &SparseField::leaves);
  return leaves ? &leaves->x : nullptr;
}

const int32_t* raymap_sparse_field_tiles(const raymap_sparse_field* field) {
  static_assert(sizeof(SparseField::Tile) == 4 * sizeof(int32_t));
  const int32_t* data = nullptr;
  guard([&] {
    const std::vector<SparseField::Tile>& tiles = need(field, "the field").field.tiles;
    if (!tiles.empty()) data = &tiles.front().low.x;
  });
  return data;
}

const float* raymap_sparse_field_distance(const raymap_sparse_field* field) {
  return c::dataOf(field, &SparseField::distance);
}

const uint32_t* raymap_sparse_field_triangle(const raymap_sparse_field* field) {
  return c::dataOf(field, &SparseField::triangle);
}

const float* raymap_sparse_field_winding(const raymap_sparse_field* field) {
  return c::dataOf(field, &SparseField::winding);
}

const float* raymap_sparse_field_confidence(const raymap_sparse_field* field) {
  return c::dataOf(field, &SparseField::confidence);
}
