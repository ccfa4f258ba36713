#include "python/src/errors.h"

#include <nanobind/stl/string.h>

#include <string>

#include "framework/base/error.h"

namespace weir::python {

namespace {

const char* nameOf(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kScene:
      return "scene";
    case ErrorKind::kSimulation:
      return "simulation";
    case ErrorKind::kIo:
      return "io";
  }
  return "simulation";
}

void raise(const Error& error, nb::handle type) {
  const std::string text = error.what();
  const std::size_t found = text.find(": " + error.message());
  const Location& at = error.location();
  nb::dict place;
  place["file"] = at.file;
  place["line"] = at.line;
  place["column"] = at.column;
  place["pointer"] = at.pointer;
  place["node"] = at.node;
  place["parameter"] = at.parameter;
  place["part"] = at.part;
  const nb::object exception =
      type(text, nameOf(error.kind()), text.substr(0, found == text.npos ? 0 : found), error.message(),
           error.allowed(), error.hint(), place);
  PyErr_SetObject(type.ptr(), exception.ptr());
}

}  // namespace

void raiseErrorsAs(nb::object type) {
  // The translator is there until the process ends, and so is its reference to the class.
  nb::register_exception_translator(
      [](const std::exception_ptr& thrown, void* errorType) {
        try {
          std::rethrow_exception(thrown);
        } catch (const Error& error) {
          raise(error, nb::handle(static_cast<PyObject*>(errorType)));
        }
      },
      type.release().ptr());
}

void checkSignals() {
  const nb::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

}  // namespace weir::python
