#include <raymap/devices.h>

#include "call.h"
#include "records.h"

namespace raymap::python {

namespace {

nb::list listDevices() {
  DeviceList found;
  {
    const nb::gil_scoped_release release;
    found = devices();
  }
  return toPython(found.devices);
}

nb::dict test(const std::string& id, nb::object progress) {
  Call call(std::move(progress));
  DeviceTest result;
  call.run([&] { result = testDevice(id, call.on({})); });
  return toPython(result);
}

}  // namespace

void bindDevices(nb::module_& module) {
  module.def("devices", &listDevices);
  module.def("device_to_test", &deviceToTest, nb::call_guard<nb::gil_scoped_release>());
  module.def("test_device", &test, "id"_a, "progress"_a.none());
}

}  // namespace raymap::python
