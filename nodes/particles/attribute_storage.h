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
  virtual void resize(std::int64_t size) = 0;
  /// The present elements and room for them in another order, which finishPermutation() makes the present
  /// one.
  virtual PermutedColumn beginPermutation() = 0;
  virtual void finishPermutation() = 0;
  /// Sets `amount` elements behind the first `*count` ones to zero.
  virtual void zeroBehind(Device& device, const int* count, std::int64_t amount) = 0;

 private:
  AttributeInfo info_;
};

template <class T>
class TypedStorage final : public AttributeStorage {
 public:
  TypedStorage(AttributeInfo info, Device& device)
      : AttributeStorage(std::move(info)), values(device), spare_(device) {}

  void resize(std::int64_t size) override { values.resize(size); }
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

  Array<T> values;

 private:
  template <class Backend>
  void zeroBehindOn(Backend& device, const int* count, std::int64_t amount);

  Array<T> spare_;
};

}  // namespace weir::detail
