#pragma once

// The one description of all results: forEachMember(record, use) calls use(name, value) for each member, in
// order. JSON files and Python's dicts have these names as their keys. A value is a record itself, a number,
// a text, an enum of raymap/names.h, a position, a box, or an optional or a vector of these.
//
// scripts/records.py makes docs/report.md and python/raymap/_records.py of this file and of the comments at
// the members. A member that has no comment of its own gets one here.

#include <raymap/devices.h>
#include <raymap/diagnostics.h>
#include <raymap/generate_file.h>
#include <raymap/mesh_thickness.h>
#include <raymap/names.h>
#include <raymap/options.h>
#include <raymap/render.h>
#include <raymap/repair.h>
#include <raymap/verdict.h>
#include <raymap/warning.h>

#include <array>

namespace raymap {

void forEachMember(const Hole& hole, auto&& use) {
  use("edges", hole.edges);
  use("length", hole.length);
  use("area", hole.area);
  use("centre", hole.centre);
  use("diameter", hole.diameter);
}

void forEachMember(const Diagnostics& found, auto&& use) {
  use("vertices", found.vertices);
  use("welded_vertices", found.weldedVertices);
  use("triangles", found.triangles);
  use("watertight", found.watertight);
  use("consistently_oriented", found.consistentlyOriented);
  use("balanced", found.balanced);
  use("components", found.components);
  use("open_components", found.openComponents);
  use("inward_components", found.inwardComponents);
  use("sheets", found.sheets);
  use("sheet_share", found.sheetShare);
  use("boundary_edges", found.boundaryEdges);
  use("hole_count", found.holes.size());  ///< Number of boundary loops.
  use("holes", found.holes);
  use("non_manifold_edges", found.nonManifoldEdges);
  use("flipped_edges", found.flippedEdges);
  use("flipped_faces", found.flippedFaces);
  use("degenerate_faces", found.degenerateFaces);
  use("far_vertices", found.farVertices);
  use("duplicate_faces", found.duplicateFaces);
  use("double_sided_faces", found.doubleSidedFaces);
  use("signed_volume", found.signedVolume);
  use("area", found.area);
  use("bounds", found.bounds);
}

void forEachMember(const SelfIntersections& found, auto&& use) {
  use("pairs", found.pairs);
  use("faces", found.faces.size());  ///< Number of faces in them.
  use("complete", found.complete);
  use("coplanar_pairs", found.coplanarPairs);
  use("coplanar_faces", found.coplanarFaces.size());  ///< Number of faces in these pairs.
}

/// Diagnostics of a mesh with the faces that cross.
struct Inspection {
  const Diagnostics& diagnostics;
  const SelfIntersections& selfIntersections;  ///< Faces that cross others.
};

void forEachMember(const Inspection& inspection, auto&& use) {
  forEachMember(inspection.diagnostics, use);
  use("self_intersections", inspection.selfIntersections);
}

void forEachMember(const Verdict& verdict, auto&& use) {
  use("kind", verdict.kind);
  use("remedy", verdict.remedy);
  use("arrangement", verdict.arrangement);
  use("sought", verdict.sought);
  use("thinnest", verdict.thinnest);
  use("voxel_size", verdict.voxelSize);
  use("thickness", verdict.thickness);
}

void forEachMember(const Stats::Stage& stage, auto&& use) {
  use("name", stage.name);
  use("milliseconds", stage.milliseconds);
}

void forEachMember(const Stats& stats, auto&& use) {
  use("device", stats.device);
  use("stages", stats.stages);
  use("milliseconds", stats.milliseconds);
  use("bytes", stats.bytes);
  use("doubtful_share", stats.doubtfulShare);
  use("turned_faces", stats.turnedFaces);
  use("left_out_faces", stats.leftOutFaces);
  use("inverted_parts", stats.invertedParts);
  use("misfit_given", stats.misfitGiven);
  use("misfit", stats.misfit);
  use("orientation_fits", stats.orientationFits);
  use("patch_triangles", stats.patchTriangles);
  use("patch_area", stats.patchArea);
}

void forEachMember(const FieldPlan& plan, auto&& use) {
  use("form", plan.form);
  use("planes", plan.planes);
  use("bytes", plan.bytes);
}

void forEachMember(const FileReport& report, auto&& use) {
  use("plan", report.plan);
  use("stats", report.stats);
}

void forEachMember(const Deviation& deviation, auto&& use) {
  use("max", deviation.max);
  use("mean", deviation.mean);
  use("p99", deviation.p99);
  use("points", deviation.points);
}

void forEachMember(const DrainHolePlace& place, auto&& use) {
  use("position", place.position);
  use("direction", place.direction);
}

void forEachMember(const Removed& removed, auto&& use) {
  use("count", removed.count);
  use("volume", removed.volume);
  use("largest", removed.largest);
}

void forEachMember(const Loss& loss, auto&& use) {
  use("solid_share", loss.solidShare);
  use("bounds", loss.bounds);
  use("thinnest", loss.thinnest);
  use("median_thickness", loss.medianThickness);
  use("voxel_size", loss.voxelSize);
  use("kept", loss.kept);
  use("kept_share", loss.keptShare);
  use("kept_thickness", loss.keptThickness);
  use("dropped_share", loss.droppedShare);
  use("dropped_bounds", loss.droppedBounds);
  use("open_share", loss.openShare);
  use("open_bounds", loss.openBounds);
}

void forEachMember(const SimplifyReport& simplified, auto&& use) {
  use("tolerance", simplified.tolerance);
  use("triangles_before", simplified.trianglesBefore);
  use("triangles_after", simplified.trianglesAfter);
  use("deviation", simplified.deviation);
}

void forEachMember(const WarningFields& fields, auto&& use) {
  use("file", fields.file);
  use("device", fields.device);
  use("count", fields.count);
  use("share", fields.share);
  use("length", fields.length);
  use("volume", fields.volume);
  use("voxel_size", fields.voxelSize);
}

void forEachMember(const Warning& warning, auto&& use) {
  use("code", warning.code);
  use("message", warning.message);
  forEachMember(warning.fields, use);
}

void forEachMember(const RepairReport& report, auto&& use) {
  use("before", Inspection{report.before, report.crossingBefore});
  use("after", Inspection{report.after, report.crossingAfter});
  use("arrangement_before", report.arrangementBefore);
  use("arrangement_after", report.arrangementAfter);
  use("result_from_mesh", report.resultFromMesh);
  use("mesh_from_result", report.meshFromResult);
  use("kept_from_result", report.keptFromResult);
  use("buried_share", report.buriedShare);
  use("lost_share", report.lostShare);
  use("trimmed_share", report.trimmedShare);
  use("loss", report.loss);
  use("hollows", report.hollows);
  use("filled_hollows", report.filledHollows);
  use("drain_holes", report.drainHoles);
  use("drain_hole_places", report.drainHolePlaces);
  use("solids", report.solids);
  use("cavities", report.cavities);
  use("drop_smaller", report.dropSmaller);
  use("dropped", report.dropped);
  use("filled", report.filled);
  use("buried", report.buried);
  use("parts_overlap", report.partsOverlap);
  use("depth", report.depth);
  use("field_reason", report.fieldReason);
  use("cleaned_faces", report.cleanedFaces);
  use("united_faces", report.unitedFaces);
  use("sewn_vertices", report.sewnVertices);
  use("moved_vertices", report.movedVertices);
  use("kept_faces", report.keptFaces);
  use("closed_holes", report.closedHoles);
  use("closing_faces", report.closingFaces);
  use("least_thickness", report.leastThickness);
  use("thickened_share", report.thickenedShare);
  use("simplified", report.simplified);
  use("warnings", report.warnings);
  use("stats", report.stats);
}

void forEachMember(const DeviceInfo& device, auto&& use) {
  use("id", device.id);
  use("name", device.name);
  use("type", device.type);
  use("chosen_by_auto", device.chosenByAuto);
  use("driver", device.driver);
  use("threads", device.threads);
  use("memory", device.memory);
  use("shared_memory", device.sharedMemory);
  use("problem", device.problem);
  use("vulkan_version", device.vulkanVersion);
  use("subgroup_size", device.subgroupSize);
  use("min_subgroup_size", device.minSubgroupSize);
  use("max_subgroup_size", device.maxSubgroupSize);
  use("fingerprint", device.fingerprint);
  use("test", device.test);
  use("test_problem", device.testProblem);
}

void forEachMember(const DeviceCheck& check, auto&& use) {
  use("name", check.name);
  use("difference", check.difference);
  use("milliseconds", check.milliseconds);
}

void forEachMember(const DeviceTest& test, auto&& use) {
  use("device", test.device);
  use("checks", test.checks);
  use("problem", test.problem);
  use("milliseconds", test.milliseconds);
  use("hangs", test.hangs);
}

void forEachMember(const Comparison& found, auto&& use) {
  use("samples", found.samples);
  use("sign_differences", found.signDifferences);
  use("max_error", found.maxError);
  use("worst_sample", found.worstSample);
  use("mean_error", found.meanError);
  use("rms_error", found.rmsError);
  use("differences", found.differences);
  use("non_finite", found.nonFinite);
}

void forEachMember(const ThicknessSummary& found, auto&& use) {
  use("thinnest", found.thinnest);
  use("thinnest_at", found.thinnestAt);
  use("sharpest", found.sharpest);
  use("sharpest_at", found.sharpestAt);
  use("low", found.low);
  use("median", found.median);
  use("sheet_share", found.sheetShare);
  use("buried_share", found.buriedShare);
  use("points", found.points);
}

/// Takes any member.
struct AnyMember {
  void operator()(const char*, const auto&) const {}
};

/// A result whose members have names.
template <class T>
concept Record = requires(const T& value) {
  forEachMember(value, AnyMember{});
};

/// Returns the lowest and the highest corner as records hold them: both 0 if the box is empty.
inline std::array<glm::dvec3, 2> corners(const Box& box) {
  return box.isEmpty() ? std::array{glm::dvec3(0.0), glm::dvec3(0.0)} : std::array{box.min, box.max};
}

}  // namespace raymap
