// Attribute<T>: a handle of an attribute of a ParticleSet, for modules to keep from their reset on.
//
//   heat_ = fluid.particles.add<float>({"heat", AttributeType::kFloat, "J", "What it has lost."});
//   ...
//   parallelFor(device, "cool", count, Cool{heat_.write(), fluid.particles.velocities().read()});
//
// Whoever takes elements says whether they are to be read or written, so others can tell whether what they
// made of them is still true (version.h). A handle outlives every change of the particles; what it gives out
// is for the kernels that are launched next, as the search for neighbours puts particles into another order.
#pragma once

#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/particles/attribute_storage.h"
#include "framework/particles/lease.h"

namespace WEIR_API weir {

/// The elements of an attribute as they stand now. Becomes an ArrayView where a kernel wants one, which fails
/// a WEIR_CHECK if particles have been put into another order, moved or added, or memory has changed hands
/// since they were asked for: ask the handle again.
template <class T>
class AttributeView {
 public:
  AttributeView(ArrayView<T> elements, Version layout) : elements_(elements), layout_(std::move(layout)) {}

  ArrayView<T> view() const {
    const bool particlesAreWhereTheyWere = layout_.isPresent();
    WEIR_CHECK(particlesAreWhereTheyWere);
    return elements_;
  }
  operator ArrayView<T>() const { return view(); }
  operator ArrayView<const T>() const requires(!std::is_const_v<T>) { return view(); }
  T* data() const { return view().data; }
  std::int64_t size() const { return view().size; }

 private:
  ArrayView<T> elements_;
  Version layout_;
};

/// T is one of AttributeTypes, or const one that can only be read.
template <class T>
class Attribute {
 public:
  using Element = std::remove_const_t<T>;

  /// Of nothing.
  Attribute() = default;
  template <class U>
  requires(std::is_same_v<T, const U> && !std::is_const_v<U>) Attribute(const Attribute<U>& other)
      : storage_(other.storage_) {}

  /// Whether there is such an attribute, of particles that are still there. All else fails a WEIR_CHECK if
  /// not.
  explicit operator bool() const { return !storage_.expired(); }
  friend bool operator==(const Attribute& a, const Attribute& b) {
    return a.storage_.lock() == b.storage_.lock();
  }

  AttributeView<const Element> read() const {
    const auto storage = settled();
    return {std::as_const(storage->values).view(), storage->layout()};
  }
  AttributeView<Element> write() const requires(!std::is_const_v<T>) {
    const auto storage = settled();
    storage->changed();
    return {storage->values.view(), storage->layout()};
  }
  void fillZero() const requires(!std::is_const_v<T>) {
    const auto storage = settled();
    storage->changed();
    storage->values.fillZero();
  }
  /// Sets the first elements, from the host.
  void assign(std::span<const Element> elements) const requires(!std::is_const_v<T>) {
    const auto storage = settled();
    WEIR_CHECK(static_cast<std::int64_t>(elements.size()) <= storage->values.size());
    storage->changed();
    if (!elements.empty())
      storage->values.device().upload(storage->values.data(), elements.data(), elements.size_bytes());
  }
  /// Takes what is in the room for all elements, and leaves them there: memory changes hands.
  void swap(const Lease<Element>& room) const requires(!std::is_const_v<T>) {
    const auto storage = settled();
    storage->rearranged();
    room.swap(storage->values);
  }
  /// The first `count` elements; waits for the device.
  std::vector<Element> toHost(std::int64_t count) const { return settled()->values.toHost(count); }

  /// How many elements there is room for.
  std::int64_t size() const { return there()->values.size(); }
  Device& device() const { return there()->values.device(); }
  const AttributeInfo& info() const { return there()->info(); }
  /// Of the elements; no longer present as soon as somebody has been given leave to write, or particles have
  /// been moved, added or put into another order.
  Version version() const { return there()->version(); }

 private:
  friend class ParticleSet;
  template <class>
  friend class Attribute;
  using Storage = detail::TypedStorage<Element>;
  explicit Attribute(std::weak_ptr<Storage> storage) : storage_(std::move(storage)) {}

  std::shared_ptr<Storage> there() const {
    std::shared_ptr<Storage> attributeOfPresentParticles = storage_.lock();
    WEIR_CHECK(attributeOfPresentParticles);
    return attributeOfPresentParticles;
  }
  std::shared_ptr<Storage> settled() const {
    std::shared_ptr<Storage> storage = there();
    storage->settle();
    return storage;
  }

  std::weak_ptr<Storage> storage_;
};

}  // namespace weir
