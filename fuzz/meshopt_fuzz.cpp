// Checks that the decoders of meshopt survive any bytes. The first byte chooses the decoder and the size of
// an element, the second the number of elements.

#include <array>
#include <vector>

#include "io/gltf/meshopt.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raymap;
  if (size < 2) return 0;
  const auto in = std::as_bytes(std::span(data + 2, size - 2));
  const size_t choice = data[0] % 4, count = size_t{3} * data[1];
  const size_t stride = choice == 0 ? 4 * (1 + data[0] / 4) : 2 + 2 * (data[0] / 4 % 2);
  std::vector<std::byte> out(stride * count);
  if (choice == 0) decodeMeshoptAttributes(in, out, stride);
  if (choice == 1) decodeMeshoptTriangles(in, out, stride);
  if (choice == 2) decodeMeshoptIndices(in, out, stride);
  if (choice == 3 && size - 2 >= out.size()) {
    out.assign(in.begin(), in.end());
    for (const char* filter : {"OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"})
      for (const size_t each : {4, 8}) undoMeshoptFilter(filter, out, each);
  }
  return 0;
}
