// The nested scopes of a profiler and their totals; where the times come from is the back end's matter.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "framework/compute/profiler.h"

namespace weir {

class ScopeTree {
 public:
  /// Enters the scope `name` below the one that is open; gives its number.
  int open(std::string_view name);
  /// Leaves the innermost open scope; gives its number.
  int close();
  /// Adds one finished measurement.
  void add(int scope, double ms);

  /// The number of the innermost open scope; -1 if none is open.
  int current() const { return current_; }
  /// Of the scope of that number, "water/solver/density"; "" for -1.
  std::string pathOf(int scope) const;
  std::string currentPath() const { return pathOf(current_); }
  /// The scopes that were measured, in order of first appearance, with `scale` times their totals.
  std::vector<ProfileEntry> entries(double scale = 1) const;
  /// Forgets the totals; open scopes stay open.
  void clear();

 private:
  struct Scope {
    std::string name;
    int parent;  // -1 at the top
    ProfileEntry totals;
  };

  std::vector<Scope> scopes_;
  int current_ = -1;
};

}  // namespace weir
