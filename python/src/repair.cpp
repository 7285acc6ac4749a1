#include <raymap/repair.h>

#include <utility>

#include "call.h"
#include "diagnostics.h"

namespace raymap::python {

namespace {

nb::dict toDict(const Deviation& deviation) {
  nb::dict dict;
  dict["max"] = deviation.max;
  dict["mean"] = deviation.mean;
  dict["p99"] = deviation.p99;
  dict["points"] = deviation.points;
  return dict;
}

nb::dict toDict(const Removed& removed) {
  nb::dict dict;
  dict["count"] = removed.count;
  dict["volume"] = removed.volume;
  dict["largest"] = removed.largest;
  return dict;
}

nb::dict toDict(const Loss& loss) {
  const auto orZero = [](const Box& box) {
    return box.isEmpty() ? Box{glm::dvec3(0.0), glm::dvec3(0.0)} : box;
  };
  const Box box = orZero(loss.bounds), open = orZero(loss.openBounds);
  const auto list = [](const glm::dvec3& v) { return std::vector<double>{v.x, v.y, v.z}; };
  nb::dict dict;
  dict["solid_share"] = loss.solidShare;
  dict["bbox_min"] = list(box.min);
  dict["bbox_max"] = list(box.max);
  dict["thinnest"] = loss.thinnest;
  dict["median_thickness"] = loss.medianThickness;
  dict["voxel_size"] = loss.voxelSize;
  dict["is_kept"] = loss.isKept;
  dict["kept_share"] = loss.keptShare;
  dict["kept_thickness"] = loss.keptThickness;
  dict["dropped_share"] = loss.droppedShare;
  dict["open_share"] = loss.openShare;
  dict["open_bbox_min"] = list(open.min);
  dict["open_bbox_max"] = list(open.max);
  return dict;
}

nb::dict toDict(const SimplifyReport& simplified) {
  nb::dict dict;
  dict["tolerance"] = simplified.tolerance;
  dict["triangles_before"] = simplified.facesBefore;
  dict["triangles_after"] = simplified.facesAfter;
  dict["deviation"] = simplified.deviation;
  return dict;
}

nb::dict toDict(const RepairReport& report) {
  nb::dict dict;
  dict["before"] = describe(report.before, report.crossingBefore);
  dict["after"] = describe(report.after, report.crossingAfter);
  dict["result_from_mesh"] = toDict(report.ofResult);
  dict["mesh_from_result"] = toDict(report.ofMesh);
  dict["kept_from_result"] = toDict(report.ofKept);
  dict["buried_share"] = report.buriedShare;
  dict["lost_share"] = report.lostShare;
  dict["trimmed_share"] = report.trimmedShare;
  dict["loss"] = toDict(report.loss);
  dict["hollows"] = report.hollows;
  dict["filled_hollows"] = report.filledHollows;
  dict["drain_holes"] = report.holes;
  nb::list places;
  for (const auto& [position, direction] : report.holePlaces) {
    nb::dict place;
    place["position"] = toList(position);
    place["direction"] = toList(direction);
    places.append(place);
  }
  dict["drain_hole_places"] = places;
  dict["solids"] = report.solids;
  dict["cavities"] = report.cavities;
  dict["drop_smaller"] = report.dropSmaller;
  dict["dropped"] = toDict(report.dropped);
  dict["filled"] = toDict(report.filled);
  dict["buried"] = toDict(report.buried);
  dict["parts_overlap"] = report.partsOverlap;
  dict["kept"] = report.isKept;
  dict["closed_holes"] = report.closedHoles;
  dict["closing_faces"] = report.closingFaces;
  dict["thickened_share"] = report.thickenedShare;
  dict["simplified"] = toDict(report.simplified);
  return dict;
}

using Result = std::tuple<std::shared_ptr<MeshHandle>, nb::dict, nb::dict>;

/// Returns the mesh, the report and the statistics.
Result repairMesh(const MeshHandle& mesh, int resolution, double voxelSize, Options options,
                  const RepairOptions& how, nb::object progress) {
  Call call(std::move(progress));
  options.progress = call.progress();
  options.warn = call.warn();
  Repaired result;
  call.run([&] {
    validate(mesh.view);
    const Grid grid = fitRepairGrid(mesh.view, {.resolution = resolution, .voxelSize = voxelSize}, how);
    result = repair(mesh.view, grid, options, how);
  });
  return {own(std::move(result.mesh)), toDict(result.report), describe(result.report.stats)};
}

}  // namespace

void bindRepair(nb::module_& module) {
  nb::class_<RepairOptions>(module, "RepairOptions")
      .def(nb::init<>())
      .def_rw("close_holes", &RepairOptions::closeHoles)
      .def_rw("offset", &RepairOptions::offset)
      .def_rw("shell", &RepairOptions::shell)
      .def_rw("drain_hole", &RepairOptions::drainHole)
      .def_rw("drain_holes", &RepairOptions::drainHoles)
      .def_rw("drop_smaller", &RepairOptions::dropSmaller)
      .def_rw("keep_cavities", &RepairOptions::keepCavities)
      .def_rw("remesh", &RepairOptions::remesh)
      .def_rw("min_thickness", &RepairOptions::minThickness)
      .def_prop_rw(
          "tolerance", [](const RepairOptions& self) { return self.tolerance.value_or(-1.0); },
          [](RepairOptions& self, double tolerance) { self.tolerance = tolerance; })
      .def_prop_rw(
          "down", [](const RepairOptions& self) { return toTriple(self.down); },
          [](RepairOptions& self, const Triple& down) { self.down = toVector(down); });
  module.attr("repair_resolution") = kRepairResolution;
  module.def("repair", &repairMesh, "mesh"_a, "resolution"_a, "voxel_size"_a, "options"_a, "repair"_a,
             "progress"_a.none());
}

}  // namespace raymap::python
