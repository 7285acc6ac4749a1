#include <raymap/devices.h>
#include <raymap/names.h>

#include "call.h"

namespace raymap::python {

namespace {

nb::dict toDict(const DeviceInfo& device) {
  nb::dict dict;
  dict["id"] = device.id;
  dict["name"] = device.name;
  dict["type"] = std::string(name(device.type));
  dict["driver"] = device.driver;
  dict["memory"] = device.memory;
  dict["problem"] = device.problem;
  dict["test"] = std::string(name(device.test));
  dict["test_problem"] = device.testProblem;
  return dict;
}

nb::list listDevices() {
  DeviceList found;
  {
    const nb::gil_scoped_release release;
    found = devices();
  }
  nb::list list;
  for (size_t d = 0; d < found.devices.size(); ++d) {
    nb::dict device = toDict(found.devices[d]);
    device["automatic"] = d == found.automatic;
    list.append(device);
  }
  return list;
}

/// Returns the first difference from the CPU; "" if there is none.
std::string test(const std::string& id, nb::object progress) {
  Call call(std::move(progress));
  DeviceTest result;
  call.run([&] { result = testDevice(id, call.progress()); });
  return result.problem;
}

}  // namespace

void bindDevices(nb::module_& module) {
  module.def("devices", &listDevices);
  module.def("device_to_test", &deviceToTest, nb::call_guard<nb::gil_scoped_release>());
  module.def("test_device", &test, "id"_a, "progress"_a.none());
}

}  // namespace raymap::python
