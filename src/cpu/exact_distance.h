#pragma once

#include "cell_mesh.h"
#include "progress.h"

namespace raymap {

/// Keeps its memory between calls.
class ExactDistance {
 public:
  ExactDistance();
  ~ExactDistance();

  /// The distance, in cell units, of every sample to its closest triangle, and that triangle. With a `band`
  /// above zero, samples farther than that get exactly `band` and `kNoTriangle`. `triangle` may be null.
  void compute(const CellMesh& mesh, double band, Progress& progress, Buffer<float>& distance,
               Buffer<uint32_t>* triangle);

  size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace raymap
