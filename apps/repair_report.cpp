#include "repair_report.h"

#include <raymap/json.h>
#include <raymap/version.h>

#include <array>
#include <cstdio>

namespace raymap {

namespace {

void print(const char* name, const glm::dvec3& before, const glm::dvec3& after) {
  std::printf("  %-22s %.6g %.6g %.6g before, %.6g %.6g %.6g after\n", name, before.x, before.y, before.z,
              after.x, after.y, after.z);
}

std::string pairsText(const SelfIntersections& crossing) {
  return (crossing.complete ? "" : "at least ") + counted(crossing.pairs, "pair");
}

void print(const char* name, const Deviation& deviation, double spacing) {
  std::printf("  %-22s at most %.3g (%.2g samples), 99 %% within %.3g, mean %.3g\n", name, deviation.max,
              deviation.max / spacing, deviation.p99, deviation.mean);
}

void printShare(double share, const char* what) {
  if (share > 0.0) std::printf("  %.3g %% %s\n", 100.0 * share, what);
}

void print(const char* name, const std::string& counted, const Removed& removed, const std::string& rest) {
  if (removed.count > 0)
    std::printf("  %-22s %s, volume %.3g in all, %.3g the largest; %s\n", name, counted.c_str(),
                removed.volume, removed.largest, rest.c_str());
}

std::string countedCavities(size_t count) {
  return grouped(count) + (count == 1 ? " cavity" : " cavities");
}

/// Prints what became of small parts and of sealed cavities.
void printRemoved(const RepairReport& report) {
  std::array<char, 32> least{};
  std::snprintf(least.data(), least.size(), "below %.3g", report.dropSmaller);
  print("dropped", counted(report.dropped.count, "part"), report.dropped, least.data());
  print("filled", countedCavities(report.filled.count), report.filled, "to keep them: --keep-cavities");
  print("buried", counted(report.buried.count, "part"), report.buried, "they were in what was filled");
}

/// Returns what chose the distance between samples, if it was the program.
std::string reasonFor(const RepairGrid& grid) {
  if (!grid.thinnest) return {};
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(),
                grid.keepsThinnest() ? ", chosen for the thinnest part, %.3g thick"
                                     : "; the thinnest part, %.3g thick, would take too many samples",
                *grid.thinnest);
  return text.data();
}

void print(const SimplifyReport& simplified) {
  if (simplified.tolerance > 0.0)
    std::printf("  %-22s from %s, at most %.3g off them, with a tolerance of %.3g\n", "simplified",
                counted(simplified.trianglesBefore, "triangle").c_str(), simplified.deviation,
                simplified.tolerance);
}

/// Prints what was mended before anything else, and how the other faces are.
void printMended(const RepairReport& report, const std::optional<double>& base) {
  const size_t turned = report.keepsFaces() ? report.stats.turnedFaces.size() : 0;
  std::string words;
  const auto add = [&](const std::string& more) { words += (words.empty() ? "" : ", ") + more; };
  std::array<char, 64> text{};
  if (turned > 0) add("reversed " + counted(turned, "face"));
  if (report.cleanedFaces > 0) add("removed " + counted(report.cleanedFaces, "degenerate or repeated face"));
  if (report.unitedFaces > 0) add("cut " + counted(report.unitedFaces, "face") + " where they met others");
  if (report.sewnVertices > 0)
    add("joined " + counted(report.sewnVertices, "pair") + " of vertices across cracks");
  if (report.movedVertices > 0) add("moved " + counted(report.movedVertices, "corner") + " slightly");
  if (report.closingFaces > 0 && !base)
    add("closed " + counted(report.closedHoles, "hole") + " with " + counted(report.closingFaces, "face"));
  if (base) {
    std::snprintf(text.data(), text.size(), "joined the rim to a base at %g with ", *base);
    add(text.data() + counted(report.closingFaces, "face"));
  }
  if (report.keepsFaces() && report.after.degenerateFaces > 0)
    add("kept " + counted(report.after.degenerateFaces, "degenerate face") + ", as others cross without");
  if (report.keepsFaces() && report.thickenedShare > 0.0) {
    std::snprintf(text.data(), text.size(), "made plates %.3g thick of sheets (%.3g %% of the area)",
                  report.leastThickness, 100.0 * report.thickenedShare);
    add(text.data());
  }
  if (words.empty() && report.depth == RepairDepth::Mended) words = "removed what lies in other parts";
  if (!words.empty())
    std::printf("%s%s\n", words.c_str(),
                report.keepsFaces()
                    ? ", all other faces kept as they are; --remesh makes all faces from the field"
                    : "");
}

void printKept(const RepairReport& report) {
  if (report.simplified.tolerance > 0.0)
    std::printf("its own faces are simplified, as nothing else is wrong with it; --remesh makes new ones\n");
  else if (wordFor(report) == std::string_view("kept"))
    std::printf("kept as it is, because nothing is wrong with it; --remesh makes new faces\n");
}

}  // namespace

bool isSound(const Diagnostics& found) {
  return found.watertight && found.consistentlyOriented && found.signedVolume > 0.0;
}

Json describe(const RepairArguments& arguments, const Grid& grid, const RepairReport& report,
              const std::vector<Stats::Stage>& steps, const MeshWriteOptions& written) {
  const std::optional<LengthUnit> unit =
      unitOf(arguments.units, named(arguments.mesh, arguments.format.input));
  Json json{{"raymap", version().text},
            {"mesh", arguments.mesh.string()},
            {"grid", figuresOf(grid)},
            {"options",
             {{"orientation", name(arguments.options.orientation)},
              {"close_holes", arguments.repair.closeHoles},
              {"offset", arguments.repair.offset},
              {"shell", arguments.repair.shell},
              {"drain_hole", arguments.repair.drainHole},
              {"drain_holes", arguments.repair.drainHoles},
              {"keep_cavities", arguments.repair.keepCavities},
              {"base", arguments.repair.base ? Json(*arguments.repair.base) : Json()},
              {"min_thickness", report.leastThickness},
              {"tolerance", report.simplified.tolerance},
              {"triangles", arguments.repair.triangles},
              {"cut_plane", arguments.cutPlane.empty() ? Json() : Json(arguments.cutPlane)},
              {"remesh", arguments.repair.remesh},
              {"unit", unit ? Json(nameOf(*unit)) : Json()},
              {"scale", arguments.units.scale},
              {"height", arguments.units.height ? Json(*arguments.units.height) : Json()},
              {"fit", arguments.units.fit.empty() ? Json() : Json(arguments.units.fit)},
              {"up", arguments.units.up.empty() ? Json() : Json(arguments.units.up)}}},
            {"file_offset", toJson(written.offset)},
            {"steps", toJson(steps)},
            {"slowest_step", slowestStep(steps).name}};
  json.update(toJson(report));
  return json;
}

const char* wordFor(const RepairReport& report) {
  if (!report.keepsFaces()) return "remade";
  if (report.simplified.tolerance > 0.0) return "simplified";
  return report.depth == RepairDepth::Mended ? "mended" : "kept";
}

void print(const RepairArguments& arguments, const RepairGrid& grid, const RepairReport& report) {
  std::printf("%s: %s, wrong with it: %s\n", displayName(arguments.mesh).c_str(),
              counted(report.before.triangles, "triangle").c_str(),
              describeDefects(report.before, report.crossingBefore).c_str());
  if (const char* const arrangement = describe(report.arrangementBefore); *arrangement != '\0')
    std::printf("  %s\n", arrangement);
  printMended(report, arguments.repair.base);
  if ((arguments.repair.drainHole > 0.0 || arguments.repair.base) && arguments.down.empty())
    std::printf("down is -%s, as the format has it; --up names what is up\n",
                arguments.repair.down.y < 0.0 ? "y" : "z");
  if (report.keepsFaces())
    printKept(report);
  else
    std::printf(
        "%s from a field: %s\ngrid: %d x %d x %d, spacing %g%s\n",
        report.keptFaces > 0
            ? (counted(report.keptFaces, "face") + " of parts that are right kept, all others").c_str()
            : "all faces",
        describe(report.fieldReason), grid.dims.x, grid.dims.y, grid.dims.z, grid.spacing,
        reasonFor(grid).c_str());
  std::printf("result: %s, %s, %s, %s\n", counted(report.after.triangles, "triangle").c_str(),
              counted(report.solids, "solid").c_str(), countedCavities(report.cavities).c_str(),
              isSound(report.after) ? "checked as stored: watertight, faces outwards" : "NOT sound");
  printRemoved(report);
  const Diagnostics &before = report.before, &after = report.after;
  print("bounds, lowest", before.bounds.min, after.bounds.min);
  print("bounds, highest", before.bounds.max, after.bounds.max);
  std::printf("  %-22s %g before, %g after\n", "volume", before.signedVolume, after.signedVolume);
  std::printf("  %-22s %g before, %g after\n", "area", before.area, after.area);
  std::printf("  %-22s %s before, %s after\n", "crossing faces", pairsText(report.crossingBefore).c_str(),
              pairsText(report.crossingAfter).c_str());
  const auto printBuried = [&] {
    printShare(report.buriedShare, "of the mesh lies inside the solid, and is not part of its surface");
  };
  if (report.keepsFaces()) {
    printBuried();
    return print(report.simplified);
  }
  print("result from mesh", report.resultFromMesh, grid.spacing);
  print("mesh from result", report.meshFromResult, grid.spacing);
  if (report.lostShare > 0.0) print("  of it what is kept", report.keptFromResult, grid.spacing);
  if (const size_t turned = report.stats.turnedFaces.size(); turned > 0)
    std::printf("  %-22s %s that pointed the wrong way\n", "reversed", counted(turned, "face").c_str());
  if (const size_t leftOut = report.stats.leftOutFaces.size(); leftOut > 0)
    std::printf("  %-22s %s with the corners of another\n", "left out", counted(leftOut, "face").c_str());
  if (report.stats.patchTriangles > 0)
    std::printf("  %-22s area %.4g\n", "closed holes", report.stats.patchArea);
  printBuried();
  printShare(report.loss.solidShare,
             "of the mesh is lost with the solid that it bounds, thinner than the samples");
  printShare(report.loss.openShare, "of the mesh is lost and bounds no solid: sheets, open surface");
  printShare(report.loss.droppedShare, "of the mesh is lost with the parts that --drop-smaller drops");
  printShare(report.trimmedShare, "of the mesh is removed by the offset: other parts are closer");
  if (arguments.repair.shell > 0.0)
    std::printf("  %s, %s\n", counted(report.hollows, "hollow").c_str(),
                counted(report.drainHoles, "drain hole").c_str());
  for (const auto& [p, d] : report.drainHolePlaces)
    std::printf("  %-22s at %.5g %.5g %.5g, direction %.3g %.3g %.3g\n", "drain hole", p.x, p.y, p.z, d.x,
                d.y, d.z);
  if (report.thickenedShare > 0.0)
    std::printf("  %.3g %% of the mesh's area was thinner than %.4g, and is that thick now\n",
                100.0 * report.thickenedShare, report.leastThickness);
  print(report.simplified);
}

}  // namespace raymap
