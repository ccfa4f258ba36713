#include "framework/compute/scope_tree.h"

#include <cmath>

#include "framework/base/check.h"

namespace weir {

int ScopeTree::open(std::string_view name) {
  // A simulation has some dozens of scopes, so looking through them all costs less than a map would.
  for (std::size_t i = 0; i < scopes_.size(); ++i) {
    if (scopes_[i].parent == current_ && scopes_[i].name == name) return current_ = static_cast<int>(i);
  }
  ProfileEntry totals;
  if (current_ >= 0) {
    const ProfileEntry& parent = scopes_[static_cast<std::size_t>(current_)].totals;
    totals.path = parent.path + "/";
    totals.depth = parent.depth + 1;
  }
  totals.path += name;
  scopes_.push_back({std::string(name), current_, std::move(totals)});
  return current_ = static_cast<int>(scopes_.size()) - 1;
}

int ScopeTree::close() {
  WEIR_CHECK(current_ >= 0);
  const int closed = current_;
  current_ = scopes_[static_cast<std::size_t>(closed)].parent;
  return closed;
}

void ScopeTree::add(int scope, double ms) {
  ProfileEntry& totals = scopes_[static_cast<std::size_t>(scope)].totals;
  ++totals.calls;
  totals.totalMs += ms;
}

std::string ScopeTree::pathOf(int scope) const {
  return scope < 0 ? std::string() : scopes_[static_cast<std::size_t>(scope)].totals.path;
}

std::vector<ProfileEntry> ScopeTree::entries(double scale) const {
  std::vector<ProfileEntry> result;
  for (const Scope& scope : scopes_) {
    if (scope.totals.calls == 0) continue;
    ProfileEntry& entry = result.emplace_back(scope.totals);
    entry.calls = static_cast<std::uint64_t>(std::llround(scale * static_cast<double>(entry.calls)));
    entry.totalMs *= scale;
  }
  return result;
}

void ScopeTree::clear() {
  for (Scope& scope : scopes_) {
    scope.totals.calls = 0;
    scope.totals.totalMs = 0;
  }
}

}  // namespace weir
