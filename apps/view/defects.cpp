#include "defects.h"

#include <raymap/error.h>
#include <raymap/render.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace raymap::view {

namespace {

/// Kinds in the order in which they are drawn: of those in one place, the last is seen. Degenerate faces are
/// too thin to be seen.
constexpr std::array kOrder{Defect::DuplicateFace, Defect::DoubleSidedFace, Defect::FlippedFace,
                            Defect::CrossedFace,   Defect::NonManifoldEdge, Defect::Hole};

bool isReady(const std::future<std::vector<DefectList>>& found) {
  return found.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

Mesh meshOf(const Content& content, double seconds) {
  Mesh mesh = content.animated ? posed(*content.animated, seconds) : content.mesh;
  if (!content.given.empty()) mesh.triangles = content.given;
  return mesh;
}

uint32_t packed(const std::array<uint8_t, 3>& colour) {
  return uint32_t(colour[0]) | uint32_t(colour[1]) << 8 | uint32_t(colour[2]) << 16 | 0xff000000u;
}

}  // namespace

Defects::~Defects() {
  clear();
}

void Defects::clear() {
  if (search_) {
    search_->isGivenUp = true;
    givenUp_.push_back(std::move(search_));
  }
  std::erase_if(givenUp_, [](const auto& search) { return isReady(search->found); });
  isKnown_ = false;
  lists_.clear();
  error_.clear();
  parts_.clear();
  places_.clear();
  chosen_.reset();
}

void Defects::find(const Content& content, double seconds, const MachineOptions& machine) {
  if (search_ || isKnown_) return;
  search_ = std::make_unique<Search>();
  search_->mesh = meshOf(content, seconds);
  search_->found = std::async(std::launch::async, [&search = *search_, threads = machine.threads] {
    const auto goOn = [&search](std::string_view, double) { return !search.isGivenUp; };
    return findDefectPlaces(search.mesh, {.threads = threads, .progress = goOn});
  });
}

bool Defects::record(Frame& frame) {
  if (!search_ || !isReady(search_->found)) return false;
  isKnown_ = true;
  try {
    lists_ = search_->found.get();
  } catch (const Error& error) {
    error_ = error.what();
  }
  for (const DefectList& list : lists_) places_.insert(places_.end(), list.places.begin(), list.places.end());
  upload(frame);
  search_.reset();
  return true;
}

void Defects::upload(Frame& frame) {
  std::vector<uint32_t> indices;
  std::vector<size_t> starts;
  for (const Defect defect : kOrder)
    for (const DefectList& list : lists_) {
      if (list.defect != defect) continue;
      starts.push_back(indices.size());
      for (const uint32_t face : list.faces) {
        const glm::uvec3& t = search_->mesh.triangles[face];
        indices.insert(indices.end(), {t.x, t.y, t.z});
      }
      for (const glm::uvec2& edge : list.edges) indices.insert(indices.end(), {edge.x, edge.y});
      parts_.push_back({.count = uint32_t(list.count()),
                        .colour = packed(defectColour(defect)),
                        .isEdges = !list.edges.empty()});
    }
  if (indices.empty()) return;
  if (indices_.handle) frame.keep(std::move(indices_));  // Earlier frames may still draw it.
  indices_ = gpu_.makeBuffer(indices.size() * sizeof(uint32_t));
  for (size_t part = 0; part < parts_.size(); ++part)
    parts_[part].indices = indices_.address + starts[part] * sizeof(uint32_t);
  frame.upload(std::as_bytes(std::span(indices)), indices_);
}

void Defects::choose(size_t number) {
  chosen_ = number < places_.size() ? std::optional(number) : std::nullopt;
}

void Defects::chooseNext(int step) {
  const size_t count = places_.size();
  if (count == 0) return;
  if (chosen_)
    chosen_ = (*chosen_ + (step > 0 ? 1 : count - 1)) % count;
  else
    chosen_ = step > 0 ? 0 : count - 1;
}

const DefectPlace* Defects::place() const {
  return chosen_ ? &places_[*chosen_] : nullptr;
}

}  // namespace raymap::view
