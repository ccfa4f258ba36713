// Weir's errors as Python's exception weir.Error, and what else of Python travels through C++.
#pragma once

#include <nanobind/nanobind.h>

#include <utility>

namespace weir::python {

namespace nb = nanobind;

/// From now on a weir::Error that leaves a function of this extension is raised as `type`, the class of
/// weir/_errors.py.
void raiseErrorsAs(nb::object type);

/// Ctrl-C and other signals that have Python handlers: throws what a handler raised. Takes the GIL.
void checkSignals();

/// An object that any thread may let go of.
struct HeldObject {
  explicit HeldObject(nb::object held) : object(std::move(held)) {}
  ~HeldObject() {
    const nb::gil_scoped_acquire gil;
    object.reset();
  }
  HeldObject(const HeldObject&) = delete;
  HeldObject& operator=(const HeldObject&) = delete;

  nb::object object;
};

}  // namespace weir::python
