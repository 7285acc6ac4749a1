#pragma once

#include <array>

#include "io/mesh/mesh_file.h"

namespace raymap {

/// A facet of a binary STL.
struct StlFacet {
  std::array<glm::vec3, 3> corners;
  uint16_t attribute;  ///< A colour, or the number of bytes that follow the facet.
};

/// The facets of a file as a binary STL: a header of 80 bytes, their number, and 50 bytes for each. In files
/// of some programs more bytes follow each facet, as many as its attribute says.
class StlFacets {
 public:
  explicit StlFacets(const MeshFile& file);

  /// Returns whether the file has exactly the size that its number of facets, or their attributes, ask for.
  bool fits() const { return fits_; }
  /// Decides how many facets a file has whose size does not fit. Warns of a wrong number and of bytes left
  /// over. Throws `Error(Input)` if the file is cut short or its bytes are no facets.
  void guess();
  uint64_t count() const { return count_; }

  /// Calls `use(facet)` for each.
  template <class Use>
  void forEach(Use&& use) const {
    size_t at = kFacetsAt;
    for (uint64_t f = 0; f < count_; ++f) {
      const StlFacet facet = load(at);
      use(facet);
      at += kFacetBytes + (hasPayload_ ? facet.attribute : 0);
    }
  }

 private:
  static constexpr size_t kFacetsAt = 84, kFacetBytes = 50;

  StlFacet load(size_t at) const;
  size_t endWithPayload() const;
  bool looksRight(uint64_t first) const;

  const MeshFile& file_;
  uint64_t announced_ = 0;  ///< Number of facets in the header.
  uint64_t count_ = 0;      ///< Number of facets to read.
  bool hasPayload_ = false;
  bool fits_ = false;
};

}  // namespace raymap
