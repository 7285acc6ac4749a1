#include <gtest/gtest.h>
#include <raymap/diagnostics.h>
#include <raymap/io.h>

#include "samples_3mf.h"

namespace raymap {
namespace {

using namespace samples;

constexpr const char* kModel = "3D/3dmodel.model";
constexpr const char* kNoZip =
    "it is not a whole zip file, as a .3mf or .npz must be: its directory is missing or damaged";

struct Read3mfResult {
  Mesh mesh;
  std::string warnings;  ///< Without the file's name, each with a line end.
};

Read3mfResult readPackage(const std::string& bytes) {
  Read3mfResult result;
  const MeshFile file{std::as_bytes(std::span(bytes)), "a.3mf", [&](const Warning& warning) {
                        result.warnings += warning.message.substr(std::string_view("a.3mf: ").size()) + "\n";
                      }};
  result.mesh = read3mf(file);
  return result;
}

/// Returns the message of the error, without the file's name.
std::string refusal(const std::string& bytes, ErrorCode code = ErrorCode::Input) {
  try {
    readPackage(bytes);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with("a.3mf: ")) << text;
    return text.substr(7);
  }
  return {};
}

std::string refusalOfModel(const std::string& objects, const std::vector<std::string>& items) {
  return refusal(threeMf(model3mf(objects, items)));
}

std::string changedSquare(const std::string& from, const std::string& to) {
  return threeMf(replaced(model3mf(square3mf(1), {R"(objectid="1")"}), from, to));
}

TEST(Read3mf, ReadsASquare) {
  const Read3mfResult found = readPackage(threeMf());
  EXPECT_TRUE(isSquare(found.mesh));
  EXPECT_EQ(found.warnings, "");
  EXPECT_TRUE(isSquare(
      readPackage(package3mf({{kModel, model3mf(square3mf(1), {R"(objectid="1")"})}}, Zip::Stored)).mesh));
}

TEST(Read3mf, AppliesTransformsFromTheInsideOut) {
  // Object 3 doubles object 2, which has one square at x = 10 and one that is turned by 90 degrees about z.
  const std::string objects = square3mf(1) +
                              joined3mf(2, {R"(objectid="1" transform="1 0 0 0 1 0 0 0 1 10 0 0")",
                                            R"(objectid="1" transform="0 1 0 -1 0 0 0 0 1 0 0 0")"}) +
                              joined3mf(3, {R"(objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 0")"});
  const Mesh mesh =
      readPackage(threeMf(model3mf(
                      objects, {R"(objectid="3" transform="1 0 0 0 1 0 0 0 1 0 0 100")", R"(objectid="1")"})))
          .mesh;
  const std::vector<glm::dvec3> expected{{20, 0, 100}, {22, 0, 100}, {22, 2, 100}, {20, 2, 100},
                                         {0, 0, 100},  {0, 2, 100},  {-2, 2, 100}, {-2, 0, 100},
                                         {0, 0, 0},    {1, 0, 0},    {1, 1, 0},    {0, 1, 0}};
  ASSERT_EQ(mesh.vertices.size(), expected.size());
  for (uint32_t v = 0; v < expected.size(); ++v) EXPECT_EQ(mesh.position(v), expected[v]) << v;
  const std::vector<glm::uvec3> triangles{{0, 1, 2}, {0, 2, 3},  {4, 5, 6},
                                          {4, 6, 7}, {8, 9, 10}, {8, 10, 11}};
  EXPECT_EQ(mesh.triangles, triangles);
}

TEST(Read3mf, TakesEachNumberOfATransformForItsPlace) {
  // The image of (x, y, z) is x * row 0 + y * row 1 + z * row 2 + row 3, as the standard says.
  const std::string object =
      replaced(square3mf(1), R"(<vertex x="1" y="1" z="0"/>)", R"(<vertex x="3" y="5" z="7"/>)");
  const Mesh mesh =
      readPackage(
          threeMf(model3mf(object, {R"(objectid="1" transform=" 2 3 5  7 11 13 17 19 29 31 37 41 ")"})))
          .mesh;
  EXPECT_EQ(mesh.position(2), glm::dvec3(3 * 2 + 5 * 7 + 7 * 17 + 31, 3 * 3 + 5 * 11 + 7 * 19 + 37,
                                         3 * 5 + 5 * 13 + 7 * 29 + 41));
}

TEST(Read3mf, KeepsTheOutsideOfMirroredObjects) {
  const std::string mirror = R"(transform="-1 0 0 0 1 0 0 0 1 0 0 0")";
  EXPECT_EQ(areaVector(readPackage(threeMf(model3mf(square3mf(1), {"objectid=\"1\" " + mirror}))).mesh),
            glm::dvec3(0, 0, 1));
  const std::string twice = square3mf(1) + joined3mf(2, {"objectid=\"1\" " + mirror});
  const Mesh mesh = readPackage(threeMf(model3mf(twice, {"objectid=\"2\" " + mirror}))).mesh;
  EXPECT_TRUE(isSquare(mesh));
  EXPECT_EQ(mesh.triangles.front(), glm::uvec3(0, 1, 2));
}

TEST(Read3mf, FollowsPathsOfTheProductionExtension) {
  const std::string root = model3mf(
      square3mf(7) +
          joined3mf(2,
                    {R"(p:path="/3D/Objects/part.model" objectid="7" transform="1 0 0 0 1 0 0 0 1 10 0 0")",
                     R"(objectid="7")"}),
      {R"(objectid="2")", R"(objectid="1" p:path="/3D/Objects/part.model")"}, R"( requiredextensions="p")");
  const std::string part =
      model3mf(replaced(square3mf(7), R"(<vertex x="1" y="1" z="0"/>)", R"(<vertex x="1" y="1" z="5"/>)") +
                   joined3mf(1, {R"(objectid="7" transform="1 0 0 0 1 0 0 0 1 0 20 0")"}),
               {});
  const Mesh mesh = readPackage(package3mf({{kModel, root}, {"3D/Objects/part.model", part}})).mesh;
  EXPECT_EQ(mesh.triangles.size(), 6u);
  EXPECT_EQ(mesh.position(2), glm::dvec3(11, 1, 5));
  EXPECT_EQ(mesh.position(6), glm::dvec3(1, 1, 0)) << "object 7 of the root, not of the part";
  EXPECT_EQ(mesh.position(10), glm::dvec3(1, 21, 5));
}

TEST(Read3mf, FindsPartsByTheNamesOfPackages) {
  const auto withPath = [](const std::string& path) {
    return model3mf("", {"objectid=\"1\" p:path=\"" + path + "\""});
  };
  const std::string part = model3mf(square3mf(1), {});
  EXPECT_TRUE(isSquare(
      readPackage(package3mf({{kModel, withPath("/3d/OBJECTS/a b.model")}, {"3D/Objects/a b.model", part}}))
          .mesh));
  EXPECT_TRUE(isSquare(
      readPackage(package3mf({{kModel, withPath("/3D/a%20b.model")}, {"3D/a b.model", part}})).mesh));
  EXPECT_TRUE(isSquare(
      readPackage(package3mf({{kModel, withPath("/3D/a%20b.model")}, {"3D/a%20b.model", part}})).mesh));
}

TEST(Read3mf, ConvertsEachUnitToMillimetres) {
  const std::vector<std::pair<std::string, double>> units{
      {"micron", 0.001}, {"centimeter", 10}, {"inch", 25.4}, {"foot", 304.8}, {"meter", 1000}};
  for (const auto& [unit, factor] : units) {
    const Read3mfResult found = readPackage(threeMf(model3mf(
        square3mf(1), {R"(objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 2")"}, " unit=\"" + unit + "\"")));
    const Box box = bounds(found.mesh);
    EXPECT_NEAR(box.max.x - box.min.x, factor, 1e-6 * factor) << unit;
    EXPECT_NEAR(box.min.z, 2 * factor, 1e-6 * factor) << unit;
    EXPECT_EQ(found.warnings, "3D/3dmodel.model is in the unit " + unit + "; converted to millimetres\n");
  }
  EXPECT_TRUE(isSquare(readPackage(threeMf(model3mf(square3mf(1), {R"(objectid="1")"}, ""))).mesh))
      << "the default unit";
}

TEST(Read3mf, ConvertsEachPartFromItsOwnUnit) {
  const std::string root = model3mf(
      "", {R"(objectid="1" p:path="/b.model" transform="1 0 0 0 1 0 0 0 1 0 0 3")"}, R"( unit="meter")");
  const Mesh mesh =
      readPackage(
          package3mf({{kModel, root}, {"b.model", model3mf(square3mf(1), {}, R"( unit="centimeter")")}}))
          .mesh;
  EXPECT_EQ(mesh.position(2), glm::dvec3(10, 10, 3000));
}

TEST(Read3mf, LeavesOutWhatIsNotPrinted) {
  const std::string at = R"( transform="1 0 0 0 1 0 0 0 1 0 0 9")";
  const Read3mfResult items = readPackage(threeMf(
      model3mf(square3mf(1), {R"(objectid="1" printable="1")", R"(objectid="1" printable="0")" + at})));
  EXPECT_TRUE(isSquare(items.mesh));
  EXPECT_EQ(items.warnings, "1 item of the build left out, for printable is 0\n");
  const Read3mfResult types = readPackage(threeMf(
      model3mf(square3mf(1, R"( type="surface")") + square3mf(2, R"( type="support")") +
                   square3mf(3, R"( type="other")") + square3mf(4, R"( type="solidsupport")") +
                   joined3mf(5, {R"(objectid="1")", R"(objectid="3")" + at}),
               {R"(objectid="5")", R"(objectid="2")" + at, R"(objectid="2")" + at, R"(objectid="4")" + at})));
  EXPECT_TRUE(isSquare(types.mesh));
  EXPECT_EQ(types.warnings, "3 objects of type support, solidsupport or other left out\n");
}

TEST(Read3mf, KeepsFarPositionsInDoublePrecision) {
  const Mesh mesh =
      readPackage(changedSquare(R"(</vertices>)", R"(<vertex x="0" y="0" z="0"/></vertices>)")).mesh;
  EXPECT_EQ(mesh.vertices.size(), 5u) << "vertices that no triangle uses stay";
  const Mesh far =
      readPackage(
          threeMf(model3mf(square3mf(1), {R"(objectid="1" transform="1 0 0 0 1 0 0 0 1 1e9 .5 +2.5E-1")"})))
          .mesh;
  EXPECT_EQ(far.position(2), glm::dvec3(1e9 + 1, 1.5, 0.25));
}

TEST(Read3mf, IgnoresWhatHoldsNoGeometry) {
  const std::string foreign =
      R"(<metadata name="Title">A &amp; B</metadata><m:x xmlns:m="http://m"><vertex x="9"/><m:object id="1"/></m:x>)";
  EXPECT_TRUE(isSquare(readPackage(changedSquare("<resources>", foreign + "<resources>" + foreign)).mesh));
  EXPECT_TRUE(
      isSquare(readPackage(changedSquare("<triangles>",
                                         "<q:triangles xmlns:q=\"http://q\"><q:triangle/></q:triangles>"
                                         "<!-- more --><triangles>"))
                   .mesh));
  const std::string deep = [] {
    std::string xml;
    for (int i = 0; i < 100000; ++i) xml += "<a>";
    for (int i = 0; i < 100000; ++i) xml += "</a>";
    return xml;
  }();
  EXPECT_TRUE(isSquare(readPackage(changedSquare("<resources>", deep + "<resources>")).mesh));
}

TEST(Read3mf, TellsWhichElementIsDamaged) {
  const std::string at = "3D/3dmodel.model, line 3: ";
  EXPECT_EQ(refusal(changedSquare(R"(x="1" y="1")", R"(x="1 2" y="1")")),
            at + "vertex 2 of object 1: x is '1 2', which is not a finite number");
  for (const std::string value : {"", "nan", "inf", "1e999", "0x1", "1,5"})
    EXPECT_EQ(refusal(changedSquare(R"(x="1" y="1")", "x=\"1\" y=\"" + value + "\"")),
              at + "vertex 2 of object 1: y is '" + value + "', which is not a finite number");
  EXPECT_EQ(refusal(changedSquare(R"(x="1" y="1" z="0")", R"(x="1" y="1")")),
            at + "vertex 2 of object 1: has no z");
  EXPECT_EQ(refusal(changedSquare(R"(v3="3")", R"(v3="4")")),
            at + "triangle 1 of object 1: v3 is 4, but the object has 4 vertices");
  EXPECT_EQ(refusal(changedSquare(R"(v3="3")", R"(v3="-1")")),
            at + "triangle 1 of object 1: v3 is '-1', which is not a vertex index");
  EXPECT_EQ(refusal(changedSquare(R"(v3="3")", R"(v3="4294967296")")),
            at + "triangle 1 of object 1: v3 is '4294967296', which is not a vertex index");
  EXPECT_EQ(refusal(changedSquare(R"(v2="2")", "")), at + "triangle 1 of object 1: has no v2");
  EXPECT_EQ(refusal(changedSquare(R"(unit="millimeter")", R"(unit="mm")")),
            "3D/3dmodel.model, line 2: its unit is 'mm'; 3MF knows micron, millimeter, centimeter, inch, "
            "foot and meter");
  EXPECT_EQ(refusal(changedSquare(R"(id="1")", R"(id="1" type="part")")),
            at + "the type of object 1 is 'part'; 3MF knows model, surface, support, solidsupport and other");
  EXPECT_EQ(refusal(changedSquare(R"(id="1")", R"(id="x")")),
            at + "the id of an element 'object' is 'x', which is not an object's number");
  EXPECT_EQ(refusal(changedSquare(R"(<object id="1")", "<object")), at + "an element 'object' has no id");
  EXPECT_EQ(refusalOfModel(square3mf(1) + square3mf(1), {}), at + "there are two objects with the id 1");
  EXPECT_EQ(refusalOfModel(square3mf(1), {""}), at + "an element 'item' has no objectid");
  EXPECT_EQ(
      refusalOfModel(square3mf(1), {R"(objectid="1")", R"(objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0")"}),
      at + "item 1: has a transform of 11 numbers; 3MF wants 12");
  EXPECT_EQ(refusalOfModel(square3mf(1), {R"(objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 inf")"}),
            at + "item 0: transform is 'inf', which is not a finite number");
}

TEST(Read3mf, TellsWhatIsMissing) {
  const std::string at = "3D/3dmodel.model, line 3: ";
  EXPECT_EQ(refusalOfModel(square3mf(1), {R"(objectid="2")"}), at + "3D/3dmodel.model has no object 2");
  EXPECT_EQ(refusalOfModel(square3mf(1), {R"(objectid="1" p:path="/3D/b.model")"}),
            at + "there is no part '3D/b.model'");
  EXPECT_EQ(refusal(package3mf({{kModel, model3mf("", {R"(objectid="3" p:path="/b.model")"})},
                                {"b.model", model3mf(square3mf(1), {})}})),
            at + "b.model has no object 3");
  EXPECT_EQ(refusalOfModel(square3mf(1), {}), "3D/3dmodel.model: its build places no triangles");
  EXPECT_EQ(refusal(package3mf({})), "it has no part '3D/3dmodel.model'");
  EXPECT_EQ(refusal(zipFile({{"a", "b"}})), "it has no part '_rels/.rels'");
  EXPECT_EQ(refusal(zipFile({{"_rels/.rels", "<Relationships/>"}})), "_rels/.rels: it names no 3D model");
  EXPECT_EQ(refusal("no archive"), kNoZip);
  EXPECT_EQ(refusal(threeMf("<html/>")), "3D/3dmodel.model, line 1: its root is 'html', not 'model'");
  EXPECT_EQ(refusal(package3mf({{kModel, ""}, {"3d/3DMODEL.model", ""}})),
            "it has the part '3d/3DMODEL.model' twice");
}

TEST(Read3mf, RefusesExtensionsThatChangeShapes) {
  const auto requiring = [](const std::string& attributes) {
    return threeMf(model3mf(square3mf(1), {R"(objectid="1")"}, attributes));
  };
  EXPECT_EQ(refusal(requiring(R"( requiredextensions="p b" xmlns:b="http://beams")"), ErrorCode::Unsupported),
            "3D/3dmodel.model: it requires the extension http://beams, which raymap does not read; export it "
            "as plain triangles");
  EXPECT_EQ(refusal(requiring(R"( requiredextensions="b")")),
            "3D/3dmodel.model, line 2: it requires the extension 'b', which it does not declare");
  EXPECT_TRUE(isSquare(
      readPackage(requiring(R"( requiredextensions=" m  p " xmlns:b="http://beams" )"
                            R"(xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02")"))
          .mesh));
}

TEST(Read3mf, RefusesObjectsThatContainThemselves) {
  const std::string at = "3D/3dmodel.model, line 3: ";
  EXPECT_EQ(refusalOfModel(joined3mf(2, {R"(objectid="2")"}), {R"(objectid="2")"}),
            at + "object 2 contains itself");
  EXPECT_EQ(refusalOfModel(joined3mf(2, {R"(objectid="3")"}) + joined3mf(3, {R"(objectid="2")"}),
                           {R"(objectid="3")"}),
            at + "object 3 contains itself");
  EXPECT_TRUE(isSquare(
      readPackage(threeMf(model3mf(square3mf(1) + joined3mf(2, {R"(objectid="2")"}), {R"(objectid="1")"})))
          .mesh))
      << "nothing places object 2";
}

/// Returns objects 2, 3, … that hold the one before them `copies` times.
std::string tower(int highest, int copies) {
  std::string objects = square3mf(1);
  for (int id = 2; id <= highest; ++id)
    objects += joined3mf(id, std::vector<std::string>(copies, "objectid=\"" + std::to_string(id - 1) + "\""));
  return objects;
}

TEST(Read3mf, LimitsTheDepthOfComponents) {
  // Object 65 has 64 components in each other.
  EXPECT_TRUE(isSquare(readPackage(threeMf(model3mf(tower(65, 1), {R"(objectid="65")"}))).mesh));
  const std::string tooDeep = "3D/3dmodel.model, line 3: components are nested more than 64 deep";
  EXPECT_EQ(refusalOfModel(tower(66, 1), {R"(objectid="66")"}), tooDeep);
  EXPECT_EQ(refusalOfModel(tower(66, 1), {R"(objectid="30")", R"(objectid="65")", R"(objectid="66")"}),
            tooDeep);
  EXPECT_EQ(refusalOfModel(tower(100000, 1), {R"(objectid="100000")"}), tooDeep);
}

TEST(Read3mf, LimitsTheNumberOfInstances) {
  EXPECT_EQ(readPackage(threeMf(model3mf(tower(4, 10), {R"(objectid="4")"}))).mesh.triangles.size(), 2000u);
  const std::string error = refusalOfModel(tower(40, 10), {R"(objectid="40")"});
  EXPECT_TRUE(contains(error, " bytes stand for at least ")) << error;
  EXPECT_TRUE(contains(error, "of a file of this size at most 64 MiB are read")) << error;
  std::string empty = replaced(tower(40, 10), square3mf(1), R"(<object id="1"/>)");
  EXPECT_EQ(refusalOfModel(empty, {R"(objectid="40")"}), "3D/3dmodel.model: its build places no triangles");
}

TEST(Read3mf, RefusesDamagedArchives) {
  const std::string whole = package3mf({{kModel, model3mf(square3mf(1), {R"(objectid="1")"})}}, Zip::Stored);
  EXPECT_EQ(refusal(replaced(whole, "vertex x=\"1\" y=\"1\"", "vertex x=\"1\" y=\"7\"")),
            "the checksum of its part '3D/3dmodel.model' is wrong");
  EXPECT_EQ(refusal(whole.substr(0, whole.size() - 30)), kNoZip);
  std::string encrypted = whole;
  const size_t entry = whole.find(raw(uint32_t{0x02014b50}),
                                  whole.find(raw(uint32_t{0x02014b50}), whole.find("PK\1\2") + 1) + 1);
  encrypted[entry + 8] = 1;
  EXPECT_EQ(refusal(encrypted, ErrorCode::Unsupported), "its part '3D/3dmodel.model' is encrypted");
  std::string packed = whole;
  packed[entry + 10] = 12;
  EXPECT_EQ(refusal(packed, ErrorCode::Unsupported),
            "its part '3D/3dmodel.model' is compressed by another method than deflate");
}

TEST(Read3mf, ReadsSizesOf64Bits) {
  const std::string whole =
      package3mf({{kModel, model3mf(square3mf(1), {R"(objectid="1")"})}}, Zip::StoredIn64Bits);
  EXPECT_TRUE(isSquare(readPackage(whole).mesh));
  for (size_t size = 0; size < whole.size(); ++size) EXPECT_NE(refusal(whole.substr(0, size)), "") << size;
  EXPECT_EQ(refusal(replaced(whole, "PK\6\6", "PK\6\5")), kNoZip);
}

TEST(Read3mf, RefusesDamagedDirectories) {
  const std::string whole = package3mf({{kModel, model3mf(square3mf(1), {R"(objectid="1")"})}}, Zip::Stored);
  const size_t entry = whole.rfind("PK\1\2"), end = whole.rfind("PK\5\6");
  const auto changed = [&](size_t at, const std::string& bytes) {
    std::string damaged = whole;
    return damaged.replace(at, bytes.size(), bytes);
  };
  EXPECT_EQ(refusal(changed(entry, "XX")), kNoZip);
  EXPECT_EQ(refusal(changed(end + 10, raw(uint16_t{4}))), kNoZip) << "one entry too many";
  EXPECT_EQ(refusal(changed(end + 12, raw(static_cast<uint32_t>(whole.size())))), kNoZip);
  EXPECT_EQ(refusal(changed(end + 16, raw(uint32_t{0xfffffffe}))), kNoZip);
  const std::string damaged = "its part '3D/3dmodel.model' is damaged or ends early";
  EXPECT_EQ(refusal(changed(entry + 20, raw(uint32_t{0x7fffffff}))), damaged) << "content beyond the end";
  EXPECT_EQ(refusal(changed(entry + 42, raw(uint32_t{1}))), damaged);
  EXPECT_EQ(refusal(changed(entry + 30, raw(uint16_t{60000}))), kNoZip) << "extra field beyond the end";
  EXPECT_TRUE(isSquare(readPackage(whole.substr(0, whole.size() - 2) + raw(uint16_t{3}) + "PK!").mesh))
      << "a comment";
  std::string cut = package3mf({{kModel, model3mf(square3mf(1), {R"(objectid="1")"})}});
  const size_t deflatedEntry = cut.rfind("PK\1\2");
  cut.replace(deflatedEntry + 20, 4, raw(uint32_t{100}));
  EXPECT_EQ(refusal(cut), "the checksum of its part '3D/3dmodel.model' is wrong");
}

TEST(Read3mf, LimitsWhatAFileInflatesTo) {
  const std::string blanks(size_t{64} << 20, ' ');
  EXPECT_EQ(
      refusal(changedSquare("<resources>", blanks + "<resources>")),
      "its part '3D/3dmodel.model' inflates to more than 200 times the size of the file, as no model does");
  EXPECT_TRUE(isSquare(
      readPackage(changedSquare("<resources>", std::string(size_t{1} << 19, ' ') + "<resources>")).mesh));
}

TEST(Read3mf, RefusesDamagedXml) {
  EXPECT_EQ(refusal(changedSquare("</resources>", "")), "3D/3dmodel.model, line 3: mismatched tag");
  EXPECT_EQ(refusal(changedSquare("</model>", "")), "3D/3dmodel.model, line 3: no element found");
  EXPECT_EQ(refusal(changedSquare("<model", "<!DOCTYPE m [<!ENTITY a \"b\">]><model")),
            "3D/3dmodel.model, line 2: it has a DOCTYPE, which 3MF forbids");
  EXPECT_EQ(refusal(changedSquare("x=\"1\"", "x=\"&a;\"")), "3D/3dmodel.model, line 3: undefined entity");
  EXPECT_EQ(refusal(changedSquare("x=\"1\"", "x=\"1\" x=\"2\"")),
            "3D/3dmodel.model, line 3: duplicate attribute");
  std::string noise;
  uint32_t state = 1;
  for (int i = 0; i < 3 << 20; ++i)
    noise += static_cast<char>('a' + (state = state * 1664525 + 1013904223) % 26);
  EXPECT_EQ(refusal(changedSquare("<resources>", "<!-- " + noise + " --><resources>")),
            "3D/3dmodel.model, line 3: a tag or comment is longer than 1 MiB");
}

}  // namespace
}  // namespace raymap
