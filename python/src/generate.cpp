#include <raymap/names.h>

#include <algorithm>
#include <mutex>
#include <vector>

#include "call.h"

namespace raymap::python {

namespace {

/// A generator that several threads of Python may call: they wait for each other.
class GeneratorHandle {
 public:
  std::shared_ptr<FieldHandle> generate(const MeshHandle& mesh, const Grid& grid, const FieldOptions& options,
                                        const MachineOptions& machine, nb::object progress) {
    Call call(std::move(progress));
    std::shared_ptr<FieldHandle> result = unusedField();
    call.run([&] {
      const std::lock_guard lock(mutex_);
      result->stats = generator_.generate(mesh.view, grid, options, result->field, call.on(machine));
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

/// Binds an option whose value is the name of an enum's.
template <class Enum>
void bindName(nb::class_<FieldOptions>& options, const char* option, Enum FieldOptions::*member) {
  options.def_prop_rw(
      option, [member](const FieldOptions& self) { return std::string(name(self.*member)); },
      [member](FieldOptions& self, std::string_view value) { self.*member = fromName<Enum>(value); });
}

void bindOptions(nb::module_& module) {
  nb::class_<FieldOptions> options(module, "FieldOptions");
  options.def(nb::init<>());
  bindName(options, "distance", &FieldOptions::distance);
  bindName(options, "sign", &FieldOptions::sign);
  bindName(options, "orientation", &FieldOptions::orientation);
  bindName(options, "sampling", &FieldOptions::sampling);
  options
      .def("set_offsets",
           [](FieldOptions& self, const std::vector<std::tuple<int, int, int>>& offsets) {
             self.offsets.clear();
             for (const auto& [x, y, z] : offsets) self.offsets.emplace_back(x, y, z);
           })
      .def_rw("passes", &FieldOptions::passes)
      .def_rw("threshold", &FieldOptions::threshold)
      .def_rw("invert", &FieldOptions::invert)
      .def_rw("band", &FieldOptions::band)
      .def_rw("close_holes", &FieldOptions::closeHoles)
      .def_rw("thickness", &FieldOptions::thickness)
      .def_rw("allow_empty", &FieldOptions::allowEmpty)
      .def_rw("triangle", &FieldOptions::triangle)
      .def_rw("winding", &FieldOptions::winding)
      .def_rw("confidence", &FieldOptions::confidence);
}

}  // namespace

void bindMachine(nb::module_& module) {
  nb::class_<MachineOptions>(module, "MachineOptions")
      .def(nb::init<>())
      .def_rw("device", &MachineOptions::device)
      .def_rw("threads", &MachineOptions::threads)
      .def_rw("memory_limit", &MachineOptions::memoryLimit);
}

Grid fit(const MeshView& mesh, int resolution, double voxelSize,
         const std::optional<std::tuple<int, int, int>>& dims, const std::optional<Bounds>& box,
         double padding, double thickness, bool align) {
  GridOptions options{.resolution = resolution,
                      .voxelSize = voxelSize,
                      .padding = padding,
                      .thickness = thickness,
                      .align = align};
  if (dims) options.dims = toWhole(*dims);
  if (box) options.box = Box{toVector(box->first), toVector(box->second)};
  return fitGrid(mesh, options);
}

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
      [](const MeshHandle& mesh, int resolution, double voxelSize,
         const std::optional<std::tuple<int, int, int>>& dims, const std::optional<Bounds>& bounds,
         double padding, double thickness, bool align) {
        if (!bounds) validate(mesh.view);
        return fit(mesh.view, resolution, voxelSize, dims, bounds, padding, thickness, align);
      },
      "mesh"_a, "resolution"_a, "voxel_size"_a, "dims"_a.none(), "bounds"_a.none(), "padding"_a,
      "thickness"_a, "align"_a);
  bindOptions(module);
  nb::class_<GeneratorHandle>(module, "Generator")
      .def(nb::init<>())
      .def("generate", &GeneratorHandle::generate, "mesh"_a, "grid"_a, "options"_a, "machine"_a,
           "progress"_a.none());
}

}  // namespace raymap::python
