#include <gtest/gtest.h>
#include <raymap/page.h>
#include <raymap/surface.h>
#include <zlib.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytic_fields.h"
#include "error_code.h"
#include "files.h"
#include "shapes.h"

namespace raymap {
namespace {

/// Returns the text of the page between `<script … id="name">` and its end.
std::string scriptOf(const std::string& page, const std::string& name) {
  const size_t id = page.find("id=\"" + name + "\">");
  const size_t begin = page.find('>', id) + 1;
  return page.substr(begin, page.find("</script>", begin) - begin);
}

std::vector<uint8_t> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int count = 0;
  EXPECT_EQ(text.size() % 4, 0u);
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<uint32_t>(digits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<uint8_t>(bits >> count & 255u));
  }
  return bytes;
}

nlohmann::json dataOf(const std::string& page) {
  return nlohmann::json::parse(scriptOf(page, "page"));
}

/// Returns an array that a page holds, in its unit.
std::vector<double> numbersOf(const std::string& page, size_t array) {
  const auto data = dataOf(page);
  const glm::ivec3 dims(data["dims"][0], data["dims"][1], data["dims"][2]);
  const double step = data["arrays"][array]["step"];
  const std::vector<uint8_t> packed = decoded(scriptOf(page, "array" + std::to_string(array)));
  const size_t count = size_t(dims.x) * size_t(dims.y) * size_t(dims.z);
  std::vector<uint8_t> bytes(2 * count);
  uLongf size = uLongf(bytes.size());
  EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), uLong(packed.size())), Z_OK);
  EXPECT_EQ(size, bytes.size());
  const Grid grid{.dims = dims};
  std::vector<int16_t> values(count);
  std::vector<double> numbers(count);
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i) {
        int suggested = 0;
        for (int corner = 1; corner < 8; ++corner) {
          const glm::ivec3 back(corner & 1, corner >> 1 & 1, corner >> 2);
          const glm::ivec3 at = glm::ivec3(i, j, k) - back;
          if (at.x < 0 || at.y < 0 || at.z < 0) continue;
          suggested += ((back.x + back.y + back.z) % 2 == 1 ? 1 : -1) * values[grid.index(at)];
        }
        const size_t s = grid.index({i, j, k});
        values[s] = static_cast<int16_t>(suggested + (bytes[s] | bytes[count + s] << 8));
        numbers[s] = values[s] * step;
      }
  return numbers;
}

const RenderOptions kSmall{.width = 32, .height = 24};

Field sphereField(const glm::ivec3& dims, double radius, double spacing) {
  const Grid grid{.dims = dims, .origin = -0.5 * spacing * glm::dvec3(dims - 1), .spacing = spacing};
  return analytic::sampled(grid, [&](const glm::dvec3& p) { return analytic::sphere(p, radius * spacing); });
}

TEST(Page, HasATitleThatCannotTurnItself) {
  const Field field = sphereField({9, 9, 9}, 3.0, 0.25);
  const std::string page = makePage(field, kSmall, {.title = "a\xe2\x80\xae\x1b\xff<"}).html;
  EXPECT_NE(page.find("<title>a\\u202e\\x1b\\xff&lt;</title>"), std::string::npos);
  EXPECT_EQ(dataOf(page)["fields"][0]["name"], "a\\u202e\\x1b\\xff<");
  EXPECT_EQ(page.find("\xe2\x80\xae"), std::string::npos);
}

TEST(Page, HoldsTheDistances) {
  const TemporaryFolder folder;
  const Field field = sphereField({19, 23, 17}, 6.0, 0.25);
  const Page written = writePage(folder.path() / "a&b.html", field, kSmall);
  const std::string page = readBytes(folder.path() / "a&b.html");
  EXPECT_EQ(written.html, page);
  EXPECT_EQ(written.grid, field.grid);
  EXPECT_EQ(makePage(field, kSmall, {.title = "a&b"}).html, page);
  EXPECT_NE(page.find("<title>a&amp;b</title>"), std::string::npos);
  EXPECT_NE(page.find("<th>Spacing</th><td>0.25</td>"), std::string::npos);
  const auto data = dataOf(page);
  EXPECT_EQ(data["dims"], nlohmann::json({19, 23, 17}));
  EXPECT_EQ(data["spacing"], 0.25);
  EXPECT_EQ(data["arrays"].size(), 1u);
  EXPECT_EQ(data["fields"].size(), 1u);
  EXPECT_TRUE(data["defects"].empty());
  const double step = data["arrays"][0]["step"];
  const std::vector<double> distances = numbersOf(page, 0);
  double largest = 0.0;
  for (size_t s = 0; s < distances.size(); ++s) {
    EXPECT_NEAR(distances[s], field.distance[s] / 0.25, 0.501 * step);
    largest = std::max(largest, std::abs(field.distance[s] / 0.25));
  }
  EXPECT_NEAR(step, largest / 32767.0, 1e-12);
}

TEST(Page, ShowsLargeFieldsOnACoarserGrid) {
  const Field field = sphereField({33, 20, 17}, 6.0, 0.25);
  const Page page = makePage(field, kSmall, {.title = "ball", .maxSize = 9});
  EXPECT_EQ(page.grid.dims, glm::ivec3(9, 6, 5));
  EXPECT_EQ(page.grid.spacing, 1.0);
  EXPECT_EQ(page.grid.origin, field.grid.origin);
  EXPECT_NE(page.html.find("<th>Samples</th><td>33 × 20 × 17</td>"), std::string::npos);
  EXPECT_NE(page.html.find("<th>In this page</th><td>9 × 6 × 5, spacing 1</td>"), std::string::npos);
  const double step = dataOf(page.html)["arrays"][0]["step"];
  const std::vector<double> distances = numbersOf(page.html, 0);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(distances[page.grid.index({i, j, k})],
                    field.distance[field.grid.index({4 * i, 4 * j, 4 * k})], 0.501 * step);
  EXPECT_EQ(makePage(field, kSmall, {.maxSize = 33}).grid.dims, field.grid.dims);
}

/// A field whose winding numbers and confidences are linear.
Field fieldWithNumbers() {
  Field field = sphereField({17, 9, 13}, 3.0, 0.25);
  for (Buffer<float>* numbers : {&field.winding, &field.confidence})
    numbers->resizeUninitialized(field.grid.sampleCount());
  for (int k = 0; k < 13; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 17; ++i) {
        field.winding[field.grid.index({i, j, k})] = float(0.5 * i - j);
        field.confidence[field.grid.index({i, j, k})] = float(k / 12.0);
      }
  return field;
}

TEST(Page, HoldsWindingNumbersAndConfidences) {
  const Field field = fieldWithNumbers();
  const std::string page = makePage(field, kSmall, {.array = FieldArray::Confidence}).html;
  const auto data = dataOf(page);
  ASSERT_EQ(data["arrays"].size(), 3u);
  EXPECT_EQ(data["colours"], "confidence");
  EXPECT_EQ(data["arrays"][1]["name"], "winding number");
  EXPECT_EQ(data["arrays"][1]["least"], -8.0);
  EXPECT_EQ(data["arrays"][1]["most"], 8.0);
  EXPECT_EQ(data["arrays"][1]["isOnSurface"], false);
  EXPECT_EQ(data["arrays"][2]["isOnSurface"], true);
  EXPECT_NE(page.find("<th>Winding numbers</th><td>-8 to 8</td>"), std::string::npos);
  EXPECT_NEAR(double(data["arrays"][1]["step"]), 8.0 / 2000.0, 1e-9);
  EXPECT_NEAR(double(data["arrays"][2]["step"]), 1.0 / 250.0, 1e-9);
  const std::vector<double> winding = numbersOf(page, 1), confidence = numbersOf(page, 2);
  for (size_t s = 0; s < winding.size(); ++s) {
    EXPECT_NEAR(winding[s], field.winding[s], 0.501 * 8.0 / 2000.0);
    EXPECT_NEAR(confidence[s], field.confidence[s], 0.501 / 250.0);
  }
}

TEST(Page, ShowsAllArraysOnACoarserGrid) {
  const Field field = fieldWithNumbers();
  const Page page = makePage(field, kSmall, {.maxSize = 8});
  const glm::ivec3 dims = page.grid.dims;
  EXPECT_EQ(dims, glm::ivec3(8, 5, 7));
  const std::vector<double> winding = numbersOf(page.html, 1), confidence = numbersOf(page.html, 2);
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i) {
        const glm::dvec3 s = glm::min(glm::dvec3(i, j, k) * 16.0 / 7.0, glm::dvec3(16.0, 8.0, 12.0));
        EXPECT_NEAR(winding[page.grid.index({i, j, k})], 0.5 * s.x - s.y, 5e-3);
        EXPECT_NEAR(confidence[page.grid.index({i, j, k})], s.z / 12.0, 3e-3);
      }
}

TEST(Page, NamesFieldsWithoutANameToo) {
  const Field field = sphereField({9, 9, 9}, 3.0, 0.5);
  const std::string page = makePage(field, kSmall, {.other = &field}).html;
  EXPECT_NE(page.find("<h1>Field and Other field</h1>"), std::string::npos);
  EXPECT_NE(page.find("<caption>A: Field</caption>"), std::string::npos);
  EXPECT_NE(page.find("<caption>B: Other field</caption>"), std::string::npos);
  EXPECT_EQ(dataOf(page)["fields"][1]["name"], "Other field");
  EXPECT_EQ(page.find("In this page"), std::string::npos);
}

TEST(Page, HasASecondFieldOnTheGridOfTheFirst) {
  const Field first = sphereField({17, 17, 17}, 5.0, 0.25), second = sphereField({31, 33, 35}, 12.0, 0.125);
  const std::string page =
      makePage(first, kSmall, {.title = "one", .other = &second, .otherTitle = "</script>"}).html;
  const auto data = dataOf(page);
  ASSERT_EQ(data["fields"].size(), 2u);
  EXPECT_EQ(data["fields"][0]["name"], "one");
  EXPECT_EQ(data["fields"][1]["name"], "</script>");
  EXPECT_NE(page.find("<th>Samples</th><td>31 × 33 × 35</td>"), std::string::npos);
  EXPECT_NEAR(double(data["fields"][0]["shape"]["radius"]), 5.0 * std::sqrt(3.0), 0.3);
  EXPECT_NEAR(double(data["fields"][1]["shape"]["radius"]), 6.0 * std::sqrt(3.0), 0.3);
  ASSERT_EQ(data["arrays"].size(), 2u);
  const double step = data["arrays"][0]["step"];
  EXPECT_EQ(data["arrays"][1]["step"], step);  // So that whole numbers can be subtracted.
  const std::vector<double> distances = numbersOf(page, 1);
  for (int k = 2; k < 15; k += 3)
    for (int i = 2; i < 15; ++i) {
      const glm::dvec3 p = first.grid.position({i, 8, k});
      EXPECT_NEAR(distances[first.grid.index({i, 8, k})] * 0.25, analytic::sphere(p, 1.5), 0.02);
    }
}

TEST(Page, ListsTheDefectsOfAMesh) {
  Mesh mesh;
  for (uint32_t t = 0; t < kMostDefectPlaces + 3; ++t) {
    const auto size = float(t + 1), x = float(1000 * t);
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0.0f, 0.0f}, {x + size, 0.0f, 0.0f}, {x, size, 0.0f}});
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const Field field = sphereField({9, 9, 9}, 3.0, 0.5);
  const auto kinds = dataOf(makePage(field, kSmall, {.mesh = mesh}).html)["defects"];
  ASSERT_EQ(kinds.size(), 1u);
  EXPECT_EQ(kinds[0]["name"], "Holes");
  EXPECT_EQ(kinds[0]["count"], 3 * (kMostDefectPlaces + 3));
  EXPECT_EQ(kinds[0]["places"], kMostDefectPlaces + 3);
  ASSERT_EQ(kinds[0]["listed"].size(), kMostDefectPlaces);
  const auto& first = kinds[0]["listed"][0];  // The last triangle; the grid begins at -2.
  EXPECT_NEAR(double(first["at"][0]), (1000.0 * (kMostDefectPlaces + 2) + 2.0) / 0.5, 200.0);
  EXPECT_NEAR(double(first["at"][2]), 4.0, 1e-9);
  EXPECT_EQ(first["count"], 3);
  EXPECT_GT(double(first["radius"]), 100.0);
  EXPECT_LT(double(first["radius"]), 206.0);
}

TEST(Page, RefusesWhatItCannotShow) {
  const TemporaryFolder folder;
  const Field field = sphereField({9, 9, 9}, 3.0, 1.0);
  EXPECT_EQ(codeOf([&] { writePage(folder.path() / "p.html", field, {}, {.maxSize = 1}); }),
            ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { writePage(folder.path() / "p.html", Field{}); }), ErrorCode::Usage);
  const Field none;
  EXPECT_EQ(codeOf([&] { makePage(field, {}, {.array = FieldArray::Winding}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, {.other = &field}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, {}, {.other = &none}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, {.width = 0}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, kSmall, {.mesh = Mesh{}}); }), ErrorCode::Input);
  Field odd = fieldWithNumbers();
  EXPECT_EQ(codeOf([&] { makePage(odd, {}, {.array = FieldArray::Winding, .other = &field}); }),
            ErrorCode::Usage);
  odd.triangle.resizeUninitialized(odd.grid.sampleCount());
  EXPECT_EQ(codeOf([&] { makePage(odd, {}, {.array = FieldArray::Triangle}); }), ErrorCode::Usage);
  odd.confidence[7] = NAN;
  EXPECT_EQ(codeOf([&] { makePage(odd); }), ErrorCode::Input);
  odd.confidence = Buffer<float>(5);
  EXPECT_EQ(codeOf([&] { makePage(odd); }), ErrorCode::Usage);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p.html"));
}

/// Expects an array of a page to hold these distances at its samples, but for `tolerance` and rounding.
template <class Distance>
void expectDistances(const Page& page, size_t array, double tolerance, Distance&& expected) {
  const std::vector<double> distances = numbersOf(page.html, array);
  const double rounding = 0.501 * double(dataOf(page.html)["arrays"][array]["step"]);
  const glm::ivec3 dims = page.grid.dims;
  ASSERT_EQ(distances.size(), page.grid.sampleCount());
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i) {
        const double found = distances[page.grid.index({i, j, k})] * page.grid.spacing;
        ASSERT_NEAR(found, expected(page.grid.position({i, j, k})), tolerance + rounding * page.grid.spacing)
            << i << ", " << j << ", " << k;
      }
}

/// A band of a ball about a centre, on a lattice around it.
Field ballBand(const glm::dvec3& centre, double radius, const Grid& grid, BandOptions options = {}) {
  return Surface(shapes::sphere(radius, 5, centre)).generateBand(grid, options);
}

TEST(PageOfBand, NeedsNoMemoryOfTheDenseField) {
  const Grid grid{.dims = {4096, 3000, 2500}, .origin = {-500.0, -400.0, -300.0}, .spacing = 0.5};
  const glm::dvec3 centre(120.0, 310.0, -40.0);
  const double radius = 50.0;
  const Field band = ballBand(centre, radius, grid, {.winding = true});
  const MachineOptions small{.device = "cpu", .memoryLimit = size_t(1) << 28};
  EXPECT_EQ(codeOf([&] { toDense(band, small); }), ErrorCode::Memory);
  const Page page = makePage(band, kSmall, {.maxSize = 65}, small);
  EXPECT_EQ(page.grid, pageGrid(grid, 65));
  EXPECT_EQ(page.grid.dims, glm::ivec3(65, 48, 41));
  expectDistances(page, 0, 0.05, [&](const glm::dvec3& p) { return analytic::sphere(p - centre, radius); });
  const auto data = dataOf(page.html);
  EXPECT_EQ(data["arrays"].size(), 1u);
  EXPECT_EQ(data["fields"][0]["shape"]["band"], 0.0);
  EXPECT_NE(page.html.find("<th>Samples</th><td>4096 × 3000 × 2500</td>"), std::string::npos);
  EXPECT_NE(page.html.find("<th>Narrow band</th><td>-1.5 to 1.5; distances"), std::string::npos);
}

TEST(PageOfBand, HasTheDistancesBeyondTheBand) {
  const TemporaryFolder folder;
  const glm::dvec3 centre(0.1, 0.0, -0.05);
  for (const BandOptions& options :
       {BandOptions{}, BandOptions{.outside = 1.5, .inside = INFINITY}, BandOptions{.outside = 4.0}})
    for (const int maxSize : {256, 17}) {
      const Field band = ballBand(centre, 0.7, analytic::cube(60, 2.0), options);
      const Page page = writePage(folder.path() / "ball.html", band, kSmall, {.maxSize = maxSize});
      EXPECT_EQ(page.grid, pageGrid(band.grid, maxSize));
      EXPECT_EQ(page.grid == band.grid, maxSize == 256);
      expectDistances(page, 0, 1e-3, [&](const glm::dvec3& p) { return analytic::sphere(p - centre, 0.7); });
      EXPECT_EQ(readBytes(folder.path() / "ball.html"), page.html);
      EXPECT_NE(page.html.find("<title>ball</title>"), std::string::npos);
    }
}

// Nothing closes a bar at the box that cuts it off, whatever the page's grid has beyond that box.
TEST(PageOfBand, GoesOnWhereTheBoxCutsTheSolid) {
  const Grid grid{.dims = {90, 71, 80}, .origin = {-1.0, -0.8, -0.9}, .spacing = 0.02};
  const Mesh bar = shapes::box({-9.0, -0.3, -0.4}, {9.0, 0.35, 0.37});
  const Field band = Surface(bar).generateBand(grid);
  const auto expected = [](const glm::dvec3& p) {
    const glm::dvec3 half(1e9, 0.325, 0.385);
    return analytic::box(p - glm::dvec3(0.0, 0.025, -0.015), half);
  };
  for (const int maxSize : {256, 24})
    expectDistances(makePage(band, kSmall, {.maxSize = maxSize}), 0, 1e-3, expected);
  // A lattice inside the bar has no surface, but is inside.
  const Grid within{.dims = glm::ivec3(16), .origin = glm::dvec3(-0.15), .spacing = 0.02};
  const std::vector<double> deep = numbersOf(makePage(Surface(bar).generateBand(within), kSmall).html, 0);
  EXPECT_TRUE(std::ranges::all_of(deep, [](double d) { return d < -15.0; }));
}

TEST(PageOfBand, HasTheSignsOfTheDenseFieldInACutBox) {
  const Mesh torus = shapes::torus(1.0, 0.35, 40, 20);
  const Box part{{-0.5, -0.2, -0.2}, {1.2, 1.1, 0.3}};
  const Field band = Surface(torus).generateBand(fitGrid(torus, {.voxelSize = 0.04, .box = part}));
  const Field dense = toDense(band);
  const std::vector<double> distances = numbersOf(makePage(band, kSmall).html, 0);
  ASSERT_EQ(distances.size(), dense.distance.size());
  size_t inside = 0, near = 0;
  for (size_t s = 0; s < distances.size(); ++s) {
    const double expected = dense.distance[s] / dense.grid.spacing;
    inside += expected < 0.0 ? 1 : 0;
    near += std::abs(expected) < 0.05 ? 1 : 0;
    if (std::abs(expected) >= 0.05) {
      ASSERT_EQ(distances[s] < 0.0, expected < 0.0) << s;
    }
  }
  EXPECT_GT(inside, distances.size() / 20);
  EXPECT_LT(near, distances.size() / 50);
}

TEST(PageOfBand, ComparesBandsAndFields) {
  const glm::dvec3 centre(0.0), shift(0.04, 0.0, 0.0);
  const auto first = [&](const glm::dvec3& p) { return analytic::sphere(p, 0.6); };
  const auto second = [&](const glm::dvec3& p) { return analytic::sphere(p - shift, 0.63); };
  const Field dense = analytic::sampled(analytic::cube(40, 2.0), first),
              otherDense = analytic::sampled(analytic::cube(48, 2.1), second);
  const Field band = ballBand(centre, 0.6, dense.grid),
              other = ballBand(shift, 0.63, otherDense.grid, {.outside = 2.0});
  const auto expectBoth = [&](const Page& page) {
    const auto data = dataOf(page.html);
    ASSERT_EQ(data["fields"].size(), 2u);
    EXPECT_EQ(data["arrays"].size(), 2u);
    EXPECT_EQ(page.grid, pageGrid(dense.grid, 20));
    EXPECT_NE(page.html.find("<td>48 × 48 × 48</td>"), std::string::npos);
    EXPECT_NE(page.html.find("sampled on the grid of A"), std::string::npos);
    expectDistances(page, 0, 0.02, first);
    expectDistances(page, 1, 0.02, second);
  };
  expectBoth(makePage(band, kSmall, {.maxSize = 20, .other = &other}));
  expectBoth(makePage(band, kSmall, {.maxSize = 20, .other = &otherDense}));
  expectBoth(makePage(dense, kSmall, {.maxSize = 20, .other = &other}));
}

TEST(PageOfBand, RefusesWhatItCannotShow) {
  const Field band = ballBand(glm::dvec3(0.0), 0.6, analytic::cube(40, 2.0), {.confidence = true});
  const auto codeOfPage = [](const Field& shown, const PageOptions& options = {},
                             const MachineOptions& machine = {}, const RenderOptions& view = kSmall) {
    return codeOf([&] { makePage(shown, view, options, machine); });
  };
  const Field field = toDense(band);
  EXPECT_EQ(codeOfPage(band, {.array = FieldArray::Confidence}), ErrorCode::Usage);
  EXPECT_EQ(codeOfPage(band, {.maxSize = 1}), ErrorCode::Usage);
  EXPECT_EQ(codeOfPage(band, {}, {}, {.other = &band}), ErrorCode::Usage);
  EXPECT_EQ(codeOfPage(band, {}, {.device = "cpu", .memoryLimit = 1000}), ErrorCode::Memory);
  EXPECT_EQ(codeOfPage(band, {}, {.progress = [](std::string_view, double) { return false; }}),
            ErrorCode::Cancelled);
  const Grid away{.dims = glm::ivec3(16), .origin = glm::dvec3(5.0), .spacing = 0.1};
  const Field empty = ballBand(glm::dvec3(0.0), 0.6, away);
  EXPECT_EQ(codeOfPage(empty), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, kSmall, {.other = &empty}); }), ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { makePage(field, kSmall, {.array = FieldArray::Confidence, .other = &band}); }),
            ErrorCode::Usage);
  Field odd = toSparse(field);
  odd.distance[100] = NAN;
  EXPECT_EQ(codeOfPage(odd), ErrorCode::Input);
  odd.distance = Buffer<float>(5);
  EXPECT_EQ(codeOfPage(odd), ErrorCode::Usage);
}

}  // namespace
}  // namespace raymap
