// Ours. Rims: Martens, Trettner & Bessmeltsev 2026, "The Antipodal Method".

#include "vulkan/stages/face_search.h"

#include <algorithm>
#include <bit>

#include "shaders/face_search_spv.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kLists = 2;
constexpr uint32_t kLeastSlots = 64;

}  // namespace

FaceSearchStage::FaceSearchStage(Device& device, ScratchMemory* scratch)
    : count_(device, shaders::kFaceSearch, kGroup, {kCountFaces}),
      list_(device, shaders::kFaceSearch, kGroup, {kListFaces}),
      vertexHashes_(device, "hashes of vertices", scratch),
      tables_(device, "tables of edges and faces", scratch),
      lists_(device, "edges and faces for the host"),
      hostLists_(device, "edges and faces on the host", MemoryUse::ReadBack) {}

void FaceSearchStage::reserve(uint32_t vertices, uint32_t triangles) {
  vertexHashes_.resize<uint64_t>(vertices);
  sumCount_ = std::bit_ceil(std::max(triangles, kLeastSlots));
  hashCount_ = 2 * sumCount_;
  tables_.resize<uint32_t>(uint64_t{sumCount_} + hashCount_ + hashCount_ / 32);
  room_ = uint32_t(std::min(uint64_t{kMostListed}, 3 * uint64_t{triangles}));
  lists_.resize<uint32_t>(kLists * (1 + room_));
  hostLists_.resize<uint32_t>(kLists * (1 + room_));
}

void FaceSearchStage::record(Commands& commands, const DeviceMesh& mesh) {
  const auto words = [](const DeviceBuffer& buffer, uint64_t first) {
    return buffer.address() + first * sizeof(uint32_t);
  };
  const FaceSearchPush push{.triangles = mesh.triangles,
                            .vertexHashes = vertexHashes_.address(),
                            .sums = words(tables_, 0),
                            .hashes = words(tables_, sumCount_),
                            .twice = words(tables_, uint64_t{sumCount_} + hashCount_),
                            .counts = words(lists_, 0),
                            .edges = words(lists_, kLists),
                            .faces = words(lists_, kLists + room_),
                            .room = room_,
                            .triangleCount = mesh.triangleCount,
                            .sumCount = sumCount_,
                            .hashCount = hashCount_};
  commands.concurrent([&] {
    commands.fill(tables_, 0);
    commands.fill(lists_, 0);
  });
  commands.dispatch(count_, push, push.triangleCount);
  commands.dispatch(list_, push, push.triangleCount);
  commands.copy(lists_, hostLists_, lists_.bytes());
}

std::optional<std::span<const uint32_t>> FaceSearchStage::listed(uint32_t list) const {
  const std::span<const uint32_t> words = hostLists_.mapped<const uint32_t>();
  if (words[list] > room_) return std::nullopt;
  return words.subspan(kLists + list * room_, words[list]);
}

}  // namespace raymap::vulkan
