// Storage of one particle attribute. Private to ParticleSet.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/particles/particle_set.h"

namespace weir::detail {

template <class T>
constexpr AttributeType attributeTypeOf();
template <>
constexpr AttributeType attributeTypeOf<float>() {
  return AttributeType::kFloat;
}
template <>
constexpr AttributeType attributeTypeOf<Vec3f>() {
  return AttributeType::kVec3;
}
template <>
constexpr AttributeType attributeTypeOf<int>() {
  return AttributeType::kInt;
}

/// Memory into which attributes are brought into another order. Attributes of one type use it one after the
/// other, each leaving what it had to the next, so there are only as many arrays as are filled at a time.
struct SpareMemory {
  template <class T>
  using Arrays = std::vector<std::unique_ptr<Array<T>>>;

  Arrays<Vec3f> vectors;
  Arrays<float> floats;
  Arrays<int> ints;

  template <class T>
  Arrays<T>& of() {
    if constexpr (std::is_same_v<T, Vec3f>)
      return vectors;
    else if constexpr (std::is_same_v<T, float>)
      return floats;
    else
      return ints;
  }
  /// `size` elements. Where there is no particle they are 0, as in the attributes.
  template <class T>
  Array<T>& get(Device& device, std::size_t index, std::int64_t size) {
    Arrays<T>& arrays = of<T>();
    while (arrays.size() <= index) arrays.push_back(std::make_unique<Array<T>>(device));
    Array<T>& array = *arrays[index];
    const bool fresh = array.capacity() < size;
    array.resizeDiscarding(size);
    if (fresh) array.fillZero();
    return array;
  }
  void release() {
    vectors.clear();
    floats.clear();
    ints.clear();
  }
};

/// One attribute's elements, and where they go in another order.
struct PermutedColumn {
  const std::uint32_t* from = nullptr;
  std::uint32_t* to = nullptr;
  int words = 0;  // of 4 bytes, in an element
};

class AttributeStorage {
 public:
  explicit AttributeStorage(AttributeInfo info) : info_(std::move(info)) {}
  virtual ~AttributeStorage() = default;

  const AttributeInfo& info() const { return info_; }
  /// Room for `size` elements, no more. Keeps the present ones, or sets all to zero if they are derived; new
  /// ones are zero.
  virtual void grow(std::int64_t size) = 0;
  /// The present elements and spare room for them in another order, which finishPermutation() makes the
  /// present one. `spare` numbers the arrays of this type that are in use at the time.
  virtual PermutedColumn beginPermutation(std::size_t spare) = 0;
  virtual void finishPermutation(std::size_t spare) = 0;
  /// Sets `amount` elements behind the first `*count` ones to zero.
  virtual void zeroBehind(Device& device, const int* count, std::int64_t amount) = 0;
  virtual void save(const StateWriter& to, std::int64_t count) const = 0;
  virtual void restore(const StateReader& from) = 0;

 private:
  AttributeInfo info_;
};

template <class T>
class TypedStorage final : public AttributeStorage {
 public:
  TypedStorage(AttributeInfo info, Device& device, SpareMemory& spares)
      : AttributeStorage(std::move(info)), values(device), spares_(&spares) {}

  void grow(std::int64_t size) override {
    if (info().derived) {
      values.resizeDiscarding(size);
      values.fillZero();
    } else {
      const std::int64_t present = values.size();
      values.reserve(size);
      values.resize(size);
      values.device().fillBytes(values.data() + present, 0,
                                static_cast<std::size_t>(size - present) * sizeof(T));
    }
  }
  PermutedColumn beginPermutation(std::size_t spare) override {
    static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
    Array<T>& room = spares_->get<T>(values.device(), spare, values.size());
    return {reinterpret_cast<const std::uint32_t*>(values.data()),
            reinterpret_cast<std::uint32_t*>(room.data()), sizeof(T) / sizeof(std::uint32_t)};
  }
  void finishPermutation(std::size_t spare) override {
    values.swap(spares_->get<T>(values.device(), spare, values.size()));
  }
  void zeroBehind(Device& device, const int* count, std::int64_t amount) override {
    dispatch(device, [&](auto& backend) { zeroBehindOn(backend, count, amount); });
  }

  void save(const StateWriter& to, std::int64_t count) const override { to.put(info().name, values, count); }
  void restore(const StateReader& from) override { from.get(info().name, values); }

  Array<T> values;

 private:
  template <class Backend>
  void zeroBehindOn(Backend& device, const int* count, std::int64_t amount);

  SpareMemory* spares_;
};

}  // namespace weir::detail
