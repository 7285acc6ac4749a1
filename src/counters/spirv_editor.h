#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "vulkan/device/spirv.h"

namespace raymap::vulkan {

using Words = std::span<const uint32_t>;

// SPIR-V specification, §3.
enum Op : uint32_t {
  OpUndef = 1,
  OpLine = 8,
  OpExtInst = 12,
  OpEntryPoint = 15,
  OpCapability = 17,
  OpTypeBool = 20,
  OpTypeInt = 21,
  OpTypeFloat = 22,
  OpTypeVector = 23,
  OpTypeMatrix = 24,
  OpTypeArray = 28,
  OpTypeStruct = 30,
  OpTypePointer = 32,
  OpConstant = 43,
  OpFunction = 54,
  OpFunctionEnd = 56,
  OpFunctionCall = 57,
  OpVariable = 59,
  OpLoad = 61,
  OpStore = 62,
  OpCopyMemory = 63,
  OpCopyMemorySized = 64,
  OpAccessChain = 65,
  OpInBoundsAccessChain = 66,
  OpPtrAccessChain = 67,
  OpDecorate = 71,
  OpVectorShuffle = 79,
  OpCompositeConstruct = 80,
  OpCompositeExtract = 81,
  OpCopyObject = 83,
  OpUConvert = 113,
  OpConvertPtrToU = 117,
  OpConvertUToPtr = 120,
  OpBitcast = 124,
  OpIAdd = 128,
  OpIMul = 132,
  OpUDiv = 134,
  OpFDiv = 136,
  OpFMod = 141,
  OpMatrixTimesScalar = 143,
  OpMatrixTimesVector = 145,
  OpDot = 148,
  OpSelect = 169,
  OpULessThan = 176,
  OpShiftLeftLogical = 196,
  OpBitwiseOr = 197,
  OpControlBarrier = 224,
  OpMemoryBarrier = 225,
  OpAtomicLoad = 227,
  OpAtomicStore = 228,
  OpAtomicIAdd = 234,
  OpAtomicUMax = 239,
  OpAtomicXor = 242,
  OpPhi = 245,
  OpLoopMerge = 246,
  OpSelectionMerge = 247,
  OpLabel = 248,
  OpBranch = 249,
  OpBranchConditional = 250,
  OpSwitch = 251,
  OpReturn = 253,
  OpReturnValue = 254,
  OpUnreachable = 255,
  OpNoLine = 317,
  OpGroupNonUniformIAdd = 349,
  OpGroupNonUniformUMax = 357,
  OpGroupNonUniformLogicalXor = 364
};
constexpr uint32_t kWorkgroup = 4;  // Storage classes.
constexpr uint32_t kBuffer = 5349;
constexpr uint32_t kDeviceScope = 1, kWorkgroupScope = 2, kSubgroupScope = 3;
constexpr uint32_t kCapabilityInt64 = 11, kCapabilityGroups = 61, kCapabilityGroupArithmetic = 63;

/// Returns whether an instruction of a function has a type and a result.
bool hasResult(uint32_t op);

/// Returns whether an instruction ends the part of a block into which others may be inserted.
bool endsBlock(uint32_t op, uint32_t before);

inline bool isAtomic(uint32_t op) {
  return op >= OpAtomicLoad && op <= OpAtomicXor;
}

/// Types of a module and of its values.
class Types {
 public:
  explicit Types(Words code);

  /// Returns the id of a type with these operands, if the module has it.
  std::optional<uint32_t> find(Op op, std::initializer_list<uint32_t> operands) const;
  uint32_t bytes(uint32_t type) const;
  /// Returns the operations of a simple instruction: its numbers, those of 64 bits twice.
  uint32_t numbers(uint32_t type) const;

  uint32_t typeOf(uint32_t value) const { return values_.at(value)[1]; }
  uint32_t storageOf(uint32_t pointer) const { return types_.at(typeOf(pointer))[2]; }
  Words type(uint32_t id) const { return types_.at(id); }
  /// Returns the instruction that makes a value.
  Words definition(uint32_t value) const { return values_.at(value); }
  /// Returns the value of a constant, if it is one.
  std::optional<uint32_t> constant(uint32_t value) const;

 private:
  void add(Words words);

  std::map<uint32_t, Words> types_, values_;
};

/// Rewrites a module: inserts instructions into its functions, and what they need before these.
class SpirvEditor {
 public:
  virtual ~SpirvEditor() = default;
  std::vector<uint32_t> rewrite();

 protected:
  SpirvEditor(Words code, std::set<uint32_t> capabilities);

  /// Puts what goes before an instruction of a function.
  virtual void edit(Words instruction) = 0;
  bool isInMain() const { return function_ == main_; }
  const Types& types() const { return types_; }

  void put(Op op, std::initializer_list<uint32_t> operands) { put(body_, op, operands); }
  /// Puts an instruction with a result, and returns that.
  uint32_t make(Op op, uint32_t type, std::initializer_list<uint32_t> operands);
  uint32_t load(uint32_t variable) { return make(OpLoad, uint_, {variable}); }
  /// Adds to a variable of `counter`.
  void add(uint32_t variable, uint32_t amount);
  uint32_t atomic(Op op, uint32_t address, uint32_t amount);

  uint32_t typeId(Op op, std::initializer_list<uint32_t> operands);
  uint32_t constant(uint32_t value);
  uint32_t longConstant(uint64_t value);
  /// Returns a variable of each invocation, at first 0.
  uint32_t counter();
  /// Loads a built-in variable.
  uint32_t builtIn(uint32_t number, uint32_t type);
  uint32_t uint() const { return uint_; }
  uint32_t ulong() const { return ulong_; }

 private:
  uint32_t newId() { return bound_++; }
  static void put(std::vector<uint32_t>& to, Op op, std::initializer_list<uint32_t> operands);
  uint32_t variable(uint32_t storage, uint32_t type);
  std::vector<uint32_t> head() const;

  Words code_;
  Types types_;
  uint32_t bound_, main_ = 0, function_ = 0, uint_, ulong_;
  std::set<uint32_t> capabilities_;                 // That the module lacks.
  std::map<std::vector<uint32_t>, uint32_t> made_;  // Types and constants.
  std::map<uint32_t, uint32_t> builtIns_;           // Variables.
  std::vector<uint32_t> interface_, annotations_, declarations_, body_;
};

}  // namespace raymap::vulkan
