#include <raymap/raymap.h>

#include <cstdio>
#include <iostream>

#include "commands.h"
#include "report.h"
#include "terminal.h"

namespace raymap {

namespace {

constexpr const char* kFooter = R"(Examples:
  raymap info scan.ply
  raymap info scan.ply --json | jq .watertight

Measured after joining vertices at exactly equal positions. Only a balanced mesh (every edge used equally
often in both directions) has a certain inside; for any other, 'raymap generate' finds the likeliest one.)";

void print(const Diagnostics& found) {
  const auto count = [](const char* name, size_t value) {
    std::printf("%-24s %s\n", name, grouped(value).c_str());
  };
  const auto yes = [](const char* name, bool value) {
    std::printf("%-24s %s\n", name, value ? "yes" : "no");
  };
  const auto vector = [](const char* name, const glm::dvec3& v) {
    std::printf("%-24s %.9g %.9g %.9g\n", name, v.x, v.y, v.z);
  };
  count("triangles", found.triangles);
  count("vertices", found.vertices);
  count("distinct positions", found.weldedVertices);
  vector("bounds, lowest", found.bounds.min);
  vector("bounds, highest", found.bounds.max);
  vector("size", found.bounds.size());
  std::printf("%-24s %g\n%-24s %g\n", "area", found.area, "signed volume", found.signedVolume);
  count("components", found.components);
  yes("watertight", found.watertight);
  yes("consistently oriented", found.consistentlyOriented);
  yes("balanced", found.balanced);
  count("boundary edges", found.boundaryEdges);
  count("non-manifold edges", found.nonManifoldEdges);
  count("flipped edges", found.flippedEdges);
  count("degenerate faces", found.degenerateFaces);
  count("duplicate faces", found.duplicateFaces);
}

}  // namespace

void addInfo(CLI::App& app) {
  struct Arguments {
    std::filesystem::path mesh;
    bool isJson = false;
  };
  CLI::App* command = app.add_subcommand("info", "Say what is right and wrong with a mesh");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("mesh", arguments->mesh, "OBJ, PLY, STL, OFF, glTF, GLB, 3MF, FBX or DAE")
      ->type_name("MESH")
      ->required();
  command->add_flag("--json", arguments->isJson, "For programs");
  command->footer(kFooter);
  command->callback([arguments] {
    const Diagnostics found = diagnose(readMesh(arguments->mesh, warn));
    if (arguments->isJson)
      std::cout << toJson(found).dump(2) << "\n";
    else
      print(found);
  });
}

}  // namespace raymap
