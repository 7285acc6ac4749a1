#include "counters/spirv_accesses.h"

#include <stdexcept>

#include "counters/spirv_editor.h"

namespace raymap::vulkan {

namespace {

constexpr uint32_t kBuffers = 0x40, kShared = 0x100;  // Memory semantics.

/// Makes a shader log its accesses.
class AccessEditor : public SpirvEditor {
 public:
  AccessEditor(Words code, uint64_t address, uint32_t capacity)
      : SpirvEditor(code, {kCapabilityInt64, kCapabilityGroups}), address_(address), capacity_(capacity) {}

 private:
  void edit(Words words) override {
    const uint32_t op = opOf(words);
    const bool isHead = op == OpFunction || op == OpLabel || op == OpVariable || op == OpLine;
    if (isInMain() && !isStarted_ && !isHead) start();
    using Kind = Access::Kind;
    if (op == OpCopyMemory || op == OpCopyMemorySized) throw std::logic_error("copies are not logged");
    if (endsBlock(op, before_) || op == OpFunctionCall || op == OpControlBarrier) putLog();
    before_ = op;
    if (op == OpControlBarrier) pass(words);
    if (op == OpMemoryBarrier)
      fences_.push_back(words);
    else
      fences_.clear();
    if (op == OpLoad) log(words[3], words[1], Kind::Read);
    if (op == OpStore) log(words[1], types().typeOf(words[2]), Kind::Write);
    if (op == OpAtomicStore) log(words[1], types().typeOf(words[4]), Kind::Atomic);
    if (isAtomic(op) && op != OpAtomicStore) log(words[3], words[1], Kind::Atomic);
  }

  /// Names the invocation.
  void start() {
    isStarted_ = true;
    constexpr uint32_t kNumWorkgroups = 24, kWorkgroupId = 26, kLocalIndex = 29, kSubgroupId = 40;
    const uint32_t threes = typeId(OpTypeVector, {uint(), 3}), at = builtIn(kWorkgroupId, threes),
                   counts = builtIn(kNumWorkgroups, threes),
                   width = make(OpCompositeExtract, uint(), {counts, 0}),
                   x = make(OpCompositeExtract, uint(), {at, 0}),
                   y = make(OpCompositeExtract, uint(), {at, 1}), row = make(OpIMul, uint(), {y, width}),
                   group = make(OpIAdd, uint(), {row, x}), subgroup = builtIn(kSubgroupId, uint()),
                   upper = make(OpShiftLeftLogical, uint(), {group, constant(18)}),
                   middle = make(OpShiftLeftLogical, uint(), {subgroup, constant(10)}),
                   both = make(OpBitwiseOr, uint(), {upper, middle});
    put(OpStore, {who_, make(OpBitwiseOr, uint(), {both, builtIn(kLocalIndex, uint())})});
  }

  uint32_t valueOf(uint32_t constant) const { return types().constant(constant).value(); }

  /// Returns the memory that a barrier orders among all invocations of `among`.
  uint32_t orderedBy(uint32_t scope, uint32_t semantics, uint32_t among) const {
    return valueOf(scope) <= among ? valueOf(semantics) : 0;
  }

  void pass(Words words) {
    const uint32_t among = valueOf(words[1]);
    uint32_t ordered = orderedBy(words[2], words[3], among);
    for (const Words fence : fences_) ordered |= orderedBy(fence[1], fence[2], among);
    const uint32_t amount = among == kWorkgroupScope ? 0x10001 : 1;
    if (ordered & kBuffers) add(phases_, amount);
    if (ordered & kShared) add(sharedPhases_, amount);
  }

  void log(uint32_t pointer, uint32_t type, Access::Kind kind) {
    const uint32_t storage = types().storageOf(pointer);
    const bool isShared = storage == kWorkgroup;
    if (!isShared && storage != kBuffer) return;
    const uint32_t flags = uint32_t(kind) | (isShared ? 4U : 0) | types().bytes(type) / 4 << 3;
    const uint32_t what = isShared ? sharedPlace(pointer, flags << 16) : bufferPlace(pointer, flags);
    const uint32_t who = load(who_), phases = load(isShared ? sharedPhases_ : phases_);
    const uint32_t entry = make(OpCompositeConstruct, typeId(OpTypeVector, {uint(), 4}), {what, who, phases});
    entries_.push_back(make(OpBitcast, pair(), {entry}));
  }

  uint32_t pair() { return typeId(OpTypeVector, {ulong(), 2}); }

  /// Appends the entries of the block so far. One atomic reserves their places: drivers in software take long
  /// to compile each.
  void putLog() {
    if (entries_.empty()) return;
    if (entries_.size() > kLostAccesses) throw std::length_error("a block has too many accesses");
    const uint32_t count = constant(uint32_t(entries_.size())),
                   number = atomic(OpAtomicIAdd, longConstant(address_), count),
                   fits = make(OpULessThan, typeId(OpTypeBool, {}), {number, constant(capacity_)}),
                   place = make(OpSelect, uint(), {fits, number, constant(capacity_)}),
                   wide = make(OpUConvert, ulong(), {place}),
                   offset = make(OpIMul, ulong(), {wide, longConstant(sizeof(Access))});
    const uint32_t pointer = typeId(OpTypePointer, {kBuffer, pair()});
    uint64_t first = address_ + kAccessHeader;
    for (const uint32_t entry : entries_) {
      constexpr uint32_t kAligned = 2;
      const uint32_t at = make(OpIAdd, ulong(), {offset, longConstant(first)});
      put(OpStore, {make(OpConvertUToPtr, pointer, {at}), entry, kAligned, sizeof(Access)});
      first += sizeof(Access);
    }
    entries_.clear();
  }

  uint32_t bufferPlace(uint32_t pointer, uint64_t flags) {
    const uint32_t address = make(OpConvertPtrToU, ulong(), {pointer}),
                   flagged = make(OpBitwiseOr, ulong(), {address, longConstant(flags << 48)});
    return make(OpBitcast, typeId(OpTypeVector, {uint(), 2}), {flagged});
  }

  /// Pointers to shared memory have no address, but all lead from a variable by indices.
  uint32_t sharedPlace(uint32_t pointer, uint32_t flags) {
    uint32_t offset = constant(0);
    Words chain = types().definition(pointer);
    for (; opOf(chain) != OpVariable; chain = types().definition(chain[3])) {
      if (opOf(chain) != OpAccessChain && opOf(chain) != OpInBoundsAccessChain)
        throw std::logic_error("a pointer to shared memory is no access chain");
      uint32_t type = types().type(types().typeOf(chain[3]))[3];
      for (const uint32_t index : chain.subspan(4))
        offset = make(OpIAdd, uint(), {offset, step(type, index)});
    }
    if (chain[2] > 0xFFFF) throw std::length_error("a shared variable's id is too large");
    return make(OpCompositeConstruct, typeId(OpTypeVector, {uint(), 2}),
                {offset, constant(chain[2] | flags)});
  }

  /// Returns the offset of an element of a type, which becomes the element's type.
  uint32_t step(uint32_t& type, uint32_t index) {
    const Words whole = types().type(type);
    if (opOf(whole) != OpTypeStruct) {
      type = whole[2];
      return make(OpIMul, uint(), {index, constant(types().bytes(type))});
    }
    const uint32_t member = valueOf(index);
    type = whole[2 + member];
    uint32_t bytes = 0;
    for (const uint32_t before : whole.subspan(2, member)) bytes += types().bytes(before);
    return constant(bytes);
  }

  uint64_t address_;
  uint32_t capacity_;
  uint32_t who_ = counter(), phases_ = counter(), sharedPhases_ = counter();
  std::vector<uint32_t> entries_;  // Not yet in the log.
  uint32_t before_ = 0;            // Operation of the instruction before.
  std::vector<Words> fences_;      // Right before the instruction.
  bool isStarted_ = false;
};

}  // namespace

std::vector<uint32_t> withAccessLog(std::span<const uint32_t> code, uint64_t address, uint32_t capacity) {
  return AccessEditor(code, address, capacity).rewrite();
}

}  // namespace raymap::vulkan
