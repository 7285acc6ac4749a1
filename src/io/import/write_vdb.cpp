// Writes .vdb and .nvdb by raymap-vdb.plugin, which is loaded for the first file and stays.

#include <dlfcn.h>
#include <raymap/error.h>
#include <raymap/version.h>

#include <string>

#include "base/memory.h"
#include "io/field/vdb_module.h"
#include "io/import/companion.h"

namespace raymap {

namespace {

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorCode::Unsupported, std::string("cannot write a .vdb or .nvdb: ") + why);
}

void checkMemory() {
  constexpr uint64_t kNeeded = uint64_t{40} << 20;
  if (const uint64_t left = memoryLeft(); left < kNeeded)
    throw Error(ErrorCode::Memory, "OpenVDB, which writes a .vdb or .nvdb, needs " + neededText(kNeeded) +
                                       ", but only " + limitText(left) +
                                       " are left; write another format, such as .npy, or allow more memory");
}

const VdbWriters& load() {
  checkMemory();
  const auto file = findCompanion(kVdbModule);
  if (!file)
    fail(std::string("the library ") + kVdbModule + " that does is missing; install it beside this program");
  void* module = dlopen(file->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) fail(dlerror());
  using Entry = const VdbWriters*(const VdbHost&);
  auto* entry = reinterpret_cast<Entry*>(dlsym(module, kVdbEntry));
  const VdbWriters* writers = entry ? entry({.version = RAYMAP_VERSION,
                                             .fieldBytes = sizeof(Field),
                                             .parallelFor = parallelFor,
                                             .withCallersThreads = withCallersThreads,
                                             .checkFormatMemory = checkFormatMemory,
                                             .arraysWith = arraysWith,
                                             .largestMagnitude = largestMagnitude})
                                    : nullptr;
  if (!writers) fail(file->string() + " is of another version; install that of this program");
  return *writers;
}

const VdbWriters& writers() {
  static const VdbWriters& loaded = load();
  return loaded;
}

}  // namespace

const VdbWriter& vdbWriter() {
  return writers().vdb;
}

const VdbWriter& nvdbWriter() {
  return writers().nvdb;
}

}  // namespace raymap
