// The state of a simulation as named arrays: what a checkpoint holds.
//
// A node saves in Node::save() all that its future depends on and that reset() does not make again, and takes
// it back in Node::restore(), which runs after reset(). Names are paths, "water/particles/position".
//
//   void save(const StateWriter& to) const override { to.put("travel", travel_); }
//   void restore(const StateReader& from) override { from.get("travel", travel_); }
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace weir {

/// What the numbers of an array are. Structures without a kind of their own are kept as bytes.
enum class StateKind { kFloat, kDouble, kInt, kInt64, kByte };

/// Bytes of a number of that kind.
std::size_t sizeOf(StateKind kind);

struct StateArray {
  StateKind kind = StateKind::kByte;
  std::int64_t rows = 0;
  int columns = 1;  ///< numbers in a row
  std::vector<std::byte> data;

  std::size_t bytes() const { return static_cast<std::size_t>(rows) * columns * sizeOf(kind); }
};

/// By path.
using StateArrays = std::map<std::string, StateArray, std::less<>>;

namespace detail {

struct StateElement {
  StateKind kind;
  int columns;
};

template <class T>
constexpr StateElement stateElementOf() {
  static_assert(std::is_trivially_copyable_v<T>);
  if constexpr (std::is_same_v<T, float>)
    return {StateKind::kFloat, 1};
  else if constexpr (std::is_same_v<T, Vec3f>)
    return {StateKind::kFloat, 3};
  else if constexpr (std::is_same_v<T, double>)
    return {StateKind::kDouble, 1};
  else if constexpr (std::is_same_v<T, int>)
    return {StateKind::kInt, 1};
  else if constexpr (std::is_same_v<T, std::int64_t>)
    return {StateKind::kInt64, 1};
  else
    return {StateKind::kByte, static_cast<int>(sizeof(T))};
}

}  // namespace detail

/// Writes below one path.
class StateWriter {
 public:
  explicit StateWriter(StateArrays& to, std::string prefix = {}) : to_(&to), prefix_(std::move(prefix)) {}

  StateWriter in(std::string_view name) const { return StateWriter(*to_, prefix_ + std::string(name) + "/"); }
  template <class T>
  void put(std::string_view name, std::span<const T> values) const {
    const detail::StateElement element = detail::stateElementOf<T>();
    put(name, element.kind, element.columns, std::as_bytes(values));
  }
  template <class T>
  void put(std::string_view name, const T& value) const {
    put(name, std::span<const T>(&value, 1));
  }
  /// The first `count` elements; waits for the device.
  template <class T>
  void put(std::string_view name, const Array<T>& array, std::int64_t count) const {
    const std::vector<T> values = array.toHost(count);
    put(name, std::span<const T>(values));
  }

 private:
  void put(std::string_view name, StateKind kind, int columns, std::span<const std::byte> data) const;

  StateArrays* to_;
  std::string prefix_;
};

/// Reads below one path. Throws an io Error that names the path for what is missing or of another kind.
class StateReader {
 public:
  explicit StateReader(const StateArrays& from, std::string prefix = {})
      : from_(&from), prefix_(std::move(prefix)) {}

  StateReader in(std::string_view name) const {
    return StateReader(*from_, prefix_ + std::string(name) + "/");
  }
  bool has(std::string_view name) const;
  template <class T>
  std::vector<T> getAll(std::string_view name) const {
    const detail::StateElement element = detail::stateElementOf<T>();
    const StateArray& found = find(name, element.kind, element.columns);
    std::vector<T> values(static_cast<std::size_t>(found.rows));
    copyTo(found, values.data());
    return values;
  }
  template <class T>
  void get(std::string_view name, T& value) const {
    const detail::StateElement element = detail::stateElementOf<T>();
    const StateArray& found = find(name, element.kind, element.columns);
    checkRows(name, found, 1);
    copyTo(found, &value);
  }
  /// Into the first elements of an array that has room for them.
  template <class T>
  void get(std::string_view name, Array<T>& array) const {
    const std::vector<T> values = getAll<T>(name);
    WEIR_CHECK(static_cast<std::int64_t>(values.size()) <= array.size());
    if (!values.empty()) array.device().upload(array.data(), values.data(), values.size() * sizeof(T));
  }

 private:
  const StateArray& find(std::string_view name, StateKind kind, int columns) const;
  void checkRows(std::string_view name, const StateArray& array, std::int64_t rows) const;
  static void copyTo(const StateArray& array, void* to);

  const StateArrays* from_;
  std::string prefix_;
};

}  // namespace weir
