// What solids a fluid may not enter, as kernels see them.
#pragma once

#include <string_view>

#include "framework/base/vec.h"

namespace weir {

struct BoundaryHit {
  float distance = 0;  ///< m, negative inside a solid
  Vec3f normal;        ///< unit, out of the solid
  float restitution = 0, friction = 0;
};

struct BoundaryView {};

WEIR_HD inline BoundaryHit boundaryQuery(const BoundaryView&, const Vec3f&) {
  return {1e9f, {0, 1, 0}, 0, 0};
}

struct Boundary {
  static constexpr std::string_view kPortType = "Boundary";
  /// What a fluid asks of its boundaries.
  struct Request {
    float spacing = 0;  ///< m
    friend bool operator==(const Request&, const Request&) = default;
  };
  BoundaryView view() const { return {}; }
};

}  // namespace weir
