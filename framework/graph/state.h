// State that declares itself. A node or module declares as a State what its future, its outputs or its report
// depend on and reset() does not make again:
//
//   State<double> travel_{*this, "travel"};                  // plain data: numbers, vectors, random
//   generators State<std::vector<Vec3f>> marks_{*this, "marks"};        // vectors, strings and optionals of
//   it State<Array<int>> removed_{*this, "removed"};            // arrays on the device
//   State<std::vector<std::unique_ptr<Solid>>> parts_{*this, "parts"};  // objects that save themselves
//
// Checkpoints hold it, and a resumed run takes it back after reset(), without any code. What needs more than
// that, such as lists that have to be built again, is done by the hooks save() and restore().
//
// In a checkpoint a state is a set of named arrays; names are paths, "nodes/nozzle/travel".
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/array.h"

namespace WEIR_API weir {

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
  /// `device` is where arrays are made that reset() has not made.
  explicit StateReader(const StateArrays& from, Device* device = nullptr, std::string prefix = {})
      : from_(&from), device_(device), prefix_(std::move(prefix)) {}

  StateReader in(std::string_view name) const {
    return StateReader(*from_, device_, prefix_ + std::string(name) + "/");
  }
  StateReader on(Device& device) const { return StateReader(*from_, &device, prefix_); }
  Device* device() const { return device_; }
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
  /// Throws the io Error of a value that this program would not have written.
  void refuse(std::string_view name, std::string_view found, std::string_view expected) const;
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
  Device* device_;
  std::string prefix_;
};

class Stateful;

/// One declared state.
class StateMember {
 public:
  /// The name is that of its array in checkpoints; no two states of an owner have the same.
  StateMember(Stateful& owner, std::string_view name);
  virtual ~StateMember() = default;
  StateMember(const StateMember&) = delete;

  const std::string& name() const { return name_; }
  virtual void save(const StateWriter& to) const = 0;
  virtual void restore(const StateReader& from) = 0;

 protected:
  StateMember& operator=(const StateMember&) { return *this; }

 private:
  std::string name_;
};

/// What can declare states: nodes, modules, and what they are made of.
class Stateful {
 public:
  Stateful() = default;
  virtual ~Stateful() = default;
  Stateful(const Stateful&) = delete;
  Stateful& operator=(const Stateful&) = delete;

  const std::vector<StateMember*>& states() const { return states_; }
  /// All that a checkpoint needs: what is declared, then what the hook adds. May wait for the device.
  void saveState(const StateWriter& to) const;
  /// Takes that back, after reset(), in the same order.
  void restoreState(const StateReader& from);

  /// For what a declaration cannot do; declared states are saved already. Called at a frame.
  virtual void save(const StateWriter&) const {}
  /// Takes that back; what is declared is there again.
  virtual void restore(const StateReader&) {}

 private:
  friend class StateMember;
  std::vector<StateMember*> states_;
};

namespace detail {

template <class T>
inline constexpr bool kIsArray = false;
template <class T>
inline constexpr bool kIsArray<Array<T>> = true;
template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsOwner = false;
template <class T>
inline constexpr bool kIsOwner<std::unique_ptr<T>> = true;

template <class T>
concept SavesItself = requires(const T& saved, T& restored, const StateWriter& to, const StateReader& from) {
  saved.save(to);
  restored.restore(from);
};

/// Copied byte by byte. An optional has bytes that mean nothing, a pointer means nothing in another process.
template <class T>
concept PlainState =
    std::is_trivially_copyable_v<T> && !std::is_pointer_v<T> && !kIsOptional<T> && !SavesItself<T>;

template <class T>
void putState(const StateWriter& to, std::string_view name, const T& value);
template <class T>
void getState(const StateReader& from, std::string_view name, T& value);

template <class T>
void putList(const StateWriter& to, const std::vector<T>& values) {
  to.put("size", static_cast<std::int64_t>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) putState(to, std::to_string(i), values[i]);
}

template <class T>
void getList(const StateReader& from, std::vector<T>& values) {
  std::int64_t size = 0;
  from.get("size", size);
  if (size < 0) from.refuse("size", std::to_string(size), "0 or more");
  if constexpr (std::is_default_constructible_v<T> && !kIsOwner<T>)
    values.resize(static_cast<std::size_t>(size));
  else if (static_cast<std::size_t>(size) != values.size())
    from.refuse("size", std::to_string(size), std::to_string(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) getState(from, std::to_string(i), values[i]);
}

/// As a list of none or one.
template <class T>
void getOptional(const StateReader& from, std::string_view name, std::optional<T>& value) {
  std::vector<T> list;
  getState(from, name, list);
  if (list.size() > 1) from.refuse(name, std::to_string(list.size()) + " rows", "at most one");
  value.reset();
  if (!list.empty()) value = std::move(list.front());
}

template <class T>
void getArray(const StateReader& from, std::string_view name, Array<T>& array) {
  const std::vector<T> values = from.getAll<T>(name);
  if (array.data() == nullptr) {
    if (values.empty()) return;
    WEIR_CHECK(from.device() != nullptr);
    array = Array<T>(*from.device());
  }
  array.assign(values);
}

template <class T>
void putState(const StateWriter& to, std::string_view name, const T& value) {
  if constexpr (kIsArray<T>)
    to.put(name, value, value.size());
  else if constexpr (kIsOwner<T>)
    putState(to, name, *value);
  else if constexpr (std::is_base_of_v<Stateful, T>)
    value.saveState(to.in(name));
  else if constexpr (SavesItself<T>)
    value.save(to.in(name));
  else if constexpr (kIsOptional<T>)
    putState(to, name,
             value ? std::vector<typename T::value_type>{*value} : std::vector<typename T::value_type>{});
  else if constexpr (std::is_same_v<T, std::string>)
    to.put(name, std::span<const char>(value));
  else if constexpr (kIsVector<T>) {
    static_assert(!std::is_same_v<T, std::vector<bool>>, "a State of flags is a std::vector<char>");
    if constexpr (PlainState<typename T::value_type>)
      to.put(name, std::span<const typename T::value_type>(value));
    else
      putList(to.in(name), value);
  } else {
    static_assert(PlainState<T>,
                  "a State is plain data without pointers, a string, an array on a device, an object with "
                  "save() and restore(), or a vector, optional or unique_ptr of these");
    to.put(name, value);
  }
}

template <class T>
void getState(const StateReader& from, std::string_view name, T& value) {
  if constexpr (kIsArray<T>)
    getArray(from, name, value);
  else if constexpr (kIsOwner<T>)
    getState(from, name, *value);
  else if constexpr (std::is_base_of_v<Stateful, T>)
    value.restoreState(from.in(name));
  else if constexpr (SavesItself<T>)
    value.restore(from.in(name));
  else if constexpr (kIsOptional<T>)
    getOptional(from, name, value);
  else if constexpr (std::is_same_v<T, std::string>) {
    const std::vector<char> text = from.getAll<char>(name);
    value.assign(text.begin(), text.end());
  } else if constexpr (kIsVector<T>) {
    if constexpr (PlainState<typename T::value_type>)
      value = from.getAll<typename T::value_type>(name);
    else
      getList(from.in(name), value);
  } else
    from.get(name, value);
}

}  // namespace detail

/// A declared state. Used as the value itself: `travel_ += way`; members by ->, all else by *.
template <class T>
class State final : public StateMember {
 public:
  State(Stateful& owner, std::string_view name, T initial = {})
      : StateMember(owner, name), value_(std::move(initial)) {}
  State(const State&) = delete;

  const T& get() const { return value_; }
  operator T&() { return value_; }
  operator const T&() const { return value_; }
  T& operator*() { return value_; }
  const T& operator*() const { return value_; }
  T* operator->() { return &value_; }
  const T* operator->() const { return &value_; }
  State& operator=(T value) {
    value_ = std::move(value);
    return *this;
  }
  State& operator=(const State& other) { return *this = other.value_; }

  void save(const StateWriter& to) const override { detail::putState(to, name(), value_); }
  void restore(const StateReader& from) override { detail::getState(from, name(), value_); }

 private:
  T value_;
};

}  // namespace weir
