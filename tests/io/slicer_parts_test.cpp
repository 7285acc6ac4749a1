// 3MF projects of slicers: what they do not print is left out.

#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include "samples_3mf.h"

namespace raymap {
namespace {

using namespace samples;

constexpr const char* kPrusaConfig = "Metadata/Slic3r_PE_model.config";
constexpr const char* kBambuConfig = "Metadata/model_settings.config";

struct ProjectOutcome {
  Mesh mesh;
  std::string warnings, error;  ///< Without the file's name.
};

ProjectOutcome projectOutcome(const Parts& parts) {
  const std::string bytes = package3mf(parts);
  ProjectOutcome result;
  try {
    result.mesh = read3mf({std::as_bytes(std::span(bytes)), "a.3mf",
                           [&](const Warning& w) { result.warnings += w.message.substr(7) + "\n"; }});
  } catch (const Error& error) {
    result.error = std::string(error.what()).substr(7);
    EXPECT_EQ(error.code(),
              result.error.find("negative") != result.error.npos ? ErrorCode::Unsupported : ErrorCode::Input);
  }
  return result;
}

/// Returns an object of four triangles over seven vertices, x from 0 to 6; each shares one vertex with the
/// next, but the second, whose last is its own.
std::string stripObject(int id) {
  std::string xml = "<object id=\"" + std::to_string(id) + "\"><mesh><vertices>";
  for (int x = 0; x < 7; ++x)
    xml += "<vertex x=\"" + std::to_string(x) + "\" y=\"" + std::to_string(x % 2) + "\" z=\"0\"/>";
  xml += "</vertices><triangles>";
  for (const char* t : {R"(v1="0" v2="1" v3="2")", R"(v1="2" v2="1" v3="3")", R"(v1="2" v2="4" v3="5")",
                        R"(v1="4" v2="5" v3="6")"})
    xml += std::string("<triangle ") + t + "/>";
  return xml + "</triangles></mesh></object>";
}

/// Returns an element of PrusaSlicer's file.
std::string prusaVolume(int first, int last, const std::string& type,
                        const std::string& key = "volume_type") {
  return "<volume firstid=\"" + std::to_string(first) + "\" lastid=\"" + std::to_string(last) +
         "\"><metadata type=\"volume\" key=\"name\" value=\"SupportBlocker\"/><metadata type=\"volume\" "
         "key=\"" +
         key + "\" value=\"" + type + "\"/><slic3rpe:shape/></volume>";
}

ProjectOutcome prusaProject(const std::string& volumes, const std::string& items = R"(objectid="1")") {
  return projectOutcome({{"3D/3dmodel.model", model3mf(stripObject(1), {items})},
                         {kPrusaConfig, "<config>\n<object id=\"1\">" + volumes + "</object></config>"}});
}

TEST(SlicerParts, LeavesOutTrianglesOfEachKind) {
  for (const auto& [type, text] :
       std::vector<std::pair<std::string, std::string>>{{"ParameterModifier", "1 modifier"},
                                                        {"SupportBlocker", "1 support blocker"},
                                                        {"SupportEnforcer", "1 support enforcer"}}) {
    const ProjectOutcome found = prusaProject(prusaVolume(0, 0, "ModelPart") + prusaVolume(1, 1, type) +
                                              prusaVolume(2, 3, "ModelPart"));
    EXPECT_EQ(found.error, "");
    EXPECT_EQ(found.warnings, text + " left out, for the slicer's project does not print such parts\n");
    ASSERT_EQ(found.mesh.triangles.size(), 3u) << type;
    ASSERT_EQ(found.mesh.vertices.size(), 6u) << "vertex 3 is the second triangle's alone";
    EXPECT_EQ(found.mesh.triangles[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(found.mesh.triangles[1], glm::uvec3(2, 3, 4));
    EXPECT_EQ(found.mesh.triangles[2], glm::uvec3(3, 4, 5));
    EXPECT_EQ(found.mesh.position(3), glm::dvec3(4, 0, 0));
    EXPECT_EQ(found.mesh.position(5), glm::dvec3(6, 0, 0));
  }
}

TEST(SlicerParts, CountsThemInOneWarning) {
  const ProjectOutcome found =
      prusaProject(prusaVolume(0, 0, "ModelPart") + prusaVolume(1, 1, "SupportBlocker") +
                   prusaVolume(2, 2, "1", "modifier") + prusaVolume(3, 3, "SupportBlocker"));
  EXPECT_EQ(found.mesh.triangles.size(), 1u);
  EXPECT_EQ(
      found.warnings,
      "1 modifier and 2 support blockers left out, for the slicer's project does not print such parts\n");
  EXPECT_EQ(prusaProject(prusaVolume(0, 0, "ModelPart") + prusaVolume(1, 1, "SupportEnforcer") +
                         prusaVolume(2, 2, "ParameterModifier") + prusaVolume(3, 3, "SupportBlocker"))
                .warnings,
            "1 modifier, 1 support blocker and 1 support enforcer left out, for the slicer's project does "
            "not print such parts\n");
}

TEST(SlicerParts, LeavesBodiesAsTheyAre) {
  for (const std::string& volumes :
       {prusaVolume(0, 3, "ModelPart"), prusaVolume(0, 3, "0", "modifier"), std::string(),
        prusaVolume(0, 9, "ModelPart"), std::string("<volume/><other id=\"1\"/>")}) {
    const ProjectOutcome found = prusaProject(volumes);
    EXPECT_EQ(found.error, "");
    EXPECT_EQ(found.warnings, "");
    EXPECT_EQ(found.mesh.triangles.size(), 4u);
    EXPECT_EQ(found.mesh.vertices.size(), 7u);
  }
}

TEST(SlicerParts, RefusesNegativeVolumes) {
  const ProjectOutcome found =
      prusaProject(prusaVolume(0, 1, "ModelPart") + prusaVolume(2, 3, "NegativeVolume"));
  EXPECT_EQ(
      found.error,
      "3D/3dmodel.model: object 1 has 1 negative part, to be cut out of it, and meshes cannot be subtracted "
      "here; do that in the slicer (a mesh boolean, or its export as STL), or delete the part there");
}

TEST(SlicerParts, HoldForPlacedObjectsAlone) {
  const std::string config = "<config><object id=\"1\">" + prusaVolume(0, 3, "NegativeVolume") +
                             "</object><object id=\"2\">" + prusaVolume(0, 0, "SupportBlocker") +
                             "</object><object id=\"9\">" + prusaVolume(0, 99, "SupportBlocker") +
                             "</object><plate><part id=\"2\" subtype=\"negative_part\"/></plate></config>";
  const std::string place = R"(objectid="2" transform="1 0 0 0 1 0 0 0 1 10 0 0")";
  const ProjectOutcome found = projectOutcome(
      {{"3D/3dmodel.model", model3mf(stripObject(1) + stripObject(2),
                                     {R"(objectid="2")", place, R"(objectid="1" printable="0")"})},
       {kPrusaConfig, config}});
  EXPECT_EQ(found.error, "");
  EXPECT_EQ(found.mesh.triangles.size(), 6u);
  EXPECT_EQ(found.warnings,
            "1 item of the build left out, for printable is 0\n"
            "1 support blocker left out, for the slicer's project does not print such parts\n");
}

TEST(SlicerParts, RefusesTrianglesThatAreNotThere) {
  EXPECT_EQ(prusaProject(prusaVolume(3, 4, "SupportBlocker")).error,
            "Metadata/Slic3r_PE_model.config, line 2: a part has the triangles 3 to 4 of an object with 4 "
            "triangles");
  EXPECT_EQ(prusaProject(prusaVolume(2, 1, "SupportBlocker")).error,
            "Metadata/Slic3r_PE_model.config, line 2: a part has the triangles 2 to 1 of an object with 4 "
            "triangles");
  EXPECT_EQ(prusaProject(prusaVolume(0, 3, "SupportBlocker")).error,
            "3D/3dmodel.model: its build places no triangles");
}

TEST(SlicerParts, ReadsUnknownKindsAsSolid) {
  const ProjectOutcome found = prusaProject(prusaVolume(0, 3, "Scaffold"));
  EXPECT_EQ(found.mesh.triangles.size(), 4u);
  EXPECT_EQ(found.warnings,
            "Metadata/Slic3r_PE_model.config, line 2: a part of object 1 has the unknown type 'Scaffold'; "
            "read as solid\n");
}

/// Reads squares that an object places by a part of their own, as Bambu Studio writes them.
ProjectOutcome bambuProject(const std::vector<std::string>& components, const std::string& parts) {
  const std::string path = R"( p:path="/3D/Objects/object_1.model")";
  std::vector<std::string> placed;
  for (size_t i = 0; i < components.size(); ++i)
    placed.push_back(components[i] + path + " transform=\"1 0 0 0 1 0 0 0 1 " + std::to_string(10 * i) +
                     " 0 0\"");
  return projectOutcome({{"3D/3dmodel.model", model3mf(joined3mf(3, placed), {R"(objectid="3")"})},
                         {"3D/Objects/object_1.model", model3mf(square3mf(1) + square3mf(2), {})},
                         {kBambuConfig, "<config><object id=\"3\"><metadata key=\"name\" value=\"a\"/>" +
                                            parts + "</object></config>"}});
}

std::string bambuPart(int id, const std::string& subtype) {
  return "<part id=\"" + std::to_string(id) + "\" subtype=\"" + subtype +
         "\"><metadata key=\"name\" value=\"x\"/></part>";
}

TEST(SlicerParts, LeavesOutComponents) {
  for (const auto& [type, text] :
       std::vector<std::pair<std::string, std::string>>{{"modifier_part", "1 modifier"},
                                                        {"support_blocker", "1 support blocker"},
                                                        {"support_enforcer", "1 support enforcer"}}) {
    const ProjectOutcome found = bambuProject({R"(objectid="1")", R"(objectid="2")"},
                                              bambuPart(1, "normal_part") + bambuPart(2, type));
    EXPECT_TRUE(isSquare(found.mesh));
    EXPECT_EQ(found.warnings, text + " left out, for the slicer's project does not print such parts\n");
  }
  const ProjectOutcome all = bambuProject({R"(objectid="1")", R"(objectid="2")"},
                                          bambuPart(1, "normal_part") + bambuPart(2, "normal_part"));
  EXPECT_EQ(all.mesh.triangles.size(), 4u);
  EXPECT_EQ(all.warnings, "");
  EXPECT_TRUE(
      contains(bambuProject({R"(objectid="1")", R"(objectid="2")"}, bambuPart(2, "negative_part")).error,
               "object 3 has 1 negative part"));
}

TEST(SlicerParts, TellsComponentsOfOneObjectApart) {
  // The second of three copies blocks supports; a part without a component does not count.
  const ProjectOutcome found =
      bambuProject({R"(objectid="1")", R"(objectid="1")", R"(objectid="1")"},
                   bambuPart(1, "normal_part") + bambuPart(1, "support_blocker") +
                       bambuPart(1, "normal_part") + bambuPart(7, "support_blocker"));
  EXPECT_EQ(found.mesh.triangles.size(), 4u);
  EXPECT_EQ(bounds(found.mesh).max.x, 21);
  EXPECT_EQ(found.mesh.position(4).x, 20);
  // One part stands for all copies.
  EXPECT_EQ(
      bambuProject({R"(objectid="1")", R"(objectid="2")", R"(objectid="1")"}, bambuPart(1, "support_blocker"))
          .warnings,
      "2 support blockers left out, for the slicer's project does not print such parts\n");
}

TEST(SlicerParts, SurvivesAnyByte) {
  const std::string config = "<config><object id=\"1\">" + prusaVolume(0, 0, "ModelPart") +
                             prusaVolume(1, 3, "SupportBlocker") + "</object></config>";
  for (size_t at = 0; at < config.size(); ++at)
    for (const char value : {'9', '<'}) {
      std::string damaged = config;
      damaged[at] = value;
      projectOutcome(
          {{"3D/3dmodel.model", model3mf(stripObject(1), {R"(objectid="1")"})}, {kPrusaConfig, damaged}});
    }
}

TEST(SlicerParts, RefusesDamagedConfigs) {
  EXPECT_TRUE(contains(projectOutcome({{"3D/3dmodel.model", model3mf(stripObject(1), {R"(objectid="1")"})},
                                       {kBambuConfig, "<config>\n<object"}})
                           .error,
                       "Metadata/model_settings.config, line 2: "));
}

}  // namespace
}  // namespace raymap
