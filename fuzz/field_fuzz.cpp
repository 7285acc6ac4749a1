// Checks that any bytes give a field whose arrays fit its grid, or an Error.

#include <raymap/error.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include "io/field/field_formats.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const int file = memfd_create("field", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != ssize_t(size)) std::abort();
  try {
    raymap::LeftOut leftOut;
    const raymap::Field field = raymap::RAYMAP_READER(raymap::SourceFile(path), leftOut);
    for (const raymap::NamedArray& array : raymap::arraysOf(field))
      if (array.bytes.size() != field.grid.sampleCount() * elementSize(array.type)) std::abort();
  } catch (const raymap::Error& error) {
    if (std::string_view(error.what()).empty()) std::abort();
  }
  return 0;
}
