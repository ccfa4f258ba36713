// Scratch memory of particles, lent for the length of a scope:
//
//   const Lease<Vec3f> room = particles.leaseVectors();
//   ... room.view() ...
//
// Nobody else gets the same room in between, and particles can neither be put into another order nor become
// more: that fails a WEIR_CHECK. What is in a room at first means nothing.
#pragma once

#include <memory>
#include <utility>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/particles/version.h"

namespace WEIR_API weir {

namespace detail {

/// Memory that is lent to one at a time.
struct Room {
  bool isLent = false;
  bool isByParticle = false;  // as it is lent
  VersionCounter contents;
};

}  // namespace detail

template <class T>
class Lease {
 public:
  /// Of nothing.
  Lease() = default;
  Lease(Lease&& other) noexcept { swap(other); }
  Lease& operator=(Lease&& other) noexcept {
    Lease(std::move(other)).swap(*this);
    return *this;
  }
  ~Lease() {
    if (room_ != nullptr) room_->isLent = false;
  }

  bool isLent() const { return room_ != nullptr; }
  ArrayView<T> view() const { return array().view(); }
  T* data() const { return array().data(); }
  std::int64_t size() const { return array().size(); }
  /// What stands in the room until it is lent again.
  Version version() const {
    WEIR_CHECK(room_ != nullptr);
    return room_->contents.version();
  }
  /// Changes memory with an array of the same length.
  void swap(Array<T>& other) const {
    WEIR_CHECK(other.size() == size());
    array().swap(other);
  }

 private:
  friend class ParticleSet;
  Lease(std::shared_ptr<detail::Room> room, bool isByParticle, Array<T>& array)
      : room_(std::move(room)), array_(&array) {
    room_->isLent = true;
    room_->isByParticle = isByParticle;
    room_->contents.advance();
  }
  Array<T>& array() const {
    WEIR_CHECK(room_ != nullptr);
    return *array_;
  }
  void swap(Lease& other) noexcept {
    std::swap(room_, other.room_);
    std::swap(array_, other.array_);
  }

  std::shared_ptr<detail::Room> room_;
  Array<T>* array_ = nullptr;
};

}  // namespace weir
