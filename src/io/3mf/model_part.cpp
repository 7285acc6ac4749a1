#include "io/3mf/model_part.h"

#include <raymap/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "base/text.h"
#include "io/3mf/units.h"
#include "io/3mf/xml_parser.h"

namespace raymap {

namespace {

constexpr std::string_view kProduction = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
constexpr std::string_view kMaterial = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";
/// Extensions that a file may require: the others change shapes, or hide them.
constexpr std::array<std::string_view, 3> kKnownExtensions{
    kProduction, kMaterial, "http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07"};

enum class Element : uint8_t {
  Root,
  Model,
  Resources,
  Object,
  Mesh,
  Vertices,
  Vertex,
  Triangles,
  Triangle,
  Components,
  Component,
  Build,
  Item,
  Materials,
  Material,
  Colours,
  Colour,
  OtherGroup
};

/// An element with geometry: its name, and the element that it stands in.
struct Rule {
  Element parent;
  std::string_view name;
  Element element;
  std::string_view space = {};  ///< Its namespace; empty: that of the root.
};
constexpr std::array kRules{Rule{Element::Vertices, "vertex", Element::Vertex},
                            Rule{Element::Triangles, "triangle", Element::Triangle},
                            Rule{Element::Root, "model", Element::Model},
                            Rule{Element::Model, "resources", Element::Resources},
                            Rule{Element::Model, "build", Element::Build},
                            Rule{Element::Resources, "object", Element::Object},
                            Rule{Element::Object, "mesh", Element::Mesh},
                            Rule{Element::Object, "components", Element::Components},
                            Rule{Element::Mesh, "vertices", Element::Vertices},
                            Rule{Element::Mesh, "triangles", Element::Triangles},
                            Rule{Element::Components, "component", Element::Component},
                            Rule{Element::Build, "item", Element::Item},
                            Rule{Element::Resources, "basematerials", Element::Materials},
                            Rule{Element::Materials, "base", Element::Material},
                            Rule{Element::Resources, "colorgroup", Element::Colours, kMaterial},
                            Rule{Element::Colours, "color", Element::Colour, kMaterial},
                            Rule{Element::Resources, "texture2dgroup", Element::OtherGroup, kMaterial},
                            Rule{Element::Resources, "compositematerials", Element::OtherGroup, kMaterial},
                            Rule{Element::Resources, "multiproperties", Element::OtherGroup, kMaterial}};

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n";
  const size_t begin = text.find_first_not_of(kBlank);
  if (begin == text.npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlank) + 1 - begin);
}

template <class T>
std::optional<T> parsed(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> words(std::string_view text) {
  std::vector<std::string_view> found;
  for (text = trimmed(text); !text.empty(); text = trimmed(text)) {
    const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
    found.push_back(word);
    text.remove_prefix(word.size());
  }
  return found;
}

class Reader : public XmlHandler {
 public:
  Reader(ZipParts& parts, const std::string& name) : parts_(parts), name_(name) {}

  ModelPart3mf finish() { return std::move(model_); }

  void start(const XmlName& name, const XmlAttributes& attributes) override {
    if (stack_.back() == Element::Root) {
      if (name.local != "model") fail("its root is " + excerpt(name.local) + ", not 'model'");
      space_ = name.space;
    }
    const auto rule = std::ranges::find_if(
        kRules, [&](const Rule& each) { return each.parent == stack_.back() && each.name == name.local; });
    if (skipped_ > 0 || rule == kRules.end() || name.space != (rule->space.empty() ? space_ : rule->space)) {
      ++skipped_;
      return;
    }
    stack_.push_back(rule->element);
    read(rule->element, attributes);
  }

  void end() override {
    if (skipped_ > 0)
      --skipped_;
    else
      stack_.pop_back();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    parts_.file().fail(name_ + ", line " + std::to_string(line()) + ": " + what);
  }

  void read(Element element, const XmlAttributes& attributes) {
    switch (element) {
      case Element::Vertex:
        return readVertex(attributes);
      case Element::Triangle:
        return readTriangle(attributes);
      case Element::Model:
        return readModel(attributes);
      case Element::Object:
        return readObject(attributes);
      case Element::Component:
        object_->components.push_back(placement("component", object_->components.size(), attributes));
        return;
      case Element::Item:
        return readItem(attributes);
      case Element::Materials:
        return startGroup(PropertyGroup3mf::Kind::Materials, attributes);
      case Element::Colours:
        return startGroup(PropertyGroup3mf::Kind::Colours, attributes);
      case Element::OtherGroup:
        return startGroup(PropertyGroup3mf::Kind::Other, attributes);
      case Element::Material:
        return readColour("displaycolor", attributes);
      case Element::Colour:
        return readColour("color", attributes);
      default:
        return;
    }
  }

  void readModel(const XmlAttributes& attributes) {
    if (const auto unit = attributes.find("unit")) model_.unit = trimmed(*unit);
    const std::optional<LengthUnit> unit = unitOf3mf(model_.unit);
    if (!unit)
      fail("its unit is " + excerpt(model_.unit) +
           "; 3MF knows micron, millimeter, centimeter, inch, foot and meter");
    scale_ = millimetres(*unit);
    for (const std::string_view prefix : words(attributes.find("requiredextensions").value_or(""))) {
      const auto space = namespaces.find(std::string(prefix));
      if (space == namespaces.end())
        fail("it requires the extension " + excerpt(prefix) + ", which it does not declare");
      if (std::ranges::find(kKnownExtensions, space->second) == kKnownExtensions.end())
        throw Error(ErrorCode::Unsupported, parts_.file().path.string() + ": " + name_ +
                                                ": it requires the extension " +
                                                shortText(space->second, kLongestName) +
                                                ", which raymap does not read; export it as plain triangles");
    }
  }

  void readObject(const XmlAttributes& attributes) {
    id_ = whole("object", attributes, "id");
    const auto [place, isNew] = model_.objects.try_emplace(id_);
    if (!isNew) fail("there are two objects with the id " + std::to_string(id_));
    object_ = &place->second;
    if (const auto type = attributes.find("type")) object_->type = trimmed(*type);
    object_->name = trimmed(attributes.find("name").value_or(""));
    notePaint(attributes);
    object_->property = property(attributes, "pindex", {});
    constexpr std::array<std::string_view, 5> kTypes{"model", "surface", "support", "solidsupport", "other"};
    if (std::ranges::find(kTypes, object_->type) == kTypes.end())
      fail("the type of object " + std::to_string(id_) + " is " + excerpt(object_->type) +
           "; 3MF knows model, surface, support, solidsupport and other");
  }

  /// Notes paints of slicers.
  void notePaint(const XmlAttributes& attributes) {
    if (model_.isPainted || !parts_.file().attributes) return;
    model_.isPainted = attributes.find("paint_color") ||
                       attributes.find("mmu_segmentation", "http://schemas.slic3r.org/3mf/2017/06");
  }

  void startGroup(PropertyGroup3mf::Kind kind, const XmlAttributes& attributes) {
    group_ = nullptr;
    if (!parts_.file().attributes) return;
    const uint32_t id = whole("group of properties", attributes, "id");
    const auto [place, isNew] = model_.groups.try_emplace(id);
    if (!isNew) fail("there are two groups of properties with the id " + std::to_string(id));
    group_ = &place->second;
    group_->kind = kind;
  }

  void readColour(std::string_view name, const XmlAttributes& attributes) {
    if (!group_) return;
    const std::string_view text = trimmed(attributes.find(name).value_or(""));
    const std::string_view digits = text.substr(text.empty() ? 0 : 1);
    uint32_t bytes = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), bytes, 16);
    if (!text.starts_with('#') || (digits.size() != 6 && digits.size() != 8) || error != std::errc() ||
        end != digits.data() + digits.size())
      fail("a " + std::string(name) + " is " + excerpt(text) + "; 3MF wants #RRGGBB or #RRGGBBAA");
    if (digits.size() == 6) bytes = bytes << 8U | 0xffU;
    constexpr size_t kMaterialBytes = 1024;  // Of its look, at most.
    if (group_->colours.size() == group_->colours.capacity())
      checkGrowth(kMaterialBytes, group_->colours.size());
    group_->colours.push_back(
        glm::vec4(bytes >> 24U, bytes >> 16U & 0xffU, bytes >> 8U & 0xffU, bytes & 0xffU) / 255.0F);
    if (group_->kind == PropertyGroup3mf::Kind::Materials)
      group_->names.emplace_back(trimmed(attributes.find("name").value_or("")));
  }

  /// Returns the property of an element: the default one, unless it has an index of its own.
  Property3mf property(const XmlAttributes& attributes, std::string_view first,
                       const Property3mf& otherwise) const {
    const auto index = [&](std::string_view name) { return attributes.find(name); };
    if (!parts_.file().attributes || !index(first)) return otherwise;
    Property3mf found = otherwise;
    if (index("pid")) found.group = indexOf("pid", *index("pid"));
    found.indices = glm::uvec3(indexOf(first, *index(first)));
    if (const auto p2 = index("p2")) found.indices.y = indexOf("p2", *p2);
    if (const auto p3 = index("p3")) found.indices.z = indexOf("p3", *p3);
    return found;
  }

  uint32_t indexOf(std::string_view name, std::string_view text) const {
    const auto value = parsed<uint32_t>(text);
    if (!value) fail(std::string(name) + " is " + excerpt(text) + ", which is not the number of a property");
    return *value;
  }

  void readVertex(const XmlAttributes& attributes) {
    glm::dvec3 position;
    constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const auto text = attributes.find(kAxes[axis]);
      if (!text) failElement("vertex", object_->vertices.size(), "has no " + std::string(kAxes[axis]));
      position[axis] = real("vertex", object_->vertices.size(), kAxes[axis], *text);
    }
    if (object_->vertices.size() == object_->vertices.capacity())
      checkGrowth(sizeof(glm::dvec3), object_->vertices.size());
    object_->vertices.push_back(scale_ * position);
  }

  void readTriangle(const XmlAttributes& attributes) {
    glm::uvec3 triangle;
    constexpr std::array<std::string_view, 3> kCorners{"v1", "v2", "v3"};
    for (int corner = 0; corner < 3; ++corner) {
      const std::string_view name = kCorners[corner];
      const auto text = attributes.find(name);
      const size_t index = object_->triangles.size();
      if (!text) failElement("triangle", index, "has no " + std::string(name));
      const auto vertex = parsed<uint32_t>(*text);
      if (!vertex)
        failElement("triangle", index,
                    std::string(name) + " is " + excerpt(*text) + ", which is not a vertex index");
      if (*vertex >= object_->vertices.size())
        failElement("triangle", index,
                    std::string(name) + " is " + std::to_string(*vertex) + ", but the object has " +
                        counted(object_->vertices.size(), "vertex"));
      triangle[corner] = *vertex;
    }
    notePaint(attributes);
    readProperty(attributes);
    if (object_->triangles.size() == object_->triangles.capacity())
      checkGrowth(sizeof(glm::uvec3), object_->triangles.size());
    object_->triangles.push_back(triangle);
  }

  void readProperty(const XmlAttributes& attributes) {
    if (!parts_.file().attributes || (object_->properties.empty() && !attributes.find("p1"))) return;
    if (object_->properties.size() == object_->properties.capacity())
      checkGrowth(sizeof(Property3mf), object_->triangles.size());
    object_->properties.resize(object_->triangles.size(), object_->property);
    object_->properties.push_back(property(attributes, "p1", object_->property));
  }

  void readItem(const XmlAttributes& attributes) {
    const Placement3mf item = placement("item", model_.items.size() + model_.unprintedItems, attributes);
    if (trimmed(attributes.find("printable").value_or("1")) == "0")
      ++model_.unprintedItems;
    else
      model_.items.push_back(item);
  }

  Placement3mf placement(std::string_view element, size_t index, const XmlAttributes& attributes) {
    Placement3mf placed;
    const auto path = attributes.find("path", kProduction);
    placed.part = path ? partName(parts_, trimmed(*path)) : name_;
    placed.object = whole(element, attributes, "objectid");
    placed.line = line();
    if (const auto text = attributes.find("transform")) {
      const std::vector<std::string_view> numbers = words(*text);
      if (numbers.size() != 12)
        failElement(element, index,
                    "has a transform of " + counted(numbers.size(), "number") + "; 3MF wants 12");
      // Each row of the file is the image of an axis, the last one the translation: a column of ours.
      for (int n = 0; n < 12; ++n)
        placed.transform[n / 3][n % 3] = real(element, index, "transform", numbers[n]);
      placed.transform[3] *= scale_;
    }
    return placed;
  }

  uint32_t whole(std::string_view element, const XmlAttributes& attributes, std::string_view name) const {
    const auto text = attributes.find(name);
    if (!text) fail("an element '" + std::string(element) + "' has no " + std::string(name));
    const auto value = parsed<uint32_t>(*text);
    if (!value)
      fail("the " + std::string(name) + " of an element '" + std::string(element) + "' is " + excerpt(*text) +
           ", which is not an object's number");
    return *value;
  }

  double real(std::string_view element, size_t index, std::string_view name, std::string_view text) const {
    const auto value = parsed<double>(text);
    if (!value || !std::isfinite(*value))
      failElement(element, index,
                  std::string(name) + " is " + excerpt(text) + ", which is not a finite number");
    return *value;
  }

  /// Fails with an element's index, counted from 0 within its object or the build.
  [[noreturn]] void failElement(std::string_view element, size_t index, const std::string& what) const {
    const std::string owner = object_ && element != "item" ? " of object " + std::to_string(id_) : "";
    fail(std::string(element) + " " + std::to_string(index) + owner + ": " + what);
  }

  /// Checks the memory before an array doubles.
  void checkGrowth(size_t elementBytes, size_t count) const {
    checkMemory(parts_.file(), 3 * elementBytes * count);
  }

  ZipParts& parts_;
  const std::string& name_;
  ModelPart3mf model_;
  std::vector<Element> stack_{Element::Root};
  size_t skipped_ = 0;  ///< Number of open elements that hold no geometry.
  std::string space_;   ///< The namespace of the root: that of all elements with geometry.
  double scale_ = 1.0;
  uint32_t id_ = 0;
  Object3mf* object_ = nullptr;
  PropertyGroup3mf* group_ = nullptr;
};

}  // namespace

ModelPart3mf readModelPart(ZipParts& parts, const std::string& name) {
  Reader reader(parts, name);
  parseXml(parts, name, reader);
  return reader.finish();
}

}  // namespace raymap
