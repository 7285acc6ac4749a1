#include "io/mesh/named_objects.h"

#include <algorithm>

#include "mesh/disjoint_sets.h"

namespace raymap {

namespace {

std::string nameOf(const MeshPart& part) {
  if (part.object.empty() || part.group.empty()) return part.object + part.group;
  return part.object + "/" + part.group;
}

}  // namespace

std::vector<uint32_t> separateParts(const WritableMesh& mesh) {
  const std::vector<uint32_t>& given = mesh.attributes->partOf;
  if (std::ranges::all_of(given, [](uint32_t part) { return part == kNoAttribute; })) return {};
  DisjointSets sets(mesh.vertices.size());
  for (const glm::uvec3& t : mesh.triangles) sets.link(t.x, t.y), sets.link(t.x, t.z);
  std::vector<uint32_t> known(mesh.vertices.size(), kNoAttribute), parts;
  for (size_t f = 0; f < given.size(); ++f) {
    uint32_t& part = known[sets.root(mesh.triangles[f].x)];
    if (part == kNoAttribute) part = given[f];
    if (given[f] != kNoAttribute && given[f] != part) return {};
  }
  for (const glm::uvec3& t : mesh.triangles) parts.push_back(known[sets.root(t.x)]);
  return parts;
}

std::vector<NamedObject> namedObjects(const WritableMesh& mesh) {
  const std::vector<uint32_t>& parts = mesh.partOf;
  std::vector<uint32_t> order;  // Parts in the order of their first faces.
  std::vector<uint32_t> numbers(mesh.attributes ? mesh.attributes->parts.size() + 1 : 0, kNoAttribute);
  const auto numberOf = [&](uint32_t part) -> uint32_t& {
    return numbers[std::min<size_t>(part, numbers.size() - 1)];
  };
  for (const uint32_t part : parts)
    if (uint32_t& number = numberOf(part); number == kNoAttribute) {
      number = uint32_t(order.size());
      order.push_back(part);
    }
  std::vector<NamedObject> objects(std::max<size_t>(order.size(), 1));
  for (size_t k = 0; k < order.size(); ++k)
    if (order[k] != kNoAttribute) objects[k].name = nameOf(mesh.attributes->parts[order[k]]);
  if (order.size() <= 1) {
    objects[0].whole = &mesh;
    return objects;
  }
  std::vector<uint32_t> ownerOf(mesh.vertices.size(), kNoAttribute), vertexOf(mesh.vertices.size());
  for (size_t f = 0; f < parts.size(); ++f)
    for (int c = 0; c < 3; ++c) ownerOf[mesh.triangles[f][c]] = numberOf(parts[f]);
  for (uint32_t v = 0; v < ownerOf.size(); ++v) {
    if (ownerOf[v] == kNoAttribute) continue;
    NamedObject& object = objects[ownerOf[v]];
    vertexOf[v] = uint32_t(object.part.vertices.size());
    object.part.vertices.push_back(mesh.vertices[v]);
    if (!mesh.exact.empty()) object.own.exact.push_back(mesh.exact[v]);
  }
  for (size_t f = 0; f < parts.size(); ++f) {
    const glm::uvec3& t = mesh.triangles[f];
    NamedObject& object = objects[numberOf(parts[f])];
    object.part.triangles.emplace_back(vertexOf[t.x], vertexOf[t.y], vertexOf[t.z]);
    object.faces.push_back(uint32_t(f));
  }
  for (NamedObject& object : objects) {
    object.part.origin = mesh.origin;
    static_cast<PackedMesh&>(object.own) = object.part;
  }
  return objects;
}

}  // namespace raymap
