#include <raymap/error.h>
#include <raymap/mesh_attributes.h>
#include <raymap/words.h>

#include <algorithm>
#include <array>

#include "mesh/attribute_words.h"
#include "mesh/model.h"

namespace raymap {

namespace {

/// Place of a corner in a triangle: one of its corners, or weights of all of them.
struct Place {
  int corner = -1;
  glm::dvec3 weights{0.0};
};

/// Returns the place of a point in the plane of a triangle. Points outside get weights of 0 or more, too.
Place placeOf(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
  Place place;
  double nearest = INFINITY;
  for (int c = 0; c < 3; ++c) {
    if (p == t[size_t(c)]) return {c};
    if (const double distance = glm::distance(p, t[size_t(c)]); distance < nearest)
      nearest = distance, place.corner = c;
  }
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const auto share = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return std::clamp(glm::dot(glm::cross(b - a, p - a), normal) / glm::dot(normal, normal), 0.0, 1.0);
  };
  const glm::dvec3 shares(share(t[1], t[2]), share(t[2], t[0]), share(t[0], t[1]));
  const double sum = shares.x + shares.y + shares.z;
  if (sum > 0.0) place = {-1, shares / sum};  // Else the triangle has no area.
  return place;
}

/// Sets the value at a corner of the triangle `to`, which is a part of the triangle `from`.
template <class Value>
void carry(const CornerValues<Value>& given, uint32_t from, const Place& place, CornerValues<Value>& carried,
           size_t to, int corner) {
  if (given.corners.empty()) return;
  const glm::uvec3& ids = given.corners[from];
  uint32_t& id = carried.corners[to][corner];
  if (place.corner >= 0 || (ids.x == ids.y && ids.y == ids.z)) {
    id = ids[std::max(place.corner, 0)];
  } else if (ids.x != kNoAttribute && ids.y != kNoAttribute && ids.z != kNoAttribute) {
    id = uint32_t(carried.values.size());
    const Value &a = given.values[ids.x], &b = given.values[ids.y], &c = given.values[ids.z];
    // This keeps what is the same at all corners.
    carried.values.push_back(a + float(place.weights.y) * (b - a) + float(place.weights.z) * (c - a));
  }
}

template <class Value>
CornerValues<Value> startOf(const CornerValues<Value>& given, size_t triangles) {
  if (given.corners.empty()) return {};
  return {given.values, std::vector(triangles, glm::uvec3(kNoAttribute))};
}

std::vector<uint32_t> select(const std::vector<uint32_t>& values, std::span<const uint32_t> sources) {
  std::vector<uint32_t> selected;
  if (!values.empty())
    for (const uint32_t source : sources)
      selected.push_back(source == kNoAttribute ? kNoAttribute : values[source]);
  return selected;
}

template <class Value>
bool hasAny(const CornerValues<Value>& values) {
  return std::ranges::any_of(values.corners,
                             [](const glm::uvec3& t) { return t != glm::uvec3(kNoAttribute); });
}

size_t countUsed(const std::vector<uint32_t>& values, size_t most) {
  std::vector<bool> isUsed(most);
  for (const uint32_t value : values)
    if (value != kNoAttribute) isUsed[value] = true;
  return size_t(std::ranges::count(isUsed, true));
}

}  // namespace

std::vector<std::string> describe(const MeshAttributes& attributes, const AttributeKinds& kinds) {
  std::vector<std::string> words;
  const size_t parts = countUsed(attributes.partOf, attributes.parts.size()),
               materials = countUsed(attributes.materialOf, attributes.materials.size());
  if (kinds.parts && parts > 1) words.push_back(counted(parts, "part name"));  // One tells nothing apart.
  if (kinds.materials && materials > 0) words.push_back(counted(materials, "material"));
  if (kinds.uvs && hasAny(attributes.uvs)) words.emplace_back("texture coordinates");
  if (kinds.colours && hasAny(attributes.colours)) words.emplace_back("colours");
  return words;
}

void validate(const MeshAttributes& attributes, size_t triangles) {
  const auto check = [&](const auto& places, size_t values, const char* what) {
    const auto isIn = [&](const auto& place) {
      if constexpr (std::is_same_v<decltype(place), const uint32_t&>)
        return place == kNoAttribute || place < values;
      else
        return glm::all(
            glm::lessThan(place + 1U, glm::uvec3(uint32_t(values) + 1U)));  // `kNoAttribute` becomes 0.
    };
    if (!places.empty() && (places.size() != triangles || !std::ranges::all_of(places, isIn)))
      throw Error(ErrorCode::Usage, std::string("the ") + what + " of a mesh of " +
                                        counted(triangles, "triangle") +
                                        " do not fit it: too few or too many, or an index out of range");
  };
  check(attributes.partOf, attributes.parts.size(), "parts");
  check(attributes.materialOf, attributes.materials.size(), "materials");
  check(attributes.uvs.corners, attributes.uvs.values.size(), "texture coordinates");
  check(attributes.colours.corners, attributes.colours.values.size(), "colours");
}

MeshAttributes carryAttributes(const MeshAttributes& attributes, const MeshView& given,
                               const MeshView& result, std::span<const uint32_t> sources) {
  validate(attributes, given.triangleCount);
  MeshAttributes carried{.lost = attributes.lost};
  const auto isGiven = [&](uint32_t source) {
    return source == kNoAttribute || source < given.triangleCount;
  };
  if (!sources.empty() && (sources.size() != result.triangleCount || !std::ranges::all_of(sources, isGiven)))
    throw Error(ErrorCode::Usage, "each triangle of the result needs a source among those of the given mesh");
  if (sources.empty()) {
    const std::vector<std::string> words = describe(attributes, {true, true, true, true});
    carried.lost.insert(carried.lost.begin(), words.begin(), words.end());
    return carried;
  }
  carried.parts = attributes.parts;
  carried.partOf = select(attributes.partOf, sources);
  carried.materials = attributes.materials;
  carried.materialOf = select(attributes.materialOf, sources);
  carried.libraries = attributes.libraries;
  carried.gltf = attributes.gltf;
  carried.uvs = startOf(attributes.uvs, sources.size());
  carried.colours = startOf(attributes.colours, sources.size());
  if (attributes.uvs.corners.empty() && attributes.colours.corners.empty()) return carried;
  const Model before(given), after(result);
  for (size_t f = 0; f < sources.size(); ++f) {
    if (sources[f] == kNoAttribute) continue;
    const glm::uvec3& t = before.triangles[sources[f]];
    const std::array corners{before.position(t.x), before.position(t.y), before.position(t.z)};
    for (int c = 0; c < 3; ++c) {
      const Place place = placeOf(after.position(after.triangles[f][c]), corners);
      carry(attributes.uvs, sources[f], place, carried.uvs, f, c);
      carry(attributes.colours, sources[f], place, carried.colours, f, c);
    }
  }
  return carried;
}

}  // namespace raymap
