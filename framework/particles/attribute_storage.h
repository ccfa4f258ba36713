// Storage of one particle attribute. Private to ParticleSet and its handles.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/graph/state.h"
#include "framework/particles/attribute_types.h"
#include "framework/particles/version.h"

namespace WEIR_API weir {
class ParticleSet;
}

namespace weir::detail {

/// In checkpoints, nine numbers in a row.
template <>
constexpr StateElement stateElementOf<Mat3f>() {
  return {StateKind::kFloat, kNumbersIn<Mat3f>};
}

/// Memory into which attributes are brought into another order. Attributes of one type use it one after the
/// other, each leaving what it had to the next, so there are only as many arrays as are filled at a time.
class SpareMemory {
 public:
  /// `size` elements. Where there is no particle they are 0, as in the attributes.
  template <class T>
  Array<T>& get(Device& device, std::size_t index, std::int64_t size) {
    Arrays<T>& arrays = std::get<Arrays<T>>(arrays_);
    while (arrays.size() <= index) arrays.push_back(std::make_unique<Array<T>>(device));
    Array<T>& array = *arrays[index];
    const bool fresh = array.capacity() < size;
    array.resizeDiscarding(size);
    if (fresh) array.fillZero();
    return array;
  }
  void release() { arrays_ = {}; }

 private:
  template <class T>
  using Arrays = std::vector<std::unique_ptr<Array<T>>>;

  AttributeTypes::TupleOf<Arrays> arrays_;
};

/// One attribute's elements, and where they go in another order.
struct PermutedColumn {
  const std::uint32_t* from = nullptr;
  std::uint32_t* to = nullptr;
  int words = 0;  // of 4 bytes, in an element
};

class WEIR_API AttributeStorage {
 public:
  AttributeStorage(ParticleSet& set, AttributeInfo info) : set_(set), info_(std::move(info)) {}
  virtual ~AttributeStorage() = default;
  AttributeStorage(const AttributeStorage&) = delete;
  AttributeStorage& operator=(const AttributeStorage&) = delete;

  const AttributeInfo& info() const { return info_; }
  /// Makes up for a motion of the particles that was put off, for whoever is about to read or write.
  void settle();

  /// Of the elements.
  Version version() const { return elements_.version(); }
  /// Of where elements stand, and which particle's each is.
  Version layout() const { return layout_.version(); }
  /// Somebody is given leave to write.
  void changed() { elements_.advance(); }
  /// Elements are in another place or another order, or not what they were.
  void rearranged() { elements_.advance(), layout_.advance(); }

  /// Room for `size` elements, no more. Keeps the present ones, or sets all to zero if they are derived; new
  /// ones are zero.
  virtual void grow(std::int64_t size) = 0;
  /// The present elements and spare room for them in another order, which finishPermutation() makes the
  /// present one. `spare` numbers the arrays of this type that are in use at the time.
  virtual PermutedColumn beginPermutation(std::size_t spare) = 0;
  virtual void finishPermutation(std::size_t spare) = 0;
  /// All elements as words of 4 bytes, and how many words an element has.
  virtual std::pair<ArrayView<std::uint32_t>, int> words() = 0;
  virtual void save(const StateWriter& to, std::int64_t count) const = 0;
  virtual void restore(const StateReader& from) = 0;

 private:
  ParticleSet& set_;
  AttributeInfo info_;
  VersionCounter elements_, layout_;
};

template <class T>
class WEIR_API TypedStorage final : public AttributeStorage {
 public:
  TypedStorage(ParticleSet& set, AttributeInfo info, Device& device, SpareMemory& spares)
      : AttributeStorage(set, std::move(info)), values(device), spares_(spares) {}

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
    Array<T>& room = spares_.get<T>(values.device(), spare, values.size());
    return {reinterpret_cast<const std::uint32_t*>(values.data()),
            reinterpret_cast<std::uint32_t*>(room.data()), kWords};
  }
  void finishPermutation(std::size_t spare) override {
    values.swap(spares_.get<T>(values.device(), spare, values.size()));
  }
  std::pair<ArrayView<std::uint32_t>, int> words() override {
    return {{reinterpret_cast<std::uint32_t*>(values.data()), kWords * values.size()}, kWords};
  }

  void save(const StateWriter& to, std::int64_t count) const override { to.put(info().name, values, count); }
  void restore(const StateReader& from) override { from.get(info().name, values); }

  Array<T> values;

 private:
  static_assert(sizeof(T) % sizeof(std::uint32_t) == 0);
  static constexpr int kWords = sizeof(T) / sizeof(std::uint32_t);

  SpareMemory& spares_;
};

}  // namespace weir::detail
