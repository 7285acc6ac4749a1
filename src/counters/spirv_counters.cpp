#include "counters/spirv_counters.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include "counters/spirv_editor.h"

namespace raymap::vulkan {

namespace {

/// Work of a block of instructions, each time that it runs.
struct Work {
  uint32_t operations = 0, bytesRead = 0, bytesWritten = 0, rounds = 0;
};

uint32_t weightOfExtended(uint32_t number) {
  constexpr uint32_t kPow = 26, kSin = 13, kCos = 14, kSqrt = 31, kInverseSqrt = 32, kLength = 66,
                     kDistance = 67, kNormalize = 69;
  switch (number) {
    case kSin:
    case kCos:
    case kPow:
    case kSqrt:
    case kInverseSqrt:
      return 4;
    case kLength:
    case kDistance:
    case kNormalize:
      return 8;
    default:
      return 1;
  }
}

/// Returns the operations of an instruction that has a result and is no access to memory.
uint32_t operationsOf(const Types& types, Words words) {
  const uint32_t op = opOf(words);
  const uint32_t numbers = types.numbers(words[1]);
  if (op < OpPtrAccessChain || op == OpPhi) return op == OpExtInst ? numbers : 0;
  if (op >= OpVectorShuffle && op <= OpCopyObject) return 0;
  if (op == OpBitcast || op == OpConvertPtrToU || op == OpConvertUToPtr) return 0;
  if (op == OpFDiv) return 8 * numbers;
  if (op >= OpUDiv && op <= OpFMod) return 16 * numbers;
  if (op >= OpMatrixTimesScalar && op <= OpMatrixTimesVector) return 3 * numbers;
  if (op == OpDot) return types.numbers(types.typeOf(words[3]));
  if (op >= OpGroupNonUniformIAdd && op <= OpGroupNonUniformLogicalXor) return 6 * numbers;
  return numbers;
}

Work workOf(const Types& types, Words words) {
  const uint32_t op = opOf(words);
  if (op == OpExtInst) return {.operations = weightOfExtended(words[4]) * types.numbers(words[1])};
  if (op == OpLoad || op == OpStore || isAtomic(op)) {
    const bool isStore = op == OpStore || op == OpAtomicStore;
    const uint32_t storage = types.storageOf(words[isStore ? 1 : 3]);
    if (storage == kWorkgroup) return {.operations = 1};
    if (storage != kBuffer) return {};
    const uint32_t bytes = types.bytes(!isStore ? words[1] : types.typeOf(words[op == OpStore ? 2 : 4]));
    const bool reads = !isStore, writes = isStore || (isAtomic(op) && op != OpAtomicLoad);
    return {.operations = 1,
            .bytesRead = reads ? bytes : 0,
            .bytesWritten = writes ? bytes : 0,
            .rounds = reads ? 1U : 0U};
  }
  if (op >= OpAccessChain && op <= OpPtrAccessChain)
    return {.operations = types.storageOf(words[2]) == kBuffer ? 2U : 0U};
  if (op == OpBranchConditional) return {.operations = 1};
  if (op == OpControlBarrier) return {.operations = 8};
  if (op == OpSwitch) return {.operations = static_cast<uint32_t>(words.size() / 2)};
  return {.operations = hasResult(op) ? operationsOf(types, words) : 0};
}

/// Makes a shader count its work.
class WorkEditor : public SpirvEditor {
 public:
  WorkEditor(Words code, uint64_t address)
      : SpirvEditor(code, {kCapabilityInt64, kCapabilityGroups, kCapabilityGroupArithmetic}),
        address_(address) {
    for (uint32_t& variable : variables_) variable = counter();
  }

 private:
  static constexpr size_t kCounts = 4;

  void edit(Words words) override {
    const uint32_t op = opOf(words);
    if (op == OpLabel) block_ = {};
    accumulate(workOf(types(), words));
    if (endsBlock(op, before_)) count();
    if (op == OpReturn && isInMain()) report();
    before_ = op;
  }

  void accumulate(const Work& work) {
    block_.operations += work.operations;
    block_.bytesRead += work.bytesRead;
    block_.bytesWritten += work.bytesWritten;
    block_.rounds = std::max(block_.rounds, work.rounds);
  }

  /// Adds the work of the block to the invocation's counts.
  void count() {
    const std::array<uint32_t, kCounts> amounts = {block_.operations, block_.bytesRead, block_.bytesWritten,
                                                   block_.rounds};
    for (size_t i = 0; i < kCounts; ++i)
      if (amounts[i] > 0) add(variables_[i], amounts[i]);
  }

  /// Adds the invocation's counts to the dispatch's.
  void report() {
    const uint32_t operations = load(variables_[0]), rounds = load(variables_[3]);
    constexpr uint32_t kReduce = 0;
    const uint32_t stepped =
        make(OpGroupNonUniformUMax, uint(), {constant(kSubgroupScope), kReduce, operations});
    sum(offsetof(WorkCounters, operations), operations);
    sum(offsetof(WorkCounters, steppedOperations), stepped);
    sum(offsetof(WorkCounters, bytesRead), load(variables_[1]));
    sum(offsetof(WorkCounters, bytesWritten), load(variables_[2]));
    atomic(OpAtomicUMax, longConstant(address_ + offsetof(WorkCounters, longest)), operations);
    atomic(OpAtomicUMax, longConstant(address_ + offsetof(WorkCounters, mostRounds)), rounds);
  }

  void sum(size_t offset, uint32_t amount) {
    const uint32_t before = atomic(OpAtomicIAdd, longConstant(address_ + offset), amount),
                   after = make(OpIAdd, uint(), {before, amount}),
                   overflows = make(OpULessThan, typeId(OpTypeBool, {}), {after, before}),
                   carry = make(OpSelect, uint(), {overflows, constant(1), constant(0)});
    atomic(OpAtomicIAdd, longConstant(address_ + offset + 4), carry);
  }

  uint64_t address_;
  std::array<uint32_t, kCounts> variables_{};  // Operations, bytes read, bytes written, rounds.
  Work block_;
  uint32_t before_ = 0;  // Operation of the instruction before.
};

}  // namespace

std::vector<uint32_t> withCounters(std::span<const uint32_t> code, uint64_t address) {
  return WorkEditor(code, address).rewrite();
}

}  // namespace raymap::vulkan
