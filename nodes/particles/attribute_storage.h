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

class AttributeStorage {
 public:
  explicit AttributeStorage(AttributeInfo info) : info_(std::move(info)) {}
  virtual ~AttributeStorage() = default;

  const AttributeInfo& info() const { return info_; }
  virtual void resize(std::int64_t size) = 0;
  /// Element order[k] becomes element k, for k < count.
  virtual void permute(Device& device, Count count, ArrayView<const int> order) = 0;
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
  void permute(Device& device, Count count, ArrayView<const int> order) override {
    dispatch(device, [&](auto& backend) { permuteOn(backend, count, order); });
  }
  void zeroBehind(Device& device, const int* count, std::int64_t amount) override {
    dispatch(device, [&](auto& backend) { zeroBehindOn(backend, count, amount); });
  }

  Array<T> values;

 private:
  template <class Backend>
  void permuteOn(Backend& device, Count count, ArrayView<const int> order);
  template <class Backend>
  void zeroBehindOn(Backend& device, const int* count, std::int64_t amount);

  Array<T> spare_;
};

}  // namespace weir::detail
