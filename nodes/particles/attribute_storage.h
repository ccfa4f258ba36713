// Storage of one particle attribute. Private to ParticleSet.
#pragma once

#include <utility>

#include "nodes/particles/particle_set.h"

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
  /// Room for `size` elements, no more. Keeps the present ones, or sets all to zero if they are derived.
  virtual void grow(std::int64_t size) = 0;
  /// The present elements and room for them in another order, which finishPermutation() makes the present
  /// one.
  virtual PermutedColumn beginPermutation() = 0;
  virtual void finishPermutation() = 0;
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
  TypedStorage(AttributeInfo info, Device& device)
      : AttributeStorage(std::move(info)), values(device), spare_(device) {}

  void grow(std::int64_t size) override {
    // What is given back here makes room for the copy: old and new elements together are no more than the new
    // ones and their spare will be.
    spare_ = Array<T>(values.device());
    if (info().derived) {
      values.resizeDiscarding(size);
      values.fillZero();
    } else {
      values.reserve(size);
      values.resize(size);
    }
  }
  PermutedColumn beginPermutation() override {
    static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
    spare_.resizeDiscarding(values.size());
    return {reinterpret_cast<const std::uint32_t*>(values.data()),
            reinterpret_cast<std::uint32_t*>(spare_.data()), sizeof(T) / sizeof(std::uint32_t)};
  }
  void finishPermutation() override { values.swap(spare_); }
  void zeroBehind(Device& device, const int* count, std::int64_t amount) override {
    dispatch(device, [&](auto& backend) { zeroBehindOn(backend, count, amount); });
  }

  void save(const StateWriter& to, std::int64_t count) const override { to.put(info().name, values, count); }
  void restore(const StateReader& from) override { from.get(info().name, values); }

  Array<T> values;

 private:
  template <class Backend>
  void zeroBehindOn(Backend& device, const int* count, std::int64_t amount);

  Array<T> spare_;
};

}  // namespace weir::detail
