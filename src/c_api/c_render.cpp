// The functions of raymap/c.h about pictures and pages.

#include <raymap/c.h>
#include <raymap/page.h>
#include <raymap/render.h>

#include "c_api/c_handles.h"

using namespace raymap;
using raymap::c::create;
using raymap::c::guard;
using raymap::c::need;

namespace {

std::unique_ptr<raymap_picture> ownPicture(Picture picture) {
  return std::make_unique<raymap_picture>(raymap_picture{std::move(picture)});
}

}  // namespace

raymap_picture* raymap_render_field(const raymap_field* field, const raymap_options* options) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    return ownPicture(renderField(c::fieldOf(field), given.render, given.machine));
  });
}

raymap_picture* raymap_render_defects(const raymap_mesh* mesh, const raymap_options* options) {
  return create([&] {
    const AllOptions& given = c::optionsOr(options);
    return ownPicture(renderDefects(need(mesh, "the mesh").view, given.render, given.machine));
  });
}

raymap_picture* raymap_render_slice(const raymap_field* field, int32_t axis, int32_t index,
                                    const raymap_options* options) {
  return create([&] {
    const RenderOptions& given = c::optionsOr(options).render;
    return ownPicture(renderSlice(c::fieldOf(field), axis, index, given.width, given.array));
  });
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

raymap_result raymap_write_page(const raymap_field* field, const char* path, const raymap_mesh* mesh,
                                const raymap_field* other, const raymap_options* options) {
  return guard([&] {
    need(path, "the path");
    const AllOptions& given = c::optionsOr(options);
    PageOptions page = given.page;
    if (mesh) page.mesh = mesh->view;
    if (other) page.other = &other->field;
    writePage(path, c::fieldOf(field), given.render, page, given.machine);
  });
}
