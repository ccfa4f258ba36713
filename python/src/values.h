// Values of parameters and statistics, from and to Python's own types.
#pragma once

#include <nanobind/nanobind.h>

#include "framework/base/value.h"

namespace weir::python {

namespace nb = nanobind;

/// None, bool, int, float, str, os.PathLike, sequences, mappings with texts as keys, and NumPy's scalars and
/// arrays. Relative paths in it are relative to the current folder. Throws Python's TypeError for anything
/// else, and OverflowError for integers beyond 64 bits.
Value toValue(nb::handle object);

/// Lists become tuples where `frozen`, so that nobody changes one and thinks that the parameter changed.
nb::object toPython(const Value& value, bool frozen);

}  // namespace weir::python
