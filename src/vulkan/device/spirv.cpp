#include "vulkan/device/spirv.h"

#include <algorithm>
#include <map>

namespace raymap::vulkan {

namespace {

// SPIR-V specification, §3.
enum Op : uint32_t {
  OpTypeInt = 21,
  OpTypeFloat = 22,
  OpTypeVector = 23,
  OpTypeArray = 28,
  OpTypeStruct = 30,
  OpTypePointer = 32,
  OpConstant = 43,
  OpVariable = 59,
  OpDecorate = 71,
  OpMemberDecorate = 72
};
constexpr uint32_t kDecorationArrayStride = 6;
constexpr uint32_t kDecorationOffset = 35;
constexpr uint32_t kStoragePushConstant = 9;
constexpr uint32_t kPointerBytes = 8;  // Size of a buffer reference.

/// Declarations of a module that decide the size of a type.
class Types {
 public:
  /// Adds an instruction; `words` includes its first word.
  void add(std::span<const uint32_t> words) {
    switch (opOf(words)) {
      case OpTypeInt:
      case OpTypeFloat:
      case OpTypeVector:
      case OpTypeArray:
      case OpTypeStruct:
      case OpTypePointer:
        types_[words[1]] = words;
        break;
      case OpConstant:
        constants_[words[2]] = words[3];
        break;
      case OpDecorate:
        if (words[2] == kDecorationArrayStride) strides_[words[1]] = words[3];
        break;
      case OpMemberDecorate:
        if (words[3] == kDecorationOffset) offsets_[{words[1], words[2]}] = words[4];
        break;
      default:
        break;
    }
  }

  uint32_t bytes(uint32_t id) const {
    const std::span<const uint32_t> words = types_.at(id);
    switch (opOf(words)) {
      case OpTypeInt:
      case OpTypeFloat:
        return words[2] / 8;
      case OpTypeVector:
        return bytes(words[2]) * words[3];
      case OpTypeArray:
        return strides_.at(id) * constants_.at(words[3]);
      case OpTypePointer:
        return kPointerBytes;
      default:
        break;
    }
    uint32_t end = 0;
    for (uint32_t member = 0; member + 2 < words.size(); ++member)
      end = std::max(end, offsets_.at({id, member}) + bytes(words[member + 2]));
    return end;
  }

  uint32_t pointee(uint32_t pointer) const { return types_.at(pointer)[3]; }

 private:
  std::map<uint32_t, std::span<const uint32_t>> types_;
  std::map<uint32_t, uint32_t> constants_;
  std::map<uint32_t, uint32_t> strides_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> offsets_;
};

}  // namespace

uint32_t pushConstantBytes(std::span<const uint32_t> code) {
  Types types;
  uint32_t bytes = 0;
  forEachInstruction(code, [&](std::span<const uint32_t> words) {
    types.add(words);
    if (opOf(words) == OpVariable && words[3] == kStoragePushConstant)
      bytes = types.bytes(types.pointee(words[1]));
  });
  return bytes;
}

}  // namespace raymap::vulkan
