// The entry of raymap-vdb.plugin.

#include "io/field/vdb_module.h"

#include <raymap/version.h>

namespace raymap {

namespace {
VdbHost host;
}

const VdbHost& vdbHost() {
  return host;
}

}  // namespace raymap

// NOLINTNEXTLINE(readability-identifier-naming): a symbol for the dynamic loader.
extern "C" __attribute__((visibility("default"))) const raymap::VdbWriters* raymapVdbWriters(
    const raymap::VdbHost& given) {
  if (given.version != RAYMAP_VERSION || given.fieldBytes != sizeof(raymap::Field)) return nullptr;
  raymap::host = given;
  return &raymap::kVdbWriters;
}
