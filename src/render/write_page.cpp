// A page that shows a field in a browser. Its parts lie in render/page; the shader is that of the GPU.

#include <raymap/atomic_file.h>
#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/names.h>
#include <raymap/page.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <span>
#include <string_view>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "base/text.h"
#include "field/field_sampler.h"
#include "page_text.h"
#include "picture/colouring.h"
#include "picture/drawn_scene.h"
#include "render/encode_png.h"
#include "render/pack_samples.h"
#include "render/render_scene.h"
#include "render/resample.h"

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

Json describeScene(const DrawnScene& scene) {
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
          {"contour", toJson(data.contour)}};
}

Json describeShape(const RenderShape& shape) {
  return {{"centre", toJson(shape.centre)},
          {"radius", shape.radius},
          {"cutNormal", toJson(shape.cutNormal)},
          {"cutOffset", shape.cutOffset},
          {"level", shape.level},
          {"wall", shape.wall},
          {"band", shape.band},
          {"innerBand", shape.innerBand},
          {"nx", shape.nx},
          {"ny", shape.ny},
          {"nz", shape.nz}};
}

/// Arrays as a page holds them. Of an array with numbers v of unit u, the browser gets v / u.
class PageArrays {
 public:
  explicit PageArrays(const Grid& grid) : grid_(grid) {}

  /// Adds an array in steps of its unit, with the colours of some values. `lineStep` is the distance of its
  /// lines, `isOnSurface` tells whether it colours the surface too.
  void add(const char* name, std::span<const float> numbers, double unit, double step, double lineStep,
           Json stops, bool isOnSurface = false) {
    const std::string text = packSamples(grid_, numbers, step * unit);
    const auto [least, most] = std::ranges::minmax(numbers);
    list_.push_back({{"name", name},
                     {"unit", unit},
                     {"step", step},
                     {"lineStep", lineStep},
                     {"least", least / unit},
                     {"most", most / unit},
                     {"isOnSurface", isOnSurface},
                     {"stops", std::move(stops)}});
    scripts_ += "<script type=\"text/plain\" id=\"array" + std::to_string(list_.size() - 1) + "\">" + text +
                "</script>\n";
  }

  const Json& list() const { return list_; }
  const std::string& scripts() const { return scripts_; }

 private:
  const Grid& grid_;
  Json list_ = Json::array();
  std::string scripts_;
};

/// Returns the colours of values, each as [value, red, green, blue]. Between them, colours are mixed.
template <class ColourOf>
Json stopsOf(std::initializer_list<double> values, ColourOf&& colourOf) {
  Json stops = Json::array();
  for (const double value : values) {
    const Colour colour = colourOf(value);
    stops.push_back({value, colour.x, colour.y, colour.z});
  }
  return stops;
}

/// Returns the colours of distances, in samples: to `depth` inside and to `range` outside.
Json distanceStops(double depth, double range) {
  Json stops =
      stopsOf({-depth, -0.5 * depth, -1e-9 * depth}, [&](double d) { return distanceColour(d, depth); });
  for (Json& stop : stopsOf({0.0, 0.5 * range, range}, [&](double d) { return distanceColour(d, range); }))
    stops.push_back(std::move(stop));
  return stops;
}

Json toJson(const std::vector<Colouring::Stop>& stops) {
  Json all = Json::array();
  for (const auto& [number, colour] : stops) all.push_back({number, colour.x, colour.y, colour.z});
  return all;
}

/// Returns the largest number in a unit; never 0.
double largestOf(std::span<const float> numbers, double unit = 1.0) {
  double largest = 0.0;
  for (const float number : numbers) largest = std::max(largest, std::abs(double(number)));
  return std::max(largest / unit, 1e-9);
}

void addNumbers(const Field& field, PageArrays& arrays) {
  const auto add = [&](const char* title, FieldArray array, double step) {
    const Colouring colouring = colouringOf(array);
    arrays.add(title, numbersOf(field, array), 1.0, step, colouring.lineStep, toJson(colouring.stops),
               colouring.isOnSurface);
  };
  if (!field.winding.empty()) add("winding number", FieldArray::Winding, largestOf(field.winding) / 2000.0);
  if (!field.confidence.empty())
    add("confidence", FieldArray::Confidence, std::max(largestOf(field.confidence), 1.0) / 250.0);
}

Json describeDefects(const MeshView& mesh, const Grid& grid, const MachineOptions& machine) {
  Json kinds = Json::array();
  for (const DefectList& list : findDefectPlaces(mesh, machine)) {
    Json listed = Json::array();
    for (const DefectPlace& place :
         std::span(list.places).first(std::min(list.places.size(), kMostDefectPlaces)))
      listed.push_back({{"at", toJson((place.centre - grid.origin) / grid.spacing)},
                        {"radius", 0.5 * place.diameter / grid.spacing},
                        {"count", place.count}});
    kinds.push_back({{"name", list.name},
                     {"unit", list.edges.empty() ? "face" : "edge"},
                     {"count", list.count()},
                     {"isComplete", list.complete},
                     {"places", list.places.size()},
                     {"listed", std::move(listed)}});
  }
  return kinds;
}

std::string dimsText(const Grid& grid) {
  return std::to_string(grid.dims.x) + " × " + std::to_string(grid.dims.y) + " × " +
         std::to_string(grid.dims.z);
}

/// A field or a narrow band, and its samples on the grid of the page.
struct ShownField {
  const Field& shown;                     ///< Its samples on the grid of the page.
  const Field& measured;                  ///< The field as given; of a band, those samples.
  const Grid& grid;                       ///< Grid of all its samples.
  const std::optional<NarrowBand>& band;  ///< Leaves of the field as given, if it is a narrow band.
};

/// Returns a field as it is, or makes `made` of it, which the result keeps a reference to.
ShownField shownOn(const Grid& grid, const Field& field, const MachineOptions& machine, Field& made) {
  if (!field.narrow && field.grid == grid) return {field, field, field.grid, field.narrow};
  made = resampled(field, grid, machine);
  return {made, field.narrow ? made : field, field.grid, field.narrow};
}

std::string figure(double value) {
  return numberText(value, 4);
}

/// Returns a coordinate in steps of a thousandth of the box's size, or finer.
std::string coordinate(double value, const Grid& grid) {
  const double extent = grid.spacing * std::max({grid.dims.x, grid.dims.y, grid.dims.z});
  const double step = std::pow(10.0, std::floor(std::log10(extent)) - 3.0);
  return numberText(std::round(value / step) * step + 0.0, 12);  // No -0.
}

/// Returns a table about a field. `shown` says what the page has of it, if that is not all.
std::string figures(const std::string& title, const ShownField& of, const std::string& shown) {
  const Field& field = of.measured;
  const auto vector = [&of](const glm::dvec3& v) {
    return coordinate(v.x, of.grid) + ", " + coordinate(v.y, of.grid) + ", " + coordinate(v.z, of.grid);
  };
  std::string rows;
  const auto add = [&](std::string_view name, const std::string& value) {
    rows.append("<tr><th>").append(name).append("</th><td>").append(value).append("</td></tr>");
  };
  const auto addRange = [&](std::string_view name, std::span<const float> numbers) {
    if (numbers.empty()) return;
    const auto [least, most] = std::ranges::minmax(numbers);
    add(name, figure(least) + " to " + figure(most));
  };
  const auto inside = std::ranges::count_if(field.distance, [](float d) { return d < 0.0f; });
  add("Samples", dimsText(of.grid));
  if (!shown.empty()) add("In this page", shown);
  add("Spacing", figure(of.grid.spacing));
  add("Origin", vector(of.grid.origin));
  if (of.band)
    add("Narrow band",
        figure(-of.band->inside) + " to " + figure(of.band->outside) + "; distances to its surface");
  addRange("Distances", field.distance);
  add("Inside", figure(std::round(1e4 * double(inside) / double(field.distance.size())) / 100.0) + " %");
  if (field.clampDistance > 0.0) add("Clamped to", "± " + figure(field.clampDistance));
  addRange("Winding numbers", field.winding);
  addRange("Confidences", field.confidence);
  return "<table>" + (title.empty() ? "" : "<caption>" + escaped(title) + "</caption>") + rows + "</table>";
}

/// Returns data as a text that ends no script. Names of files need not be UTF-8.
std::string inScript(const Json& data) {
  std::string text;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace))
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
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

/// Throws `Error(Usage)` unless a narrow band has a surface, and its distances are to be shown.
void checkBand(const Field& band, FieldArray first) {
  if (first != FieldArray::Distance)
    throw Error(ErrorCode::Usage, "a page of a narrow band shows distances only, not the array '" +
                                      std::string(name(first)) + "'; draw it as a picture");
  const auto isInside = [](float distance) { return distance < 0.0f; };
  require(!band.narrow->tiles.empty() || std::ranges::any_of(band.distance, isInside),
          "no sample of the narrow band is inside, so a page has no surface to show; draw it as a picture");
}

void checkField(const Field& field, FieldArray first) {
  validateArray(field, FieldArray::Distance);
  if (field.narrow) return checkBand(field, first);
  for (const FieldArray array :
       {FieldArray::Winding, FieldArray::Confidence})  // Distances are checked when drawn.
    if (!numbersOf(field, array).empty()) checkNumbers(field, array);
  validateArray(field, first);
}

void checkOptions(const RenderOptions& view, const PageOptions& options) {
  require(!view.other,
          "a page takes its second field from the options of the page; leave it out of those of the view");
  checkPictureSize(view.width, view.height);
  if (const Field* other = options.other) {
    validateArray(*other, FieldArray::Distance);
    if (other->narrow) checkBand(*other, FieldArray::Distance);
  }
  const bool isTwo = options.other != nullptr;
  if (options.array == FieldArray::Triangle || (isTwo && options.array != FieldArray::Distance))
    throw Error(ErrorCode::Usage, "a page has no colours of the array '" + std::string(name(options.array)) +
                                      (isTwo ? "' of two fields" : "'"));
}

/// Returns the name in the colours' list that the page begins with.
const char* firstColours(FieldArray array) {
  return array == FieldArray::Winding      ? "winding number"
         : array == FieldArray::Confidence ? "confidence"
                                           : "distance";
}

std::string figuresOfAll(const ShownField& first, const ShownField* second, const PageOptions& options) {
  const Grid& grid = first.shown.grid;
  const std::string coarser = first.grid == grid ? "" : dimsText(grid) + ", spacing " + figure(grid.spacing);
  if (!second) return figures("", first, coarser);
  return figures("A: " + options.title, first, coarser) +
         figures("B: " + options.otherTitle, *second, second->grid == grid ? "" : "sampled on the grid of A");
}

/// Puts a page together of fields on its grid. `second` is null if there is none.
Page assemble(const ShownField& first, const ShownField* second, const RenderOptions& view,
              const PageOptions& options, const MachineOptions& machine) {
  const Field& shown = first.shown;
  const Field* other = second ? &second->shown : nullptr;
  const Grid& grid = shown.grid;
  const DrawnScene scene(shown, view);
  double largest = largestOf(shown.distance, grid.spacing);
  if (other) largest = std::max(largest, largestOf(other->distance, grid.spacing));
  const Json stops = distanceStops(std::min(scene.shape.depth(), kFarthestRay), largest);
  PageArrays arrays(grid);
  Json fields{{{"name", options.title}, {"shape", describeShape(describe(scene.shape))}}};
  const auto addDistances = [&](const Field& each) {
    arrays.add("distance", each.distance, grid.spacing, largest / 32767.0, scene.lineStep, stops);
  };
  addDistances(shown);
  if (other) {
    addDistances(*other);
    fields.push_back({{"name", options.otherTitle}, {"shape", describeShape(describe(Shape(*other, view)))}});
  } else {
    addNumbers(shown, arrays);
  }
  const Json data{{"dims", {grid.dims.x, grid.dims.y, grid.dims.z}},
                  {"origin", toJson(grid.origin)},
                  {"spacing", grid.spacing},
                  {"height", view.height},
                  {"fields", std::move(fields)},
                  {"arrays", arrays.list()},
                  {"difference", toJson(differenceColouring(1.0).stops)},
                  {"colours", firstColours(options.array)},
                  {"defects", options.mesh ? describeDefects(*options.mesh, grid, machine) : Json::array()},
                  {"scene", describeScene(scene)},
                  {"light", toJson(kLightOfCamera)},
                  {"dark", {{"top", toJson(srgb(38, 41, 46))}, {"bottom", toJson(srgb(22, 24, 28))}}}};
  const std::string picture = base64(encodePng("page", renderScene(scene, view, machine)));
  return {filled(kPageText,
                 {{"title", escaped(options.title) + (other ? " and " + escaped(options.otherTitle) : "")},
                  {"picture", picture},
                  {"figures", figuresOfAll(first, second, options)},
                  {"data", inScript(data)},
                  {"samples", arrays.scripts()}}),
          grid};
}

}  // namespace

Grid pageGrid(const Grid& grid, int maxSize) {
  validateGrid(grid);
  if (maxSize < 2)
    throw Error(ErrorCode::Usage,
                "a page needs at least 2 samples along a side, not " + std::to_string(maxSize));
  const glm::ivec3 last = grid.dims - 1;
  const int longest = std::max({last.x, last.y, last.z}), most = maxSize - 1;
  if (longest <= most) return grid;
  const glm::dvec3 sides = glm::ceil(glm::dvec3(last) * double(most) / double(longest));
  return {.dims = glm::ivec3(sides) + 1, .origin = grid.origin, .spacing = grid.spacing * longest / most};
}

Page makePage(const Field& field, const RenderOptions& view, const PageOptions& options,
              const MachineOptions& machine) {
  checkOptions(view, options);
  checkField(field, options.array);
  const Grid grid = pageGrid(field.grid, options.maxSize);
  PageOptions titled = options;
  if (titled.title.empty()) titled.title = "Field";
  if (titled.otherTitle.empty()) titled.otherTitle = "Other field";
  for (std::string* text : {&titled.title, &titled.otherTitle}) *text = printableText(*text);
  Page page;
  withThreads(machine.threads, [&] {
    Field made, other;
    const ShownField first = shownOn(grid, field, machine, made);
    std::optional<ShownField> second;
    if (options.other) second.emplace(shownOn(grid, *options.other, machine, other));
    page = assemble(first, second ? &*second : nullptr, view, titled, machine);
  });
  return page;
}

Page writePage(const std::filesystem::path& path, const Field& field, const RenderOptions& view,
               const PageOptions& options, const MachineOptions& machine) {
  PageOptions titled = options;
  if (titled.title.empty()) titled.title = path.stem().string();
  Page page = makePage(field, view, titled, machine);
  writeAtomically(path,
                  [&](std::ostream& out) { out.write(page.html.data(), std::streamsize(page.html.size())); });
  return page;
}

}  // namespace raymap
