#include "io/mesh/stl_facets.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace raymap {

StlFacets::StlFacets(const MeshFile& file) : file_(file) {
  constexpr size_t kCountAt = 80;
  const size_t size = file.bytes.size();
  if (size < kFacetsAt) return;
  uint32_t announced = 0;
  std::memcpy(&announced, file.bytes.data() + kCountAt, sizeof announced);
  announced_ = count_ = announced;
  const bool isPlain = size - kFacetsAt == announced_ * kFacetBytes;
  hasPayload_ = !isPlain && announced_ > 0 && endWithPayload() == size;
  fits_ = isPlain || hasPayload_;
}

StlFacet StlFacets::load(size_t at) const {
  float numbers[12];  // The normal, then three corners.
  StlFacet facet;
  std::memcpy(numbers, file_.bytes.data() + at, sizeof numbers);
  std::memcpy(&facet.attribute, file_.bytes.data() + at + sizeof numbers, sizeof facet.attribute);
  for (size_t c = 0; c < 3; ++c)
    facet.corners[c] = {numbers[3 + 3 * c], numbers[4 + 3 * c], numbers[5 + 3 * c]};
  return facet;
}

/// Returns where the facets end if bytes follow each as its attribute says; 0 if that is behind the file.
size_t StlFacets::endWithPayload() const {
  size_t at = kFacetsAt;
  for (uint64_t f = 0; f < announced_; ++f) {
    if (file_.bytes.size() - at < kFacetBytes) return 0;
    at += kFacetBytes + load(at).attribute;
    if (at > file_.bytes.size()) return 0;
  }
  return at;
}

/// Returns whether facets from `first` on have numbers as meshes have, and not only zeros. Few other data do.
bool StlFacets::looksRight(uint64_t first) const {
  constexpr float kSmallest = 1e-25F, kLargest = 1e15F;
  constexpr uint64_t kTolerated = 20;  // One number of so many may be odd.
  uint64_t facets = 0, zeros = 0, odd = 0;
  forEach([&](const StlFacet& facet) {
    if (facets++ < first) return;
    for (const glm::vec3& p : facet.corners)
      for (int axis = 0; axis < 3; ++axis) {
        const float size = std::abs(p[axis]);
        if (size == 0.0F)
          ++zeros;
        else if (!(size >= kSmallest && size <= kLargest))
          ++odd;
      }
  });
  const uint64_t numbers = facets > first ? 9 * (facets - first) : 0;
  return zeros < numbers && odd * kTolerated <= numbers;
}

void StlFacets::guess() {
  const size_t size = file_.bytes.size();
  const uint64_t room = size < kFacetsAt ? 0 : (size - kFacetsAt) / kFacetBytes;
  const auto warnOfRest = [&](size_t end) {
    file_.warnThat(counted(size - end, "byte") + " after the last triangle ignored");
  };
  // Some programs write 0 or -1 as the number of facets. One that is too large tells of a file cut short.
  const bool isNumber = announced_ > 0 && announced_ <= INT32_MAX;
  count_ = room;
  if (room > 0 && (size - kFacetsAt) % kFacetBytes == 0 && !(isNumber && announced_ > room) &&
      looksRight(isNumber ? announced_ : 0))
    return file_.warnThat("its header announces " +
                          (isNumber ? counted(announced_, "triangle") : "no number of triangles") +
                          ", but the file has the size of " + std::to_string(room) + ", which were read");
  if (!isNumber && looksRight(0))
    file_.fail("its header has no number of triangles, and its size fits none: it is cut short");
  count_ = std::min(announced_, room);
  if (announced_ <= room && looksRight(0)) return warnOfRest(kFacetsAt + announced_ * kFacetBytes);
  if (announced_ > room && looksRight(0))
    file_.fail("the file announces " + counted(announced_, "triangle") + ", but holds only " +
               std::to_string(room) + ": it is cut short");
  if (const size_t end = endWithPayload(); end > kFacetsAt) {
    hasPayload_ = true;
    count_ = announced_;
    if (looksRight(0)) return warnOfRest(end);
  }
  file_.fail("it is no STL file: it is neither text, nor do its bytes make triangles");
}

}  // namespace raymap
