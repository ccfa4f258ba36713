// What the algorithms of a step find on their way and leave for those behind them, such as sums of the search
// for neighbours that save a solver its first pass. Each stands in memory that is leased (lease.h) or in an
// attribute, and is there as long as nobody has written to that or to what it was made from: nobody can get a
// by-product that is no longer true.
#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/particles/version.h"

namespace WEIR_API weir {

/// A kind of by-product with elements of type T; a constant, declared by who makes it.
template <class T>
struct ByProduct {
  std::string_view name;
};

class ByProducts {
 public:
  /// Takes the place of an earlier one of the kind. `madeFrom` has the versions of all that it was made from,
  /// and of the memory that it stands in.
  template <class T>
  void keep(const ByProduct<T>& kind, ArrayView<const T> elements, std::initializer_list<Version> madeFrom) {
    Entry& entry = entryOf(kind.name);
    entry.data = elements.data;
    entry.size = elements.size;
    entry.madeFrom = madeFrom;
  }
  template <class T>
  void forget(const ByProduct<T>& kind) {
    entryOf(kind.name).size = 0;
  }
  /// Empty if there is none that is still true.
  template <class T>
  ArrayView<const T> find(const ByProduct<T>& kind) const {
    for (const Entry& entry : entries_)
      if (entry.name == kind.name && entry.isTrue()) return {static_cast<const T*>(entry.data), entry.size};
    return {};
  }

  /// For what costs something to make, so that it is made only where somebody has asked for it, at a reset.
  template <class T>
  void request(const ByProduct<T>& kind) {
    entryOf(kind.name).isRequested = true;
  }
  template <class T>
  bool isRequested(const ByProduct<T>& kind) const {
    return std::any_of(entries_.begin(), entries_.end(),
                       [&](const Entry& entry) { return entry.name == kind.name && entry.isRequested; });
  }

 private:
  struct Entry {
    std::string_view name;
    const void* data = nullptr;
    std::int64_t size = 0;
    std::vector<Version> madeFrom;
    bool isRequested = false;

    bool isTrue() const {
      return std::all_of(madeFrom.begin(), madeFrom.end(), [](const Version& v) { return v.isPresent(); });
    }
  };

  Entry& entryOf(std::string_view name) {
    for (Entry& entry : entries_)
      if (entry.name == name) return entry;
    return entries_.emplace_back(Entry{.name = name});
  }

  std::vector<Entry> entries_;
};

}  // namespace weir
