// Parameters that a module type once had and another type now has, or that once meant something else. A
// scene that sets one of them gets the other type, with a warning that says what to write. Where a pipeline
// has the other type by default, a module that names no type and sets a renamed parameter is of the type that
// has that name. Announced as a service:
//
//   registry.addService<MovedParameters>("MyOldSolver", [] { return std::make_unique<MyMoved>(); });
#pragma once

#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

class MovedParameters {
 public:
  static constexpr std::string_view kInterface = "MovedParameters";
  struct Parameter {
    std::string_view before, now;
    Value otherwise;  ///< its default before, which the other type gets where a scene does not set it
  };
  virtual ~MovedParameters() = default;
  virtual std::string_view from() const = 0;
  virtual std::string_view to() const = 0;  ///< the same, where only the meaning changed
  /// Those that only the other type has now.
  virtual std::vector<Parameter> parameters() const = 0;
  /// Those of both that have another name or default in the other.
  virtual std::vector<Parameter> renamed() const = 0;
  /// Whether these parameters, one of parameters() at least, did anything. Otherwise the type stays, and
  /// those that moved are left out.
  virtual bool matter(const Value& params) const = 0;
  /// Whether a scene that has these parameters means them as they were.
  virtual bool concerns(const Value& /*params*/) const { return true; }
  /// What the warning says where both types are one.
  virtual std::string_view meaning() const { return {}; }
};

}  // namespace weir
