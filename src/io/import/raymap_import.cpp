// raymap-import FORMAT FILE MEMORY SECONDS GRID SAMPLES: reads a file with Assimp, Draco or OpenVDB and
// writes it in the format of import_stream.h. FORMAT is an extension: .vdb, .nvdb, .drc (meshes of a glTF),
// or one that Assimp knows. MEMORY is in bytes. GRID and SAMPLES are those of sendVdb, and count for fields.
//
// It is a process of its own, because these libraries crash on some damaged files and take any amount of
// memory on others. It is confined before it reads the file (confine.h), for a file may be made to take it
// over.

#include "io/import/raymap_import.h"

#include <fcntl.h>
#include <raymap/error.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "base/text.h"
#include "io/import/confine.h"
#include "io/import/import_stream.h"

namespace raymap {

namespace {

bool hasAnswered = false;

void sendHeader(uint32_t failure, const std::string& message) {
  if (hasAnswered) std::_Exit(EXIT_FAILURE);  // The parent notices that data is missing.
  hasAnswered = true;
  ImportHeader header;
  header.failure = failure;
  header.messageBytes = message.size();
  put(&header, sizeof header);
  put(message.data(), message.size());
}

void sendFailure(const std::string& message, ErrorCode code = ErrorCode::Input) {
  sendHeader(1 + static_cast<uint32_t>(code), message);
}

/// Opens the file, and no other of those that the parent may have left open.
int openFile(const char* path) {
#ifdef SYS_close_range
  syscall(SYS_close_range, STDERR_FILENO + 1, ~0U, 0);
#endif
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) throw Error(ErrorCode::File, "cannot read it: " + std::generic_category().message(errno));
  return file;
}

void send(char** arguments) {
  const std::string format = arguments[1];
  const int file = openFile(arguments[2]);
  confine(file, {.memoryBytes = std::strtoull(arguments[3], nullptr, 10),
                 .seconds = std::strtoull(arguments[4], nullptr, 10),
                 .canOpen = format == ".vdb"});
#ifdef RAYMAP_OPENVDB
  const uint64_t mostDense = std::strtoull(arguments[6], nullptr, 10);
  if (format == ".vdb") return sendVdb(file, arguments[5], mostDense);
  if (format == ".nvdb") return sendNvdb(file, arguments[5], mostDense);
#endif
#ifdef RAYMAP_DRACO
  if (format == ".drc") return sendDraco(file);
#endif
#ifdef RAYMAP_ASSIMP
  if (format != ".vdb" && format != ".nvdb" && format != ".drc") return sendMesh(file, format);
#endif
  throw Error(ErrorCode::Unsupported,
              "this raymap-import was built without the library for it; build raymap with "
              "RAYMAP_OPENVDB=ON, RAYMAP_ASSIMP=ON and RAYMAP_DRACO=ON");
}

}  // namespace

void sendSuccess(const std::string& warning) {
  sendHeader(0, warning);
}

void put(const void* data, size_t bytes) {
  const char* at = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t written = write(STDOUT_FILENO, at, bytes);
    if (written <= 0) std::_Exit(EXIT_FAILURE);  // The reader is gone.
    at += written;
    bytes -= static_cast<size_t>(written);
  }
}

std::string bytesOf(int file) {
  std::string bytes;
  std::vector<char> part(size_t{1} << 16);
  for (ssize_t count = 0; (count = read(file, part.data(), part.size())) > 0;)
    bytes.append(part.data(), static_cast<size_t>(count));
  return bytes;
}

}  // namespace raymap

int main(int argc, char** argv) {
  using namespace raymap;
  if (argc != 7) return EXIT_FAILURE;
  try {
    send(argv);
  } catch (const Error& error) {
    sendFailure(error.what(), error.code());
  } catch (const std::bad_alloc&) {
    sendFailure("", ErrorCode::Memory);  // The parent knows why it has no more.
  } catch (const std::length_error&) {
    sendFailure("", ErrorCode::Memory);
  } catch (const std::exception& error) {
    sendFailure("cannot read it: " + withExcerpts(error.what()));
  }
  std::_Exit(EXIT_SUCCESS);  // Skips destructors: a damaged file may have left objects inconsistent.
}
