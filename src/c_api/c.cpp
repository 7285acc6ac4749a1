// The functions of raymap/c.h about errors, the version, threads and devices.

#include <raymap/c.h>
#include <raymap/devices.h>
#include <raymap/memory.h>
#include <raymap/threads.h>
#include <raymap/version.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "c_api/c_report.h"

using namespace raymap;
using raymap::c::guard;
using raymap::c::need;

namespace {

struct Failure {
  raymap_result code = RAYMAP_OK;
  std::array<char, 2048> message{};  // Fixed: running out of memory must be reported too.
};

thread_local Failure lastFailure;

}  // namespace

raymap_result raymap::c::fail(raymap_result code, const char* message) noexcept {
  lastFailure.code = code;
  std::snprintf(lastFailure.message.data(), lastFailure.message.size(), "%s", message);
  return code;
}

raymap_result raymap_last_error(void) {
  return lastFailure.code;
}

const char* raymap_last_error_message(void) {
  return lastFailure.message.data();
}

const char* raymap_version(void) {
  return version().text;
}

void raymap_text_free(char* text) {
  std::free(text);
}

raymap_result raymap_set_default_threads(int32_t threads) {
  return guard([&] { setDefaultThreads(threads); });
}

raymap_result raymap_default_threads(int32_t* threads) {
  return guard([&] { need(threads, "the number of threads") = defaultThreads(); });
}

raymap_result raymap_limit_memory(uint64_t bytes, int32_t isStrict) {
  return guard([&] { limitMemory(bytes, isStrict != 0); });
}

uint64_t raymap_memory_left(void) {
  return memoryLeft();
}

char* raymap_devices_json(void) {
  return c::report([] { return toJson(devices().devices); });
}

raymap_result raymap_devices_test(const char* id) {
  return guard([&] {
    const DeviceTest test = testDevice(&need(id, "the name of a device"));
    if (!test.problem.empty())
      throw Error(ErrorCode::Unsupported, test.device.id + " (" + test.device.name + ", driver " +
                                              test.device.driver + ") failed its test: " + test.problem);
  });
}
