// Writes .vdb and .nvdb by raymap-vdb.so, which is loaded for the first file and stays.

#include <dlfcn.h>
#include <raymap/error.h>
#include <raymap/version.h>

#include <string>

#include "io/field/vdb_module.h"
#include "io/import/companion.h"

namespace raymap {

namespace {

[[noreturn]] void fail(const std::string& why) {
  throw Error(ErrorCode::Unsupported, std::string("cannot write a .vdb or .nvdb: ") + why);
}

const VdbWriters& load() {
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

void writeVdb(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage) {
  writers().vdb(out, field, array, storage);
}

void writeVdb(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage) {
  writers().vdbBands(out, bands, storage);
}

void writeNvdb(std::ostream& out, const Field& field, const NamedArray& array, const VdbStorage& storage) {
  writers().nvdb(out, field, array, storage);
}

void writeNvdb(std::ostream& out, std::span<const NamedField> bands, const VdbStorage& storage) {
  writers().nvdbBands(out, bands, storage);
}

}  // namespace raymap
