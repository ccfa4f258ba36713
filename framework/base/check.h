// WEIR_CHECK(a < b): a programmer's expectation. It is checked in every build type, and prints both values.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// A broken expectation inside Weir or a plugin: a bug, not a user's mistake.
class InternalError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

namespace detail {

template <class A>
concept Printable = requires(std::ostream& out, const A& a) {
  out << a;
};

template <class A>
std::string print(const A& a) {
  if constexpr (Printable<A>) {
    std::ostringstream out;
    out << a;
    return out.str();
  } else {
    return "(value)";
  }
}

struct CheckResult {
  bool ok;
  std::string values;  // "" where the expression is not a comparison
};

template <class A>
struct CheckLeft {
  const A& a;

  template <class B, class Compare>
  CheckResult compare(const B& b, const char* op, Compare holds) const {
    if (holds(a, b)) return {true, {}};
    return {false, print(a) + op + print(b)};
  }
  template <class B>
  CheckResult operator==(const B& b) const {
    return compare(b, " == ", [](auto& x, auto& y) { return x == y; });
  }
  template <class B>
  CheckResult operator!=(const B& b) const {
    return compare(b, " != ", [](auto& x, auto& y) { return x != y; });
  }
  template <class B>
  CheckResult operator<(const B& b) const {
    return compare(b, " < ", [](auto& x, auto& y) { return x < y; });
  }
  template <class B>
  CheckResult operator<=(const B& b) const {
    return compare(b, " <= ", [](auto& x, auto& y) { return x <= y; });
  }
  template <class B>
  CheckResult operator>(const B& b) const {
    return compare(b, " > ", [](auto& x, auto& y) { return x > y; });
  }
  template <class B>
  CheckResult operator>=(const B& b) const {
    return compare(b, " >= ", [](auto& x, auto& y) { return x >= y; });
  }
  operator CheckResult() const { return {static_cast<bool>(a), {}}; }
};

struct CheckStart {
  // Binds weaker than arithmetic and shifts, and stronger than the comparisons above.
  template <class A>
  CheckLeft<A> operator<=>(const A& a) const {
    return {a};
  }
};

[[noreturn]] void failCheck(const char* expression, const std::string& values, const char* file, int line);

}  // namespace detail
}  // namespace weir

// A macro, because only the preprocessor can quote the expression and its place.
#define WEIR_CHECK(expression)                                                                       \
  do {                                                                                               \
    const ::weir::detail::CheckResult weirCheck = ::weir::detail::CheckStart{} <=> expression;       \
    if (!weirCheck.ok) ::weir::detail::failCheck(#expression, weirCheck.values, __FILE__, __LINE__); \
  } while (false)
