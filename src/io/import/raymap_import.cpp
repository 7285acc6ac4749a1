// raymap-import FORMAT FILE MEMORY SECONDS GRID SAMPLES: reads a file with Assimp or OpenVDB and writes it in
// the format of import_stream.h. FORMAT is an extension: .vdb, .nvdb, or one that Assimp knows. MEMORY is in
// bytes. GRID and SAMPLES are those of sendVdb, and count for fields.
//
// It is a process of its own, because these libraries crash on some damaged files and take any amount of
// memory on others.

#include "io/import/raymap_import.h"

#include <raymap/error.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>

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

/// Limits the address space to `bytes` more than the process has now, for its code and libraries.
void limitMemory(uint64_t bytes) {
  uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE)) + bytes;
  const rlimit both{most, most};
  setrlimit(RLIMIT_AS, &both);
}

void limitOutput() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  setrlimit(RLIMIT_FSIZE, &none);
}

void send(char** arguments) {
  const std::string format = arguments[1];
  [[maybe_unused]] const char* path = arguments[2];
#ifdef RAYMAP_OPENVDB
  const uint64_t mostDense = std::strtoull(arguments[6], nullptr, 10);
  if (format == ".vdb") return sendVdb(path, arguments[5], mostDense);
  if (format == ".nvdb") return sendNvdb(path, arguments[5], mostDense);
#endif
#ifdef RAYMAP_ASSIMP
  if (format != ".vdb" && format != ".nvdb") return sendMesh(path, format);
#endif
  throw Error(ErrorCode::Unsupported,
              "this raymap-import was built without the library for it; build raymap with RAYMAP_OPENVDB=ON "
              "and RAYMAP_ASSIMP=ON");
}

}  // namespace

void limitSeconds(rlim_t seconds) {
  const rlimit soft{seconds, RLIM_INFINITY};
  setrlimit(RLIMIT_CPU, &soft);
}

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

}  // namespace raymap

int main(int argc, char** argv) {
  using namespace raymap;
  if (argc != 7) return EXIT_FAILURE;
  limitMemory(std::strtoull(argv[3], nullptr, 10));
  limitSeconds(std::strtoull(argv[4], nullptr, 10));
  limitOutput();
  try {
    send(argv);
  } catch (const Error& error) {
    sendFailure(error.what(), error.code());
  } catch (const std::bad_alloc&) {
    sendFailure("it needs more memory than a file of its size may take");
  } catch (const std::exception& error) {
    sendFailure(std::string("cannot read it: ") + error.what());
  }
  std::_Exit(EXIT_SUCCESS);  // Skips destructors: a damaged file may have left objects inconsistent.
}
