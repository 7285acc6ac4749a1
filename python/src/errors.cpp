#include <raymap/error.h>
#include <raymap/names.h>

#include <exception>
#include <string>

#include "bindings.h"

namespace raymap::python {

namespace {

/// Raises the class of raymap._errors for this code. A path in the message need not be UTF-8.
void raise(const Error& error) {
  try {
    const nb::object make = nb::module_::import_("raymap._errors").attr("make_error");
    const std::string text = error.what();
    const std::string_view code = name(error.code());
    PyObject* decoded = PyUnicode_DecodeUTF8(text.data(), Py_ssize_t(text.size()), "backslashreplace");
    const nb::object made = make(nb::str(code.data(), code.size()), nb::steal<nb::str>(decoded));
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
    }
  });
}

}  // namespace raymap::python
