#include <raymap/names.h>
#include <raymap/page.h>
#include <raymap/render.h>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

using Pixels = nb::ndarray<nb::numpy, uint8_t>;

/// Returns the picture as (height, width, 3).
Pixels toPixels(Picture picture) {
  const auto width = size_t(picture.width), height = size_t(picture.height);
  return toArray<uint8_t>(std::move(picture.rgb), {height, width, 3});
}

Pixels drawSlice(const FieldHandle& field, int axis, int index, int width, std::string_view array) {
  Picture picture;
  const auto chosen = fromName<FieldArray>(array);
  {
    const nb::gil_scoped_release release;
    picture = renderSlice(field.field, axis, index, width, chosen);
  }
  return toPixels(std::move(picture));
}

Pixels drawDefects(const MeshHandle& mesh, const AllOptions& options) {
  Picture picture;
  {
    const nb::gil_scoped_release release;
    picture = renderDefects(mesh.view, options.render);
  }
  return toPixels(std::move(picture));
}

nb::dict compare(const FieldHandle& a, const FieldHandle& b, std::string_view array) {
  const auto chosen = fromName<FieldArray>(array);
  Comparison found;
  {
    const nb::gil_scoped_release release;
    found = compareFields(a.field, b.field, chosen);
  }
  return toPython(found);
}

Pixels drawComparison(const FieldHandle& a, const FieldHandle& b, int width, std::string_view array) {
  const auto chosen = fromName<FieldArray>(array);
  Picture picture;
  {
    const nb::gil_scoped_release release;
    picture = renderComparison(a.field, b.field, width, chosen);
  }
  return toPixels(std::move(picture));
}

Pixels drawField(const FieldHandle& field, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  Picture picture;
  call.run([&] { picture = renderField(field.field, options.render, call.on(options.machine)); });
  return toPixels(std::move(picture));
}

nb::str makeHtml(const FieldHandle& field, const AllOptions& options, const MeshHandle* mesh,
                 const FieldHandle* other, nb::object progress) {
  Call call(std::move(progress));
  PageOptions page = options.page;
  if (mesh) page.mesh = mesh->view;
  if (other) page.other = &other->field;
  std::string html;
  call.run([&] { html = makePage(field.field, options.render, page, call.on(options.machine)).html; });
  return toText(html);
}

}  // namespace

void bindRender(nb::module_& module) {
  module.def("make_page", &makeHtml, "field"_a, "options"_a, "mesh"_a.none(), "other"_a.none(),
             "progress"_a.none());
  module.def("render_field", &drawField, "field"_a, "options"_a, "progress"_a.none());
  module.def("render_defects", &drawDefects, "mesh"_a, "options"_a);
  module.def("compare", &compare, "a"_a, "b"_a, "array"_a);
  module.def("render_comparison", &drawComparison, "a"_a, "b"_a, "width"_a, "array"_a);
  module.def("render_slice", &drawSlice, "field"_a, "axis"_a, "index"_a, "width"_a, "array"_a);
}

}  // namespace raymap::python
