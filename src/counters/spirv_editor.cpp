#include "counters/spirv_editor.h"

#include <algorithm>

namespace raymap::vulkan {

namespace {

constexpr uint32_t kInput = 1, kPrivate = 6;  // Storage classes.
constexpr uint32_t kDecorationBuiltIn = 11;

}  // namespace

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

bool endsBlock(uint32_t op, uint32_t before) {
  const auto isMerge = [](uint32_t o) { return o == OpLoopMerge || o == OpSelectionMerge; };
  return isMerge(op) || (op >= OpBranch && op <= OpUnreachable && !isMerge(before));
}

Types::Types(Words code) {
  forEachInstruction(code, [this](Words instruction) { add(instruction); });
}

std::optional<uint32_t> Types::find(Op op, std::initializer_list<uint32_t> operands) const {
  for (const auto& [id, words] : types_)
    if (opOf(words) == op && std::ranges::equal(words.subspan(2), operands)) return id;
  return std::nullopt;
}

uint32_t Types::bytes(uint32_t type) const {
  const Words words = types_.at(type);
  switch (opOf(words)) {
    case OpTypeInt:
    case OpTypeFloat:
      return words[2] / 8;
    case OpTypeVector:
    case OpTypeMatrix:
      return bytes(words[2]) * words[3];
    case OpTypeArray:
      return bytes(words[2]) * constant(words[3]).value();
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

uint32_t Types::numbers(uint32_t type) const {
  const auto found = types_.find(type);
  if (found == types_.end()) return 1;
  const uint32_t op = opOf(found->second);
  if (op == OpTypeVector || op == OpTypeMatrix) return numbers(found->second[2]) * found->second[3];
  return (op == OpTypeInt || op == OpTypeFloat) && found->second[2] == 64 ? 2 : 1;
}

std::optional<uint32_t> Types::constant(uint32_t value) const {
  const auto found = values_.find(value);
  if (found == values_.end() || opOf(found->second) != OpConstant) return std::nullopt;
  return found->second[3];
}

void Types::add(Words words) {
  const uint32_t op = opOf(words);
  if (op >= 19 && op <= 33) types_[words[1]] = words;
  if ((op >= 41 && op <= 52) || hasResult(op)) values_[words[2]] = words;
}

SpirvEditor::SpirvEditor(Words code, std::set<uint32_t> capabilities)
    : code_(code), types_(code), bound_(code[3]), capabilities_(std::move(capabilities)) {
  forEachInstruction(code, [this](Words words) {
    if (opOf(words) == OpEntryPoint) main_ = words[2];
    if (opOf(words) == OpCapability) capabilities_.erase(words[1]);
    if (opOf(words) == OpDecorate && words[2] == kDecorationBuiltIn) builtIns_[words[3]] = words[1];
  });
  uint_ = typeId(OpTypeInt, {32, 0});
  ulong_ = typeId(OpTypeInt, {64, 0});
}

std::vector<uint32_t> SpirvEditor::rewrite() {
  forEachInstruction(code_, [this](Words words) {
    if (opOf(words) == OpFunction) function_ = words[2];
    if (function_ == 0) return;
    edit(words);
    body_.insert(body_.end(), words.begin(), words.end());
  });
  std::vector<uint32_t> out = head();
  out.insert(out.end(), body_.begin(), body_.end());
  return out;
}

/// Returns what precedes the functions.
std::vector<uint32_t> SpirvEditor::head() const {
  std::vector<uint32_t> out(code_.begin(), code_.begin() + kSpirvHeaderWords);
  out[3] = bound_;
  for (const uint32_t capability : capabilities_) put(out, OpCapability, {capability});
  bool isBefore = true, isAnnotated = false;
  forEachInstruction(code_, [&](Words words) {
    const uint32_t op = opOf(words);
    isBefore = isBefore && op != OpFunction;
    if (!isBefore) return;
    if (!isAnnotated && (op == OpLine || (op > OpCapability + 1 && op <= OpConstant))) {
      out.insert(out.end(), annotations_.begin(), annotations_.end());
      isAnnotated = true;
    }
    const size_t at = out.size();
    out.insert(out.end(), words.begin(), words.end());
    if (op != OpEntryPoint) return;
    out.insert(out.end(), interface_.begin(), interface_.end());
    out[at] += static_cast<uint32_t>(interface_.size() << 16);
  });
  out.insert(out.end(), declarations_.begin(), declarations_.end());
  return out;
}

uint32_t SpirvEditor::make(Op op, uint32_t type, std::initializer_list<uint32_t> operands) {
  const uint32_t id = newId();
  body_.insert(body_.end(), {static_cast<uint32_t>(operands.size() + 3) << 16 | op, type, id});
  body_.insert(body_.end(), operands);
  return id;
}

void SpirvEditor::add(uint32_t variable, uint32_t amount) {
  put(OpStore, {variable, make(OpIAdd, uint_, {load(variable), constant(amount)})});
}

uint32_t SpirvEditor::atomic(Op op, uint32_t address, uint32_t amount) {
  const uint32_t pointer = make(OpConvertUToPtr, typeId(OpTypePointer, {kBuffer, uint_}), {address});
  return make(op, uint_, {pointer, constant(kDeviceScope), constant(0), amount});
}

void SpirvEditor::put(std::vector<uint32_t>& to, Op op, std::initializer_list<uint32_t> operands) {
  to.push_back(static_cast<uint32_t>(operands.size() + 1) << 16 | op);
  to.insert(to.end(), operands);
}

uint32_t SpirvEditor::typeId(Op op, std::initializer_list<uint32_t> operands) {
  if (const std::optional<uint32_t> found = types_.find(op, operands)) return *found;
  std::vector<uint32_t> key{op};
  key.insert(key.end(), operands);
  const auto [at, isNew] = made_.try_emplace(key, bound_);
  if (!isNew) return at->second;
  declarations_.insert(declarations_.end(), {static_cast<uint32_t>(operands.size() + 2) << 16 | op, newId()});
  declarations_.insert(declarations_.end(), operands);
  return at->second;
}

uint32_t SpirvEditor::constant(uint32_t value) {
  const auto [at, isNew] = made_.try_emplace({OpConstant, uint_, value}, bound_);
  if (isNew) put(declarations_, OpConstant, {uint_, newId(), value});
  return at->second;
}

uint32_t SpirvEditor::longConstant(uint64_t value) {
  const auto low = static_cast<uint32_t>(value), high = static_cast<uint32_t>(value >> 32);
  const auto [at, isNew] = made_.try_emplace({OpConstant, ulong_, low, high}, bound_);
  if (isNew) put(declarations_, OpConstant, {ulong_, newId(), low, high});
  return at->second;
}

uint32_t SpirvEditor::variable(uint32_t storage, uint32_t type) {
  const uint32_t pointer = typeId(OpTypePointer, {storage, type}), zero = constant(0), id = newId();
  interface_.push_back(id);
  if (storage == kPrivate)
    put(declarations_, OpVariable, {pointer, id, storage, zero});
  else
    put(declarations_, OpVariable, {pointer, id, storage});
  return id;
}

uint32_t SpirvEditor::counter() {
  return variable(kPrivate, uint_);
}

uint32_t SpirvEditor::builtIn(uint32_t number, uint32_t type) {
  const auto [at, isNew] = builtIns_.try_emplace(number, 0);
  if (isNew) {
    at->second = variable(kInput, type);
    put(annotations_, OpDecorate, {at->second, kDecorationBuiltIn, number});
  }
  return make(OpLoad, type, {at->second});
}

}  // namespace raymap::vulkan
