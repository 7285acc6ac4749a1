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

template <class Handle>
Pixels drawSlice(const Handle& field, int axis, int index, int width, std::string_view array) {
  Picture picture;
  const auto chosen = fromName<FieldArray>(array);
  {
    const nb::gil_scoped_release release;
    picture = renderSlice(field.field, axis, index, width, chosen);
  }
  return toPixels(std::move(picture));
}

Pixels drawDefects(const MeshHandle& mesh, const RenderOptions& options) {
  Picture picture;
  {
    const nb::gil_scoped_release release;
    picture = renderDefects(mesh.view, options);
  }
  return toPixels(std::move(picture));
}

template <class Handle>
nb::dict compare(const Handle& a, const Handle& b, std::string_view array) {
  const auto chosen = fromName<FieldArray>(array);
  Comparison found;
  {
    const nb::gil_scoped_release release;
    found = compareFields(a.field, b.field, chosen);
  }
  return toPython(found);
}

template <class Handle>
Pixels drawComparison(const Handle& a, const Handle& b, int width, std::string_view array) {
  const auto chosen = fromName<FieldArray>(array);
  Picture picture;
  {
    const nb::gil_scoped_release release;
    picture = renderComparison(a.field, b.field, width, chosen);
  }
  return toPixels(std::move(picture));
}

template <class Handle>
Pixels drawField(const Handle& field, const RenderOptions& options, const MachineOptions& machine,
                 nb::object progress) {
  Call call(std::move(progress));
  Picture picture;
  call.run([&] { picture = renderField(field.field, options, call.on(machine)); });
  return toPixels(std::move(picture));
}

template <class Handle>
nb::str makeHtml(const Handle& field, const RenderOptions& view, PageOptions page, std::string_view array,
                 const MeshHandle* mesh, const MachineOptions& machine, nb::object progress) {
  Call call(std::move(progress));
  page.array = fromName<FieldArray>(array);
  if (mesh) page.mesh = mesh->view;
  std::string html;
  call.run([&] { html = makePage(field.field, view, page, call.on(machine)).html; });
  return toText(html);
}

void bindVector(nb::class_<RenderOptions>& options, const char* option, glm::dvec3 RenderOptions::*member) {
  options.def_prop_rw(
      option, [member](const RenderOptions& self) { return toTriple(self.*member); },
      [member](RenderOptions& self, const Triple& value) { self.*member = toVector(value); });
}

}  // namespace

void bindRender(nb::module_& module) {
  nb::class_<RenderOptions> options(module, "RenderOptions");
  options.def(nb::init<>())
      .def_rw("width", &RenderOptions::width)
      .def_rw("height", &RenderOptions::height)
      .def_rw("field_of_view", &RenderOptions::fieldOfView)
      .def_rw("cut", &RenderOptions::cut)
      .def_rw("shell", &RenderOptions::shell)
      .def_rw("iso", &RenderOptions::iso)
      .def(
          "stand_at", [](RenderOptions& self, const Triple& eye) { self.eye = toVector(eye); }, "eye"_a)
      .def(
          "frame_box",
          [](RenderOptions& self, const Triple& low, const Triple& high) {
            self.frame = Box{toVector(low), toVector(high)};
          },
          "low"_a, "high"_a)
      .def(
          "cut_at",
          [](RenderOptions& self, const Triple& normal, double offset) {
            self.cutPlane = Plane{toVector(normal), offset};
          },
          "normal"_a, "offset"_a)
      .def(
          "slice_at",
          [](RenderOptions& self, const Triple& normal, double offset) {
            self.slice = Plane{toVector(normal), offset};
          },
          "normal"_a, "offset"_a);
  bindVector(options, "direction", &RenderOptions::direction);
  bindVector(options, "up", &RenderOptions::up);
  nb::class_<PageOptions>(module, "PageOptions")
      .def(nb::init<>())
      .def_rw("title", &PageOptions::title)
      .def_rw("max_size", &PageOptions::maxSize)
      .def_rw("other_title", &PageOptions::otherTitle)
      .def(
          "compare", [](PageOptions& self, const FieldHandle& other) { self.other = &other.field; },
          "other"_a, nb::keep_alive<1, 2>())
      .def(
          "compare", [](PageOptions& self, const SparseHandle& other) { self.otherBand = &other.field; },
          "other"_a, nb::keep_alive<1, 2>());
  module.def("make_page", &makeHtml<FieldHandle>, "field"_a, "view"_a, "page"_a, "array"_a, "mesh"_a.none(),
             "machine"_a, "progress"_a.none());
  module.def("make_page", &makeHtml<SparseHandle>, "field"_a, "view"_a, "page"_a, "array"_a, "mesh"_a.none(),
             "machine"_a, "progress"_a.none());
  module.def("render_field", &drawField<FieldHandle>, "field"_a, "options"_a, "machine"_a,
             "progress"_a.none());
  module.def("render_field", &drawField<SparseHandle>, "field"_a, "options"_a, "machine"_a,
             "progress"_a.none());
  module.def("render_defects", &drawDefects, "mesh"_a, "options"_a);
  module.def("compare", &compare<FieldHandle>, "a"_a, "b"_a, "array"_a);
  module.def("compare", &compare<SparseHandle>, "a"_a, "b"_a, "array"_a);
  module.def("render_comparison", &drawComparison<FieldHandle>, "a"_a, "b"_a, "width"_a, "array"_a);
  module.def("render_comparison", &drawComparison<SparseHandle>, "a"_a, "b"_a, "width"_a, "array"_a);
  module.def("render_slice", &drawSlice<FieldHandle>, "field"_a, "axis"_a, "index"_a, "width"_a, "array"_a);
  module.def("render_slice", &drawSlice<SparseHandle>, "field"_a, "axis"_a, "index"_a, "width"_a, "array"_a);
}

}  // namespace raymap::python
