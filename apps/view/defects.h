#pragma once

#include <raymap/diagnostics.h>

#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "content.h"
#include "frame.h"
#include "mesh_pass.h"

namespace raymap::view {

/// The defects of a mesh: searched by another thread, and drawn in colour. For an animated mesh, those of the
/// pose that it had when the search began.
class Defects {
 public:
  explicit Defects(const Gpu& gpu) : gpu_(gpu) {}
  ~Defects();
  Defects(const Defects&) = delete;
  Defects& operator=(const Defects&) = delete;

  /// Forgets all, and gives up a search without waiting for its end.
  void clear();
  /// Begins a search, unless one was begun since `clear`.
  void find(const Content& content, double seconds, const MachineOptions& machine);
  /// Takes what a search that is over has found, and records its upload. Returns whether it did.
  bool record(Frame& frame);

  bool isBusy() const { return bool(search_); }
  /// Returns whether a search is over.
  bool isKnown() const { return isKnown_; }
  const std::vector<DefectList>& lists() const { return lists_; }
  const std::string& error() const { return error_; }
  /// Returns what to draw, the most important last.
  const std::vector<MeshPart>& parts() const { return parts_; }

  /// Chooses a place by its number among those of all lists, in their order; one beyond the end chooses none.
  void choose(size_t number);
  /// Chooses the next place, or the one before for -1; after the last one comes the first.
  void chooseNext(int step);
  std::optional<size_t> chosen() const { return chosen_; }
  /// Returns the place that is chosen; null if there is none.
  const DefectPlace* place() const;

 private:
  struct Search {
    Mesh mesh;
    std::atomic<bool> isGivenUp = false;
    std::future<std::vector<DefectList>> found = {};
  };
  void upload(Frame& frame);

  const Gpu& gpu_;
  std::unique_ptr<Search> search_;
  std::vector<std::unique_ptr<Search>> givenUp_;  ///< Searches that have not noticed it yet.
  bool isKnown_ = false;
  std::vector<DefectList> lists_;
  std::string error_;
  Buffer indices_;
  std::vector<MeshPart> parts_;
  std::vector<DefectPlace> places_;
  std::optional<size_t> chosen_;
};

}  // namespace raymap::view
