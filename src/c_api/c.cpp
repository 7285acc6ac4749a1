// The functions of raymap/c.h about errors, the version, threads and devices.

#include <raymap/c.h>
#include <raymap/memory.h>
#include <raymap/names.h>
#include <raymap/threads.h>
#include <raymap/version.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "c_api/c_handles.h"
#include "c_api/c_struct.h"

using namespace raymap;
using raymap::c::create;
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

raymap_devices* raymap_devices_list(void) {
  return create([] {
    auto handle = std::make_unique<raymap_devices>();
    handle->list = devices();
    return handle;
  });
}

void raymap_devices_free(raymap_devices* devices) {
  delete devices;
}

size_t raymap_devices_count(const raymap_devices* devices) {
  return devices ? devices->list.devices.size() : 0;
}

raymap_result raymap_devices_get(const raymap_devices* devices, size_t index, raymap_device* device) {
  return guard([&] {
    const DeviceList& list = need(devices, "the list of devices").list;
    if (index >= list.devices.size())
      throw Error(ErrorCode::Usage, "there is no device " + std::to_string(index) + ", only " +
                                        std::to_string(list.devices.size()));
    const DeviceInfo& found = list.devices[index];
    c::write({.size = sizeof(raymap_device),
              .id = found.id.c_str(),
              .name = found.name.c_str(),
              .type = c::nameOf(found.type),
              .driver = found.driver.c_str(),
              .problem = found.problem.c_str(),
              .memory = found.memory,
              .is_automatic = found.automatic,
              .test = c::nameOf(found.test),
              .test_problem = found.testProblem.c_str()},
             device);
  });
}

raymap_result raymap_devices_test(const char* id) {
  return guard([&] {
    const DeviceTest test = testDevice(&need(id, "the name of a device"));
    if (!test.problem.empty())
      throw Error(ErrorCode::Unsupported, test.device.id + " (" + test.device.name + ", driver " +
                                              test.device.driver + ") failed its test: " + test.problem);
  });
}
