#include <raymap/generate_file.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

/// A generator that several threads of Python may call: they wait for each other.
class GeneratorHandle {
 public:
  std::shared_ptr<FieldHandle> generate(const MeshHandle& mesh, const Grid& grid, const AllOptions& options,
                                        nb::object progress) {
    Call call(std::move(progress));
    std::shared_ptr<FieldHandle> result = unusedField();
    call.run([&] {
      const std::lock_guard lock(mutex_);
      result->stats =
          generator_.generate(mesh.view, grid, options.field, result->field, call.on(options.machine));
    });
    return result;
  }

 private:
  /// Returns a field that nobody refers to, for its memory; a new one if there is none. Needs the GIL. Two
  /// are kept: while the caller still holds the last one, the one before it is free.
  std::shared_ptr<FieldHandle> unusedField() {
    const auto isUnused = [](const std::shared_ptr<FieldHandle>& field) { return field.use_count() == 1; };
    if (const auto unused = std::ranges::find_if(fields_, isUnused); unused != fields_.end()) return *unused;
    constexpr size_t kKept = 2;
    if (fields_.size() == kKept) fields_.erase(fields_.begin());
    return fields_.emplace_back(std::make_shared<FieldHandle>());
  }

  std::mutex mutex_;
  Generator generator_;
  std::vector<std::shared_ptr<FieldHandle>> fields_;
};

nb::dict makeFile(const MeshHandle& mesh, const Grid& grid, const AllOptions& options,
                  const FieldFiles& files, nb::object progress) {
  Call call(std::move(progress));
  FileReport report;
  call.run([&] { report = generateFile(mesh.view, grid, options.field, files, call.on(options.machine)); });
  return toPython(report);
}

}  // namespace

void bindGenerate(nb::module_& module) {
  nb::class_<Grid>(module, "Grid")
      .def(
          "__init__",
          [](Grid* self, const std::tuple<int, int, int>& dims, const Triple& origin, double spacing) {
            const auto [x, y, z] = dims;
            new (self) Grid{.dims = {x, y, z}, .origin = toVector(origin), .spacing = spacing};
          },
          "dims"_a, "origin"_a, "spacing"_a)
      .def_prop_ro("dims", [](const Grid& self) { return std::tuple(self.dims.x, self.dims.y, self.dims.z); })
      .def_prop_ro("origin", [](const Grid& self) { return toTriple(self.origin); })
      .def_ro("spacing", &Grid::spacing);
  module.def(
      "fit_grid",
      [](const MeshHandle& mesh, const AllOptions& options) {
        if (!options.grid.box) validate(mesh.view);
        return fitGrid(mesh.view, options.grid);
      },
      "mesh"_a, "options"_a);
  nb::class_<FieldFiles>(module, "FieldFiles")
      .def(nb::init<>())
      .def_rw("distance", &FieldFiles::distance)
      .def_rw("triangle", &FieldFiles::triangle)
      .def_rw("winding", &FieldFiles::winding)
      .def_rw("confidence", &FieldFiles::confidence)
      .def_rw("grid_name", &FieldFiles::gridName)
      .def_rw("half", &FieldFiles::half)
      .def_rw("full_inside", &FieldFiles::fullInside);
  module.def("generate_file", &makeFile, "mesh"_a, "grid"_a, "options"_a, "files"_a, "progress"_a.none());
  nb::class_<GeneratorHandle>(module, "Generator")
      .def(nb::init<>())
      .def("generate", &GeneratorHandle::generate, "mesh"_a, "grid"_a, "options"_a, "progress"_a.none());
}

}  // namespace raymap::python
