#include <gtest/gtest.h>
#include <raymap/page.h>
#include <zlib.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytic_fields.h"
#include "error_code.h"
#include "files.h"

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

/// Returns the distances that a page holds, in samples.
std::vector<double> distancesOf(const std::string& page, const glm::ivec3& dims, double step) {
  const std::vector<uint8_t> packed = decoded(scriptOf(page, "samples"));
  const size_t count = size_t(dims.x) * size_t(dims.y) * size_t(dims.z);
  std::vector<uint8_t> bytes(2 * count);
  uLongf size = uLongf(bytes.size());
  EXPECT_EQ(uncompress(bytes.data(), &size, packed.data(), uLong(packed.size())), Z_OK);
  EXPECT_EQ(size, bytes.size());
  const Grid grid{.dims = dims};
  std::vector<int16_t> values(count);
  std::vector<double> distances(count);
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
        distances[s] = values[s] * step;
      }
  return distances;
}

Field sphereField(const glm::ivec3& dims, double radius, double spacing) {
  const Grid grid{.dims = dims, .origin = -0.5 * spacing * glm::dvec3(dims - 1), .spacing = spacing};
  return analytic::sampled(grid, [&](const glm::dvec3& p) { return analytic::sphere(p, radius * spacing); });
}

TEST(Page, HoldsTheDistances) {
  const TemporaryFolder folder;
  const Field field = sphereField({19, 23, 17}, 6.0, 0.25);
  const PageContent content = writePage(folder.path() / "a&b.html", field, {.width = 32, .height = 24});
  const std::string page = readBytes(folder.path() / "a&b.html");
  EXPECT_EQ(content.bytes, page.size());
  EXPECT_EQ(content.grid.dims, field.grid.dims);
  EXPECT_NE(page.find("<title>a&amp;b</title>"), std::string::npos);
  EXPECT_NE(page.find("<th>Spacing</th><td>0.25</td>"), std::string::npos);
  const auto data = nlohmann::json::parse(scriptOf(page, "page"));
  EXPECT_EQ(data["dims"], nlohmann::json({19, 23, 17}));
  EXPECT_EQ(data["spacing"], 0.25);
  const double step = data["step"];
  const std::vector<double> distances = distancesOf(page, field.grid.dims, step);
  double largest = 0.0;
  for (size_t s = 0; s < distances.size(); ++s) {
    EXPECT_NEAR(distances[s], field.distance[s] / 0.25, 0.501 * step);
    largest = std::max(largest, std::abs(field.distance[s] / 0.25));
  }
  EXPECT_NEAR(step, largest / 32767.0, 1e-12);
}

TEST(Page, ShowsLargeFieldsOnACoarserGrid) {
  const TemporaryFolder folder;
  const Field field = sphereField({33, 20, 17}, 6.0, 0.25);
  const PageContent content = writePage(folder.path() / "p.html", field, {.width = 32, .height = 24},
                                        {.title = "ball", .maxSize = 9});
  EXPECT_EQ(content.grid.dims, glm::ivec3(9, 6, 5));
  EXPECT_EQ(content.grid.spacing, 1.0);
  EXPECT_EQ(content.grid.origin, field.grid.origin);
  const std::string page = readBytes(folder.path() / "p.html");
  EXPECT_NE(page.find("<th>Samples</th><td>33 × 20 × 17</td>"), std::string::npos);
  EXPECT_NE(page.find("<th>In this page</th><td>9 × 6 × 5</td>"), std::string::npos);
  const double step = nlohmann::json::parse(scriptOf(page, "page"))["step"];
  const std::vector<double> distances = distancesOf(page, content.grid.dims, step);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 9; ++i)
        EXPECT_NEAR(distances[content.grid.index({i, j, k})],
                    field.distance[field.grid.index({4 * i, 4 * j, 4 * k})], 0.501 * step);
  const PageContent same =
      writePage(folder.path() / "q.html", field, {.width = 32, .height = 24}, {.maxSize = 33});
  EXPECT_EQ(same.grid.dims, field.grid.dims);
}

TEST(Page, RefusesWhatItCannotShow) {
  const TemporaryFolder folder;
  const Field field = sphereField({9, 9, 9}, 3.0, 1.0);
  EXPECT_EQ(codeOf([&] { writePage(folder.path() / "p.html", field, {}, {.maxSize = 1}); }),
            ErrorCode::Usage);
  EXPECT_EQ(codeOf([&] { writePage(folder.path() / "p.html", Field{}); }), ErrorCode::Usage);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "p.html"));
}

}  // namespace
}  // namespace raymap
