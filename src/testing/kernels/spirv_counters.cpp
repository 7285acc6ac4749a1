#include "testing/kernels/spirv_counters.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <set>

#include "vulkan/device/spirv.h"

namespace raymap::vulkan {

namespace {

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
  OpAccessChain = 65,
  OpPtrAccessChain = 67,
  OpVectorShuffle = 79,
  OpCopyObject = 83,
  OpConvertPtrToU = 117,
  OpConvertUToPtr = 120,
  OpBitcast = 124,
  OpIAdd = 128,
  OpUDiv = 134,
  OpFDiv = 136,
  OpFMod = 141,
  OpMatrixTimesScalar = 143,
  OpMatrixTimesVector = 145,
  OpDot = 148,
  OpSelect = 169,
  OpULessThan = 176,
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
  OpControlBarrier = 224,
  OpMemoryBarrier = 225,
  OpNoLine = 317,
  OpGroupNonUniformIAdd = 349,
  OpGroupNonUniformUMax = 357,
  OpGroupNonUniformLogicalXor = 364
};
constexpr uint32_t kPrivate = 6;  // Storage classes.
constexpr uint32_t kWorkgroup = 4;
constexpr uint32_t kBuffer = 5349;
constexpr uint32_t kCapabilityInt64 = 11, kCapabilityGroups = 61, kCapabilityGroupArithmetic = 63;
constexpr uint32_t kDeviceScope = 1, kSubgroupScope = 3;

/// Returns whether an instruction of a function has a type and a result.
bool hasResult(uint32_t op) {
  switch (op) {
    case OpLine:
    case OpNoLine:
    case OpFunctionEnd:
    case OpStore:
    case OpControlBarrier:
    case OpMemoryBarrier:
    case OpAtomicStore:
    case OpLoopMerge:
    case OpSelectionMerge:
    case OpLabel:
    case OpBranch:
    case OpBranchConditional:
    case OpSwitch:
    case OpReturn:
    case OpReturnValue:
    case OpUnreachable:
      return false;
    default:
      return op >= OpFunction || op == OpUndef || op == OpExtInst;
  }
}

/// Returns whether an instruction ends the part of a block into which others may be inserted.
bool endsBlock(uint32_t op, uint32_t before) {
  const auto isMerge = [](uint32_t o) { return o == OpLoopMerge || o == OpSelectionMerge; };
  return isMerge(op) || (op >= OpBranch && op <= OpUnreachable && !isMerge(before));
}

bool isAtomic(uint32_t op) {
  return op >= OpAtomicLoad && op <= OpAtomicXor;
}

/// Work of a block of instructions, each time that it runs.
struct Work {
  uint32_t operations = 0, bytesRead = 0, bytesWritten = 0, rounds = 0;
};

/// Types of a module and of its values.
class Types {
 public:
  explicit Types(Words code) {
    forEachInstruction(code, [this](Words instruction) { add(instruction); });
  }

  /// Returns the id of a type or constant with these operands, if the module has it.
  std::optional<uint32_t> find(Op op, std::initializer_list<uint32_t> operands) const {
    for (const auto& [id, words] : types_)
      if (opOf(words) == op && std::ranges::equal(words.subspan(2), operands)) return id;
    return std::nullopt;
  }

  uint32_t bytes(uint32_t type) const {
    const Words words = types_.at(type);
    switch (opOf(words)) {
      case OpTypeInt:
      case OpTypeFloat:
        return words[2] / 8;
      case OpTypeVector:
      case OpTypeMatrix:
        return bytes(words[2]) * words[3];
      case OpTypeArray:
        return bytes(words[2]) * constants_.at(words[3]);
      case OpTypePointer:
        return 8;
      case OpTypeStruct: {
        uint32_t sum = 0;
        for (const uint32_t member : words.subspan(2)) sum += bytes(member);
        return sum;
      }
      default:
        return 4;
    }
  }

  /// Returns the operations of a simple instruction: its numbers, those of 64 bits twice.
  uint32_t numbers(uint32_t type) const {
    const auto found = types_.find(type);
    if (found == types_.end()) return 1;
    const uint32_t op = opOf(found->second);
    if (op == OpTypeVector || op == OpTypeMatrix) return numbers(found->second[2]) * found->second[3];
    return (op == OpTypeInt || op == OpTypeFloat) && found->second[2] == 64 ? 2 : 1;
  }

  uint32_t typeOf(uint32_t value) const { return values_.at(value); }
  uint32_t storageOf(uint32_t pointer) const { return types_.at(typeOf(pointer))[2]; }

 private:
  void add(Words words) {
    const uint32_t op = opOf(words);
    if (op >= 19 && op <= 33) types_[words[1]] = words;
    if (op == OpConstant) constants_[words[2]] = words[3];
    if ((op >= 41 && op <= 52) || hasResult(op)) values_[words[2]] = words[1];
  }

  std::map<uint32_t, Words> types_;
  std::map<uint32_t, uint32_t> constants_, values_;
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

/// Rewrites a module.
class Instrumenter {
 public:
  Instrumenter(Words code, uint64_t address) : code_(code), types_(code), address_(address), bound_(code[3]) {
    forEachInstruction(code, [this](Words words) {
      if (opOf(words) == OpEntryPoint) main_ = words[2];
      if (opOf(words) == OpCapability) capabilities_.insert(words[1]);
    });
    declare();
    measureBlocks();
  }

  std::vector<uint32_t> rewrite() {
    out_.assign(code_.begin(), code_.begin() + kSpirvHeaderWords);
    for (const uint32_t capability : {kCapabilityInt64, kCapabilityGroups, kCapabilityGroupArithmetic})
      if (!capabilities_.contains(capability)) put(OpCapability, {capability});
    forEachInstruction(code_, [this](Words words) { copy(words); });
    out_[3] = bound_;
    return out_;
  }

 private:
  static constexpr size_t kCounts = 4;

  uint32_t newId() { return bound_++; }

  static void put(std::vector<uint32_t>& to, Op op, std::initializer_list<uint32_t> operands) {
    to.push_back(static_cast<uint32_t>(operands.size() + 1) << 16 | op);
    to.insert(to.end(), operands);
  }
  void put(Op op, std::initializer_list<uint32_t> operands) { put(out_, op, operands); }

  uint32_t typeId(Op op, std::initializer_list<uint32_t> operands) {
    if (const std::optional<uint32_t> found = types_.find(op, operands)) return *found;
    const uint32_t id = newId();
    declarations_.push_back(static_cast<uint32_t>(operands.size() + 2) << 16 | op);
    declarations_.push_back(id);
    declarations_.insert(declarations_.end(), operands);
    return id;
  }

  uint32_t constant(uint32_t value) {
    const auto [at, isNew] = constants_.try_emplace(value, 0);
    if (isNew) {
      at->second = newId();
      put(declarations_, OpConstant, {uint_, at->second, value});
    }
    return at->second;
  }

  uint32_t addressOf(size_t offset) {
    const uint32_t id = newId();
    const uint64_t address = address_ + offset;
    put(declarations_, OpConstant,
        {ulong_, id, static_cast<uint32_t>(address), static_cast<uint32_t>(address >> 32)});
    return id;
  }

  void declare() {
    uint_ = typeId(OpTypeInt, {32, 0});
    ulong_ = typeId(OpTypeInt, {64, 0});
    bool_ = typeId(OpTypeBool, {});
    pointer_ = typeId(OpTypePointer, {kBuffer, uint_});
    const uint32_t priv = typeId(OpTypePointer, {kPrivate, uint_});
    const uint32_t zero = constant(0);
    for (uint32_t& variable : variables_) {
      variable = newId();
      put(declarations_, OpVariable, {priv, variable, kPrivate, zero});
    }
    for (const size_t offset : {offsetof(WorkCounters, operations), offsetof(WorkCounters, steppedOperations),
                                offsetof(WorkCounters, bytesRead), offsetof(WorkCounters, bytesWritten)}) {
      sums_.push_back(addressOf(offset));
      sums_.push_back(addressOf(offset + 4));
    }
    longest_ = addressOf(offsetof(WorkCounters, longest));
    mostRounds_ = addressOf(offsetof(WorkCounters, mostRounds));
    for (const uint32_t value : {1U, kDeviceScope, kSubgroupScope}) constant(value);
  }

  void copy(Words words) {
    const uint32_t op = opOf(words);
    if (op == OpFunction && function_ == 0)
      out_.insert(out_.end(), declarations_.begin(), declarations_.end());
    if (op == OpFunction) function_ = words[2];
    if (endsBlock(op, before_)) count(blocks_[nextBlock_++]);
    if (op == OpReturn && function_ == main_) report();
    before_ = op;
    const size_t at = out_.size();
    out_.insert(out_.end(), words.begin(), words.end());
    if (op != OpEntryPoint) return;
    out_.insert(out_.end(), variables_.begin(), variables_.end());
    out_[at] += static_cast<uint32_t>(kCounts << 16);
  }

  /// Finds the work of all blocks in order, and declares the constants that counting it needs.
  void measureBlocks() {
    Work block;
    uint32_t before = 0;
    forEachInstruction(code_, [&](Words words) {
      const uint32_t op = opOf(words);
      if (op == OpLabel) block = {};
      if (op >= OpFunction || op == OpExtInst) accumulate(block, workOf(types_, words));
      if (endsBlock(op, before)) {
        blocks_.push_back(block);
        for (const uint32_t amount : amountsOf(block)) constant(amount);
      }
      before = op;
    });
  }

  static void accumulate(Work& block, const Work& work) {
    block.operations += work.operations;
    block.bytesRead += work.bytesRead;
    block.bytesWritten += work.bytesWritten;
    block.rounds = std::max(block.rounds, work.rounds);
  }

  static std::array<uint32_t, kCounts> amountsOf(const Work& block) {
    return {block.operations, block.bytesRead, block.bytesWritten, block.rounds};
  }

  /// Adds the work of a block to the invocation's counts.
  void count(const Work& block) {
    const std::array<uint32_t, kCounts> amounts = amountsOf(block);
    for (size_t i = 0; i < kCounts; ++i) {
      if (amounts[i] == 0) continue;
      const uint32_t before = load(variables_[i]), after = newId();
      put(OpIAdd, {uint_, after, before, constant(amounts[i])});
      put(OpStore, {variables_[i], after});
    }
  }

  uint32_t load(uint32_t variable) {
    const uint32_t value = newId();
    put(OpLoad, {uint_, value, variable});
    return value;
  }

  /// Adds the invocation's counts to the dispatch's.
  void report() {
    const uint32_t operations = load(variables_[0]), stepped = newId(), rounds = load(variables_[3]);
    constexpr uint32_t kReduce = 0;
    put(OpGroupNonUniformUMax, {uint_, stepped, constant(kSubgroupScope), kReduce, operations});
    const uint32_t amounts[] = {operations, stepped, load(variables_[1]), load(variables_[2])};
    for (size_t i = 0; i < std::size(amounts); ++i) sum(sums_[2 * i], sums_[2 * i + 1], amounts[i]);
    atomic(OpAtomicUMax, longest_, operations);
    atomic(OpAtomicUMax, mostRounds_, rounds);
  }

  void sum(uint32_t low, uint32_t high, uint32_t amount) {
    const uint32_t before = atomic(OpAtomicIAdd, low, amount), after = newId(), overflows = newId(),
                   carry = newId();
    put(OpIAdd, {uint_, after, before, amount});
    put(OpULessThan, {bool_, overflows, after, before});
    put(OpSelect, {uint_, carry, overflows, constant(1), constant(0)});
    atomic(OpAtomicIAdd, high, carry);
  }

  uint32_t atomic(Op op, uint32_t address, uint32_t amount) {
    const uint32_t pointer = newId(), before = newId();
    put(OpConvertUToPtr, {pointer_, pointer, address});
    put(op, {uint_, before, pointer, constant(kDeviceScope), constant(0), amount});
    return before;
  }

  Words code_;
  Types types_;
  uint64_t address_;
  uint32_t bound_, main_ = 0, function_ = 0;
  uint32_t uint_ = 0, ulong_ = 0, bool_ = 0, pointer_ = 0, longest_ = 0, mostRounds_ = 0;
  std::array<uint32_t, kCounts> variables_{};  // Operations, bytes read, bytes written, rounds.
  std::vector<uint32_t> sums_;
  std::set<uint32_t> capabilities_;
  std::map<uint32_t, uint32_t> constants_;
  std::vector<uint32_t> declarations_, out_;
  std::vector<Work> blocks_;
  size_t nextBlock_ = 0;
  uint32_t before_ = 0;  // Operation of the instruction before.
};

}  // namespace

std::vector<uint32_t> withCounters(std::span<const uint32_t> code, uint64_t address) {
  return Instrumenter(code, address).rewrite();
}

}  // namespace raymap::vulkan
