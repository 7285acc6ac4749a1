#pragma once

// Runs the stages around the tree of triangles on a device.

#include <cstring>

#include "method/cell_lattice.h"
#include "vulkan/self_test/probe.h"
#include "vulkan/stages/exact_distance.h"
#include "vulkan/stages/surface_tree.h"
#include "vulkan/stages/winding_dipoles.h"

namespace raymap::vulkan {

/// A tree that was read back.
struct TreeOnHost {
  std::vector<glm::vec4> frames, discs;
  std::vector<SurfaceTreeStage::Level> levels;  ///< Leaves first.

  uint32_t triangleId(size_t place) const {
    uint32_t id;
    std::memcpy(&id, &frames.at(place * kFrameVectors + 3).z, sizeof id);
    return id;
  }
  uint32_t leafOf(size_t place) const {
    return levels.front().start + static_cast<uint32_t>(place / kTreeArity);
  }
  /// Returns the distance of a point from the disc of a node; 0 inside.
  double distance(uint32_t node, const glm::dvec3& p) const {
    return distance(discs.at(node * kDiscVectors), discs.at(node * kDiscVectors + 1), p);
  }
  static double distance(const glm::dvec4& first, const glm::dvec4& second, const glm::dvec3& p) {
    const glm::dvec3 q = p - glm::dvec3(first), normal = glm::normalize(glm::dvec3(second));
    const double height = glm::dot(q, normal);
    const double beside = glm::length(q - height * normal) - first.w;
    return glm::length(glm::max(glm::dvec2(beside, std::abs(height) - second.w), 0.0));
  }
};

/// Closest triangles of all samples.
struct ClosestResult {
  std::vector<float> distance;
  std::vector<uint32_t> triangle;
  bool operator==(const ClosestResult&) const = default;
};

/// Values that every sample starts from.
struct DipoleStart {
  float distance = 0.0f;  ///< From the surface, in cells.
  uint32_t disagreeing = 1;
  float change = 0.0f;  ///< Largest of the winding number along a crossed edge.
  WindingDipolesStage::Looks looks;
};

/// Runs the stages. The stage objects are kept from one mesh to the next.
class SurfaceProbe : public Probe {
 public:
  explicit SurfaceProbe(Device& device, const ExactDistanceStage::Imitated& imitated = {})
      : Probe(device), tree_(device, imitated.rootError), exact_(device, nullptr, imitated) {}

  /// Runs what `record` records after the tree of the mesh.
  template <class Record>
  void runWithTree(const CellMesh& mesh, Record&& record) {
    const UploadedMesh uploaded = upload(mesh);
    tree_.reserve(uploaded.addresses().triangleCount);
    run([&](Commands& commands) {
      tree_.recordClear(commands);
      tree_.record(commands, uploaded.addresses(), mesh.dims);
      record(commands, tree_);
    });
  }

  TreeOnHost tree(const CellMesh& mesh) {
    runWithTree(mesh, [](Commands&, const SurfaceTreeStage&) {});
    return {download<glm::vec4>(tree_.frames()), download<glm::vec4>(tree_.discs()), tree_.levels()};
  }

  ClosestResult closest(const CellMesh& mesh, double band = 0.0) {
    const DeviceBuffer distance = room<float>(CellLattice{mesh.dims}.count(), "distance"),
                       triangle = room<uint32_t>(CellLattice{mesh.dims}.count(), "triangle");
    exact_.reserve(mesh.dims);
    runWithTree(mesh, [&](Commands& commands, const SurfaceTreeStage& tree) {
      exact_.record(commands, tree, band, {distance.address(), triangle.address()});
    });
    return {download<float>(distance), download<uint32_t>(triangle)};
  }

  /// Settles winding numbers near the threshold 0.5.
  std::vector<float> settle(WindingDipolesStage& dipoles, const CellMesh& mesh,
                            const std::vector<float>& windings, const DipoleStart& start = {}) {
    const DeviceBuffer distance = upload(std::vector<float>(windings.size(), start.distance), "distance"),
                       winding = upload(windings, "winding"),
                       disagreeing = upload(std::vector{start.disagreeing}, "disagreeing"),
                       change = upload(std::vector{start.change}, "change");
    dipoles.reserve(static_cast<uint32_t>(mesh.triangles.size()), mesh.dims);
    runWithTree(mesh, [&](Commands& commands, const SurfaceTreeStage& tree) {
      dipoles.record(commands, tree,
                     {distance.address(), winding.address(), disagreeing.address(), change.address()},
                     start.looks, 0.5);
    });
    return download<float>(winding);
  }

 private:
  SurfaceTreeStage tree_;
  ExactDistanceStage exact_;
};

}  // namespace raymap::vulkan
