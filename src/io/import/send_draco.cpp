// Decodes meshes with Draco, for `raymap-import`.

#include <draco/compression/decode.h>
#include <raymap/error.h>

#include <cstring>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "io/import/import_stream.h"
#include "io/import/raymap_import.h"

namespace raymap {

namespace {

struct Request {
  std::vector<uint32_t> attributes;
  std::vector<char> bytes;
};

template <class T>
void read(std::istream& in, std::vector<T>& values, uint64_t count) {
  values.resize(count);
  in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(count * sizeof(T)));
}

std::vector<Request> readRequests(int file) {
  std::vector<Request> requests;
  std::istringstream in(bytesOf(file));
  DracoHeader header;
  while (in.read(reinterpret_cast<char*>(&header), sizeof header)) {
    Request& request = requests.emplace_back();
    read(in, request.attributes, header.attributes);
    read(in, request.bytes, header.bytes);
  }
  return requests;
}

std::unique_ptr<draco::Mesh> decode(const Request& request, const std::string& what) {
  draco::DecoderBuffer buffer;
  buffer.Init(request.bytes.data(), request.bytes.size());
  auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok())
    throw Error(ErrorCode::Input, what + " are damaged: " + decoded.status().error_msg_string());
  for (const uint32_t id : request.attributes)
    if (!decoded.value()->GetAttributeByUniqueId(id))
      throw Error(ErrorCode::Input, what + " have no attribute " + std::to_string(id));
  return std::move(decoded).value();
}

template <class T>
double stored(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

double stored(const uint8_t* bytes, draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return stored<int8_t>(bytes);
    case draco::DT_UINT8:
      return stored<uint8_t>(bytes);
    case draco::DT_INT16:
      return stored<int16_t>(bytes);
    case draco::DT_UINT16:
      return stored<uint16_t>(bytes);
    case draco::DT_INT32:
      return stored<int32_t>(bytes);
    case draco::DT_UINT32:
      return stored<uint32_t>(bytes);
    case draco::DT_FLOAT32:
      return stored<float>(bytes);
    case draco::DT_FLOAT64:
      return stored<double>(bytes);
    default:
      throw Error(ErrorCode::Input, "its Draco data hold numbers of an unknown type");
  }
}

void sendAttribute(const draco::PointAttribute& attribute, uint32_t vertices) {
  const uint64_t components = attribute.num_components();
  put(&components, sizeof components);
  const auto each = static_cast<size_t>(draco::DataTypeLength(attribute.data_type()));
  std::vector<uint8_t> bytes(components * each);
  std::vector<double> numbers;
  for (draco::PointIndex p(0); p < vertices; ++p) {
    attribute.GetMappedValue(p, bytes.data());
    for (uint64_t c = 0; c < components; ++c)
      numbers.push_back(stored(&bytes[c * each], attribute.data_type()));
  }
  put(numbers.data(), numbers.size() * sizeof(double));
}

void sendDecoded(const draco::Mesh& mesh, const Request& request) {
  const MeshHeader header{mesh.num_points(), mesh.num_faces()};
  put(&header, sizeof header);
  std::vector<uint32_t> corners;
  for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
    for (const draco::PointIndex& corner : mesh.face(f)) corners.push_back(corner.value());
  put(corners.data(), corners.size() * sizeof(uint32_t));
  for (const uint32_t id : request.attributes)
    sendAttribute(*mesh.GetAttributeByUniqueId(id), mesh.num_points());
}

}  // namespace

void sendDraco(int file) {
  const std::vector<Request> requests = readRequests(file);
  std::vector<std::unique_ptr<draco::Mesh>> meshes;
  for (size_t i = 0; i < requests.size(); ++i)
    meshes.push_back(decode(requests[i], "its Draco data of mesh " + std::to_string(i)));
  sendSuccess("");
  for (size_t i = 0; i < requests.size(); ++i) sendDecoded(*meshes[i], requests[i]);
}

}  // namespace raymap
