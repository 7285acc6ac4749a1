// Picture of a mesh, not of its field, with its defects in colour.

#include <raymap/render.h>

#include <algorithm>
#include <vector>

#include "base/parallel.h"
#include "mesh/defects.h"
#include "mesh/triangle.h"
#include "picture/camera.h"
#include "picture/colour.h"
#include "picture/drawn_scene.h"

namespace raymap {

namespace {

constexpr std::array<uint8_t, 3> kFrontBytes{206, 208, 212};

Colour colourOf(const std::array<uint8_t, 3>& bytes) {
  return srgb(bytes[0], bytes[1], bytes[2]);
}

const Colour kFront = colourOf(kFrontBytes), kBack = srgb(120, 128, 142);
/// How a face is drawn. Of faces in the same place, the one of the highest rank is seen; its front is seen
/// before a back of the same rank.
struct FaceLook {
  Colour colour;
  int rank;
};
const FaceLook kDuplicate{colourOf(defectColour(Defect::DuplicateFace)), 1},
    kDoubleSided{colourOf(defectColour(Defect::DoubleSidedFace)), 2},
    kFlipped{colourOf(defectColour(Defect::FlippedFace)), 3},
    kCrossed{colourOf(defectColour(Defect::CrossedFace)), 4};
constexpr int kLineRank = 10;
constexpr int kFineness = 2;        // Sub-pixels along a pixel's side.
constexpr double kLineWidth = 2.5;  // In pixels.

/// Colours and depths drawn so far, in sub-pixels.
class Canvas {
 public:
  Canvas(int width, int height)
      : width_(width * kFineness),
        height_(height * kFineness),
        depth_(size_t(width_) * size_t(height_), INFINITY),
        colour_(depth_.size()),
        rank_(depth_.size()) {}

  int width() const { return width_; }
  int height() const { return height_; }
  /// Draws a point unless one before it is there. Of points at the same depth up to rounding, that of the
  /// higher rank is seen, and the first one of a rank.
  void put(int x, int y, double depth, const glm::vec3& colour, int rank) {
    constexpr double kRounding = 1e-6;  // Share of a depth by which faces on the same corners differ at most.
    const size_t i = size_t(y) * size_t(width_) + size_t(x);
    const double margin = kRounding * depth;
    const bool isBefore = depth < depth_[i] - margin;
    const bool isAbove = depth <= depth_[i] + margin && rank > rank_[i];
    if (!isBefore && !isAbove) return;
    depth_[i] = float(depth);
    colour_[i] = colour;
    rank_[i] = uint8_t(rank);
  }
  void writeTo(Picture& picture) const {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        Colour sum(0.0);
        for (int s = 0; s < kFineness * kFineness; ++s) {
          const size_t i =
              size_t(kFineness * y + s / kFineness) * size_t(width_) + size_t(kFineness * x + s % kFineness);
          sum += depth_[i] < INFINITY
                     ? Colour(colour_[i])
                     : glm::mix(kBackgroundTop, kBackgroundBottom, double(y) / picture.height);
        }
        setPixel(picture, x, y, sum / double(kFineness * kFineness));
      }
  }

 private:
  int width_, height_;
  std::vector<float> depth_;
  std::vector<glm::vec3> colour_;
  std::vector<uint8_t> rank_;
};

/// A point's position in the picture, in sub-pixels, and its distance in front of the camera.
struct Seen {
  double x, y, depth;
};

class Drawing {
 public:
  Drawing(const PackedMesh& mesh, const RenderOptions& options)
      : mesh_(mesh),
        camera_(options, [&](std::span<const glm::dvec3> directions) { return reach(directions); }),
        toLight_(glm::normalize(-0.45 * camera_.right() - 0.55 * camera_.forward() + 0.95 * camera_.up())),
        canvas_(options.width, options.height) {
    seen_.reserve(mesh.vertices.size());
    for (const glm::vec3& vertex : mesh.vertices) seen_.push_back(project(glm::dvec3(vertex)));
  }

  void drawFaces(const Defects& defects) {
    std::vector<const FaceLook*> looks(mesh_.triangles.size(), nullptr);
    for (const uint32_t face : defects.duplicateFaces) looks[face] = &kDuplicate;
    for (const uint32_t face : defects.doubleSidedFaces) looks[face] = &kDoubleSided;
    for (const uint32_t face : defects.flippedFaces) looks[face] = &kFlipped;
    for (const uint32_t face : defects.crossedFaces) looks[face] = &kCrossed;
    for (size_t f = 0; f < mesh_.triangles.size(); ++f) drawFace(mesh_.triangles[f], looks[f]);
  }

  void drawEdges(const std::vector<EdgeEnds>& edges, Defect defect) {
    const Colour colour = colourOf(defectColour(defect));
    for (const EdgeEnds& edge : edges) drawLine(seen_[edge.a], seen_[edge.b], colour);
  }

  void writeTo(Picture& picture) const { canvas_.writeTo(picture); }

 private:
  std::vector<double> reach(std::span<const glm::dvec3> directions) const {
    std::vector<double> farthest(directions.size(), -INFINITY);
    for (const glm::uvec3& t : mesh_.triangles)
      for (int c = 0; c < 3; ++c)
        for (size_t d = 0; d < directions.size(); ++d)
          farthest[d] = std::max(farthest[d], glm::dot(directions[d], glm::dvec3(mesh_.vertices[t[c]])));
    return farthest;
  }

  Seen project(const glm::dvec3& p) const {
    const glm::dvec3 d = p - camera_.eye();
    const double depth = glm::dot(d, camera_.forward());
    const double scale = kFineness / (depth * camera_.pixelAngle());
    return {0.5 * canvas_.width() + scale * glm::dot(d, camera_.right()),
            0.5 * canvas_.height() - scale * glm::dot(d, camera_.up()), depth};
  }

  void drawFace(const glm::uvec3& t, const FaceLook* defect) {
    const auto [a, b, c] = mesh_.corners(t);
    const glm::dvec3 area = doubleAreaNormal(a, b, c);
    if (!(glm::length(area) > 0.0)) return;
    const bool isFront = glm::dot(area, camera_.eye() - a) > 0.0;
    const glm::dvec3 normal = (isFront ? 1.0 : -1.0) * glm::normalize(area);
    const double light = 0.45 + 0.55 * std::max(glm::dot(normal, toLight_), 0.0);
    const int rank = 2 * (defect ? defect->rank : 0) + (isFront ? 1 : 0);
    fill(seen_[t.x], seen_[t.y], seen_[t.z],
         light * (defect    ? defect->colour
                  : isFront ? kFront
                            : kBack),
         rank);
  }

  void fill(const Seen& a, const Seen& b, const Seen& c, const Colour& colour, int rank) {
    const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (area == 0.0) return;
    const auto first = [](double v) { return int(std::ceil(std::max(v - 0.5, 0.0))); };
    const auto last = [](double v, int size) { return int(std::floor(std::min(v - 0.5, size - 1.0))); };
    const int xEnd = last(std::max({a.x, b.x, c.x}), canvas_.width()),
              yEnd = last(std::max({a.y, b.y, c.y}), canvas_.height());
    for (int y = first(std::min({a.y, b.y, c.y})); y <= yEnd; ++y)
      for (int x = first(std::min({a.x, b.x, c.x})); x <= xEnd; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        const double u = ((c.x - b.x) * (py - b.y) - (c.y - b.y) * (px - b.x)) / area,
                     v = ((a.x - c.x) * (py - c.y) - (a.y - c.y) * (px - c.x)) / area, w = 1.0 - u - v;
        if (u >= 0.0 && v >= 0.0 && w >= 0.0)
          canvas_.put(x, y, 1.0 / (u / a.depth + v / b.depth + w / c.depth), glm::vec3(colour), rank);
      }
  }

  /// Draws a line in front of the faces beside it.
  void drawLine(const Seen& from, const Seen& to, const Colour& colour) {
    constexpr double kRadius = 0.5 * kLineWidth * kFineness, kBefore = 0.998;
    const int steps = 1 + int(std::min(std::hypot(to.x - from.x, to.y - from.y), 1e6));
    for (int s = 0; s <= steps; ++s) {
      const double share = double(s) / steps;
      const double px = glm::mix(from.x, to.x, share), py = glm::mix(from.y, to.y, share);
      const double depth = kBefore / glm::mix(1.0 / from.depth, 1.0 / to.depth, share);
      for (int y = std::max(int(py - kRadius), 0); y <= std::min(int(py + kRadius), canvas_.height() - 1);
           ++y)
        for (int x = std::max(int(px - kRadius), 0); x <= std::min(int(px + kRadius), canvas_.width() - 1);
             ++x)
          if (std::hypot(x + 0.5 - px, y + 0.5 - py) <= kRadius)
            canvas_.put(x, y, depth, glm::vec3(colour), kLineRank);
    }
  }

  PackedMesh mesh_;
  Camera camera_;
  glm::dvec3 toLight_;
  Canvas canvas_;
  std::vector<Seen> seen_;
};

}  // namespace

std::array<uint8_t, 3> defectColour(Defect defect) {
  switch (defect) {
    case Defect::Hole:
      return {214, 30, 40};
    case Defect::NonManifoldEdge:
      return {160, 40, 190};
    case Defect::CrossedFace:
      return {240, 150, 40};
    case Defect::FlippedFace:
      return {70, 120, 220};
    case Defect::DuplicateFace:
      return {230, 205, 60};
    case Defect::DoubleSidedFace:
      return {110, 170, 70};
    case Defect::DegenerateFace:
      break;
  }
  return kFrontBytes;
}

Picture renderDefects(const MeshView& view, const RenderOptions& options, const MachineOptions& machine) {
  Picture picture = makePicture(options.width, options.height);
  const Model mesh(view);
  Defects defects;
  withThreads(machine.threads, [&] { defects = findDefects(mesh, machine.progress); });
  Drawing drawing(mesh, options);
  drawing.drawFaces(defects);
  drawing.drawEdges(defects.nonManifoldEdges, Defect::NonManifoldEdge);
  drawing.drawEdges(defects.boundaryEdges, Defect::Hole);
  drawing.writeTo(picture);
  return picture;
}

}  // namespace raymap
