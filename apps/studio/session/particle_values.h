// Particles as tables show them: one with all of its attributes, or a page of many in an order.
#pragma once

#include <cstdint>
#include <string>

#include "framework/base/value.h"
#include "framework/run/simulation.h"

namespace weir::studio {

/// Everything about the particle of this id: {"node", "id", "attributes": {name: number or [x, y, z]}}, or
/// null if there is none. Waits for the device.
Value particleValue(const Simulation& simulation, const std::string& node, std::int64_t id);

/// Which particles of a fluid are asked for.
struct ParticlePage {
  std::string node;
  std::string sort = "id";  ///< the name of a column; equal ones are in the order of their ids
  bool descending = false;
  std::int64_t from = 0, count = 50;
};

/// {"node", "frame", "time", "total", "from", "columns": [{"name", "unit"}], "rows": [[number, …]]}: the
/// first column is "id", a vector has the columns "name.x", "name.y" and "name.z", and "speed" is among them.
/// Null if there is no such fluid. Numbers that are none, null in rows, come last in either order. Where
/// there are no longer that many particles, it is the last page. Throws a usage Error for an unknown column.
/// Waits for the device; takes as long as to copy and partition one attribute.
Value particlePageValue(const Simulation& simulation, const ParticlePage& page);

}  // namespace weir::studio
