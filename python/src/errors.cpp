#include <raymap/error.h>
#include <raymap/names.h>

#include <exception>
#include <new>
#include <string_view>

#include "bindings.h"

namespace raymap::python {

nb::str toText(std::string_view message) {
  return nb::steal<nb::str>(
      PyUnicode_DecodeUTF8(message.data(), Py_ssize_t(message.size()), "backslashreplace"));
}

namespace {

/// Raises the class of raymap._errors for this code.
void raise(const Error& error) {
  try {
    const nb::object make = nb::module_::import_("raymap._errors").attr("make_error");
    const nb::object made = make(toText(name(error.code())), toText(error.what()));
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
  } catch (nb::python_error& other) {
    other.restore();
  }
}

}  // namespace

void bindErrors(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    } catch (const std::bad_alloc&) {
      raise(Error(ErrorCode::Memory, "there is not enough memory"));
    }
  });
}

}  // namespace raymap::python
