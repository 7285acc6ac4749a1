// A page that shows a field in a browser. Its parts lie in render/page; the shader is that of the GPU.

#include <raymap/atomic_file.h>
#include <raymap/error.h>
#include <raymap/page.h>
#include <raymap/render.h>
#include <raymap/sample.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

#include "base/text.h"
#include "page_text.h"
#include "render/encode_png.h"
#include "scene/scene.h"

namespace raymap {

namespace {

using Json = nlohmann::ordered_json;

Json toJson(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

template <size_t N>
Json toJson(const Colour (&colours)[N]) {
  Json all = Json::array();
  for (const Colour& colour : colours) all.push_back(toJson(colour));
  return all;
}

std::string base64(std::span<const uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(bytes.size() - i, 3);
    uint32_t three = 0;
    for (size_t b = 0; b < 3; ++b) three = three << 8 | (b < count ? bytes[i + b] : 0u);
    for (size_t d = 0; d < 4; ++d) text += d <= count ? kDigits[three >> (18 - 6 * d) & 63u] : '=';
  }
  return text;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '<')
      safe += "&lt;";
    else if (c == '&')
      safe += "&amp;";
    else if (c == '"')
      safe += "&quot;";
    else
      safe += c;
  }
  return safe;
}

/// Returns the field on the finest grid over the same box that has at most `most` samples along a side.
Field coarser(const Field& field, int most, const MachineOptions& machine) {
  const glm::ivec3 last = field.grid.dims - 1;
  const int longest = std::max({last.x, last.y, last.z});
  const glm::dvec3 sides = glm::ceil(glm::dvec3(last) * double(most - 1) / double(longest));
  Field coarse{.clampDistance = field.clampDistance, .surfaceBounds = field.surfaceBounds};
  coarse.grid = {.dims = glm::ivec3(sides) + 1,
                 .origin = field.grid.origin,
                 .spacing = field.grid.spacing * longest / (most - 1)};
  coarse.distance = Buffer<float>(coarse.grid.sampleCount());
  std::vector<glm::dvec3> sheet;
  Samples samples;
  for (int k = 0; k < coarse.grid.dims.z; ++k) {
    sheet.clear();
    for (int j = 0; j < coarse.grid.dims.y; ++j)
      for (int i = 0; i < coarse.grid.dims.x; ++i) sheet.push_back(coarse.grid.position({i, j, k}));
    sample(field, sheet, {}, samples, machine);
    std::ranges::copy(samples.distance, coarse.distance.data() + coarse.grid.index({0, 0, k}));
  }
  return coarse;
}

/// Distances as multiples of a step, in samples. Each is stored as its difference from what the seven
/// neighbours before it suggest (L. Ibarria et al., "Out-of-core compression and decompression of large
/// n-dimensional scalar fields", 2003): nearly zero where the field is smooth. Low bytes come before high
/// ones.
std::vector<uint8_t> differences(const Field& field, double step) {
  const glm::ivec3 dims = field.grid.dims;
  const size_t count = field.grid.sampleCount();
  std::vector<int16_t> values(count);
  for (size_t i = 0; i < count; ++i)
    values[i] = static_cast<int16_t>(std::lround(field.distance[i] / (step * field.grid.spacing)));
  std::vector<uint8_t> bytes(2 * count);
  for (int k = 0; k < dims.z; ++k)
    for (int j = 0; j < dims.y; ++j)
      for (int i = 0; i < dims.x; ++i) {
        const auto at = [&](int dx, int dy, int dz) {
          return i < dx || j < dy || k < dz ? 0 : int(values[field.grid.index({i - dx, j - dy, k - dz})]);
        };
        const int suggested =
            at(1, 0, 0) + at(0, 1, 0) + at(0, 0, 1) - at(1, 1, 0) - at(1, 0, 1) - at(0, 1, 1) + at(1, 1, 1);
        const size_t sample = field.grid.index({i, j, k});
        const auto difference = static_cast<uint16_t>(values[sample] - suggested);
        bytes[sample] = static_cast<uint8_t>(difference & 255u);
        bytes[count + sample] = static_cast<uint8_t>(difference >> 8);
      }
  return bytes;
}

std::vector<uint8_t> deflated(std::span<const uint8_t> bytes) {
  uLongf size = compressBound(uLong(bytes.size()));
  std::vector<uint8_t> packed(size);
  if (compress2(packed.data(), &size, bytes.data(), uLong(bytes.size()), Z_BEST_COMPRESSION) != Z_OK)
    throw Error(ErrorCode::Memory, "there is not enough memory to compress a field for a page");
  packed.resize(size);
  return packed;
}

Json describeScene(const Scene& scene) {
  const RenderSceneData data = describe(scene);
  return {{"eye", toJson(data.eye)},
          {"forward", toJson(data.forward)},
          {"floorNormal", toJson(data.floorNormal)},
          {"floorHeight", data.floorHeight},
          {"pixelAngle", data.pixelAngle},
          {"lineStep", data.lineStep},
          {"depth", data.depth},
          {"sun", toJson(data.sun)},
          {"sky", toJson(data.sky)},
          {"bounce", toJson(data.bounce)},
          {"clay", toJson(data.clay)},
          {"top", toJson(data.top)},
          {"bottom", toJson(data.bottom)},
          {"inside", toJson(kInside)},
          {"contour", toJson(data.contour)},
          {"sliceRange", data.sliceRange},
          {"outside", toJson(kOutside)}};
}

Json describeShape(const RenderShape& shape) {
  return {{"centre", toJson(shape.centre)},
          {"radius", shape.radius},
          {"cutNormal", toJson(shape.cutNormal)},
          {"cutOffset", shape.cutOffset},
          {"level", shape.level},
          {"wall", shape.wall},
          {"band", shape.band},
          {"nx", shape.nx},
          {"ny", shape.ny},
          {"nz", shape.nz}};
}

std::string figures(const Field& field, const Grid& shown) {
  const auto dims = [](const Grid& grid) {
    return std::to_string(grid.dims.x) + " × " + std::to_string(grid.dims.y) + " × " +
           std::to_string(grid.dims.z);
  };
  const auto vector = [](const glm::dvec3& v) {
    return numberText(v.x) + ", " + numberText(v.y) + ", " + numberText(v.z);
  };
  const auto [least, most] = std::ranges::minmax(field.distance);
  const auto inside = std::ranges::count_if(field.distance, [](float d) { return d < 0.0f; });
  std::string rows;
  const auto add = [&](std::string_view name, const std::string& value) {
    rows.append("<tr><th>").append(name).append("</th><td>").append(value).append("</td></tr>");
  };
  add("Samples", dims(field.grid));
  if (shown.dims != field.grid.dims) add("In this page", dims(shown));
  add("Spacing", numberText(field.grid.spacing));
  add("Origin", vector(field.grid.origin));
  add("Distances", numberText(least) + " to " + numberText(most));
  add("Inside", numberText(std::round(1e4 * double(inside) / double(field.distance.size())) / 100.0) + " %");
  if (field.clampDistance > 0.0) add("Clamped to", "± " + numberText(field.clampDistance));
  return "<table>" + rows + "</table>";
}

/// Puts texts into the template where it names them between @.
std::string filled(std::string_view text,
                   std::initializer_list<std::pair<std::string_view, std::string>> values) {
  std::string page;
  while (!text.empty()) {
    const size_t at = text.find('@');
    page += text.substr(0, at);
    if (at == std::string_view::npos) break;
    const size_t end = text.find('@', at + 1);
    const std::string_view name = end == std::string_view::npos ? "" : text.substr(at + 1, end - at - 1);
    const auto found = std::ranges::find(values, name, &std::pair<std::string_view, std::string>::first);
    page += found != values.end() ? found->second : "@";
    text.remove_prefix(found != values.end() ? end + 1 : at + 1);
  }
  return page;
}

}  // namespace

PageContent writePage(const std::filesystem::path& path, const Field& field, const RenderOptions& view,
                      const PageOptions& options, const MachineOptions& machine) {
  validateField(field);
  if (options.maxSize < 2)
    throw Error(ErrorCode::Usage,
                "a page needs at least 2 samples along a side, not " + std::to_string(options.maxSize));
  const Picture picture = renderField(field, view, machine);  // Refuses samples that are not finite.
  const bool isLarge = std::max({field.grid.dims.x, field.grid.dims.y, field.grid.dims.z}) > options.maxSize;
  const Field coarse = isLarge ? coarser(field, options.maxSize, machine) : Field{};
  const Field& shown = isLarge ? coarse : field;
  const Scene scene(shown, view);
  double largest = 0.0;
  for (const float d : shown.distance) largest = std::max(largest, std::abs(double(d)) / shown.grid.spacing);
  const double step = std::max(largest, 1e-9) / 32767.0;
  const Json data{{"dims", {shown.grid.dims.x, shown.grid.dims.y, shown.grid.dims.z}},
                  {"origin", toJson(shown.grid.origin)},
                  {"spacing", shown.grid.spacing},
                  {"step", step},
                  {"height", view.height},
                  {"shape", describeShape(describe(scene.shape))},
                  {"scene", describeScene(scene)},
                  {"light", toJson(kLightOfCamera)},
                  {"dark", {{"top", toJson(srgb(38, 41, 46))}, {"bottom", toJson(srgb(22, 24, 28))}}}};
  const std::string title = escaped(options.title.empty() ? path.stem().string() : options.title);
  const std::string page = filled(kPageText, {{"title", title},
                                              {"picture", base64(encodePng(path, picture))},
                                              {"figures", figures(field, shown.grid)},
                                              {"data", data.dump()},
                                              {"samples", base64(deflated(differences(shown, step)))}});
  writeAtomically(path, [&](std::ostream& out) { out.write(page.data(), std::streamsize(page.size())); });
  return {shown.grid, page.size()};
}

}  // namespace raymap
