#include <raymap/mesh_thickness.h>
#include <raymap/simplify.h>
#include <raymap/split.h>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const uint32_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// Returns an array of one value of each element.
template <class Value, class Elements, class Get>
auto column(const Elements& elements, Get&& get) {
  std::vector<Value> values;
  values.reserve(elements.size());
  for (const auto& element : elements) values.push_back(get(element));
  if constexpr (std::is_arithmetic_v<Value>)
    return toArray<Value>(std::move(values), {elements.size()});
  else
    return toArray<typename Value::value_type>(std::move(values), {elements.size(), 3});
}

/// Returns positions, triangles and areas.
nb::tuple facePoints(const MeshHandle& mesh, double step) {
  std::vector<FacePoint> points;
  {
    const nb::gil_scoped_release release;
    validate(mesh.view);
    points = sampleFaces(mesh.view, step);
  }
  return nb::make_tuple(column<glm::dvec3>(points, [](const FacePoint& p) { return p.position; }),
                        column<uint32_t>(points, [](const FacePoint& p) { return p.triangle; }),
                        column<double>(points, [](const FacePoint& p) { return p.area; }));
}

/// Returns parts as numbers, diameters and directions.
nb::tuple measure(const Surface& surface, const Points& positions, const Indices& triangles,
                  const AllOptions& options, nb::object progress) {
  std::vector<FacePoint> points(positions.shape(0));
  for (size_t i = 0; i < points.size(); ++i)
    points[i] = {{positions(i, 0), positions(i, 1), positions(i, 2)}, triangles(i)};
  Call call(std::move(progress));
  std::vector<Thickness> found;
  call.run([&] { found = surface.thickness(points, options.thickness, call.on(options.machine)); });
  return nb::make_tuple(column<uint8_t>(found, [](const Thickness& t) { return uint8_t(t.part); }),
                        column<float>(found, [](const Thickness& t) { return t.diameter; }),
                        column<glm::vec3>(found, [](const Thickness& t) { return t.inward; }));
}

nb::dict summarize(const Surface& surface, const AllOptions& options, nb::object progress) {
  Call call(std::move(progress));
  ThicknessSummary found{};
  call.run([&] { found = summarizeThickness(surface, options.thickness, call.on(options.machine)); });
  return toPython(found);
}

/// Returns the mesh and the report.
std::pair<std::shared_ptr<MeshHandle>, nb::dict> simplifyMesh(const MeshHandle& mesh,
                                                              const AllOptions& options,
                                                              nb::object progress) {
  Call call(std::move(progress));
  Simplified result;
  call.run([&] { result = simplify(mesh.view, options.simplify, call.on(options.machine)); });
  const SimplifyReport report{.tolerance = result.tolerance,
                              .trianglesBefore = mesh.view.triangleCount,
                              .trianglesAfter = result.mesh.triangles.size(),
                              .deviation = result.deviation};
  return {own(std::move(result.mesh)), toPython(report)};
}

}  // namespace

void bindMeasure(nb::module_& module) {
  module.def(
      "split_parts",
      [](const MeshHandle& mesh) {
        nb::list parts;
        for (std::vector<uint32_t>& faces : splitParts(mesh.view)) {
          const size_t count = faces.size();
          parts.append(toArray<uint32_t>(std::move(faces), {count}));
        }
        return parts;
      },
      "mesh"_a);
  module.def("sample_faces", &facePoints, "mesh"_a, "step"_a);
  module.def("thickness", &measure, "surface"_a, "points"_a, "triangles"_a, "options"_a, "progress"_a.none());
  module.def("summarize_thickness", &summarize, "surface"_a, "options"_a, "progress"_a.none());
  module.def("simplify", &simplifyMesh, "mesh"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
