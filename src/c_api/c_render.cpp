// The functions of raymap/c.h about pictures and pages.

#include <raymap/c.h>
#include <raymap/names.h>
#include <raymap/page.h>
#include <raymap/render.h>

#include <algorithm>
#include <limits>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

/// Returns the plane of a normal and an offset; none if the normal is 0.
std::optional<Plane> planeOf(const double (&numbers)[4]) {
  const Plane plane{.normal = {numbers[0], numbers[1], numbers[2]}, .offset = numbers[3]};
  return plane.normal == glm::dvec3(0.0) ? std::nullopt : std::optional(plane);
}

RenderOptions renderOptions(const raymap_view* view) {
  const raymap_view given = c::read(view);
  RenderOptions wanted{.cut = given.cut, .shell = given.shell};
  if (given.width != 0) wanted.width = given.width;
  if (given.height != 0) wanted.height = given.height;
  if (const glm::dvec3 direction = c::vectorOf(given.direction); direction != glm::dvec3(0.0))
    wanted.direction = direction;
  if (const glm::dvec3 up = c::vectorOf(given.up); up != glm::dvec3(0.0)) wanted.up = up;
  if (given.field_of_view != 0.0) wanted.fieldOfView = given.field_of_view;
  if (given.has_frame) wanted.frame = Box{c::vectorOf(given.frame_min), c::vectorOf(given.frame_max)};
  if (given.has_eye) wanted.eye = c::vectorOf(given.eye);
  wanted.iso = given.iso;
  wanted.cutPlane = planeOf(given.cut_plane);
  wanted.slice = planeOf(given.slice_plane);
  return wanted;
}

PageOptions pageOptions(const raymap_page_options* page) {
  const raymap_page_options given = c::read(page);
  PageOptions wanted;
  if (given.title) wanted.title = given.title;
  if (given.array) wanted.array = fromName<FieldArray>(given.array);
  if (given.mesh) wanted.mesh = given.mesh->view;
  if (given.other) wanted.other = &given.other->field;
  if (given.other_title) wanted.otherTitle = given.other_title;
  if (given.other_sparse) wanted.otherBand = &given.other_sparse->field;
  constexpr int64_t kMost = std::numeric_limits<int>::max();
  if (given.max_size != 0) wanted.maxSize = int(std::clamp<int64_t>(given.max_size, 0, kMost));
  return wanted;
}

std::unique_ptr<raymap_picture> ownPicture(Picture picture) {
  return std::make_unique<raymap_picture>(raymap_picture{std::move(picture)});
}

// For fields and narrow bands:

template <class Field>
raymap_picture* drawField(const Field* field, const raymap_view* view, const raymap_options* options) {
  return create([&] {
    return ownPicture(
        renderField(need(field, "the field").field, renderOptions(view), c::optionsOr(options).machine));
  });
}

template <class Field>
raymap_picture* drawSlice(const Field* field, int axis, int index, int width, const char* array) {
  return create([&] {
    constexpr int kWidth = 1024;
    return ownPicture(renderSlice(need(field, "the field").field, axis, index, width != 0 ? width : kWidth,
                                  fromName<FieldArray>(array ? array : "distance")));
  });
}

template <class Field>
raymap_result writePageOf(const Field* field, const char* path, const raymap_view* view,
                          const raymap_page_options* page, const raymap_options* options) {
  return guard([&] {
    writePage(&need(path, "the path"), need(field, "the field").field, renderOptions(view), pageOptions(page),
              c::optionsOr(options).machine);
  });
}

}  // namespace

raymap_picture* raymap_render_field(const raymap_field* field, const raymap_view* view,
                                    const raymap_options* options) {
  return drawField(field, view, options);
}

raymap_picture* raymap_render_sparse_field(const raymap_sparse_field* field, const raymap_view* view,
                                           const raymap_options* options) {
  return drawField(field, view, options);
}

raymap_picture* raymap_render_defects(const raymap_mesh* mesh, const raymap_view* view,
                                      const raymap_options* options) {
  return create([&] {
    return ownPicture(
        renderDefects(need(mesh, "the mesh").view, renderOptions(view), c::optionsOr(options).machine));
  });
}

raymap_picture* raymap_render_slice(const raymap_field* field, int32_t axis, int32_t index, int32_t width,
                                    const char* array) {
  return drawSlice(field, axis, index, width, array);
}

raymap_picture* raymap_render_sparse_slice(const raymap_sparse_field* field, int32_t axis, int32_t index,
                                           int32_t width, const char* array) {
  return drawSlice(field, axis, index, width, array);
}

void raymap_picture_free(raymap_picture* picture) {
  delete picture;
}

int32_t raymap_picture_width(const raymap_picture* picture) {
  return picture ? picture->picture.width : 0;
}

int32_t raymap_picture_height(const raymap_picture* picture) {
  return picture ? picture->picture.height : 0;
}

const uint8_t* raymap_picture_rgb(const raymap_picture* picture) {
  return picture ? picture->picture.rgb.data() : nullptr;
}

raymap_result raymap_picture_write_png(const raymap_picture* picture, const char* path) {
  return guard([&] { writePng(&need(path, "the path"), need(picture, "the picture").picture); });
}

raymap_result raymap_write_page(const raymap_field* field, const char* path, const raymap_view* view,
                                const raymap_page_options* page, const raymap_options* options) {
  return writePageOf(field, path, view, page, options);
}

raymap_result raymap_write_sparse_page(const raymap_sparse_field* field, const char* path,
                                       const raymap_view* view, const raymap_page_options* page,
                                       const raymap_options* options) {
  return writePageOf(field, path, view, page, options);
}
