// Array<T>: elements on one device, from its pool. ArrayView<T>: the same elements as a kernel sees them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/check.h"
#include "framework/base/host_device.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

/// Pointer and size, for kernels; T may be const.
template <class T>
struct ArrayView {
  T* data = nullptr;
  std::int64_t size = 0;

  WEIR_HD T& operator[](std::int64_t i) const { return data[i]; }
  /// To a view of const elements. A template, because nvcc warns of a plain one where T is const already.
  template <class U>
  requires(std::is_same_v<U, const T> && !std::is_const_v<T>) WEIR_HD operator ArrayView<U>() const {
    return {data, size};
  }
};

/// How long what has outgrown its room of `present` elements becomes: `min`, or a quarter longer than it
/// was.
constexpr std::int64_t grownSize(std::int64_t present, std::int64_t min) {
  return std::max(min, present + present / 4);
}

/// Owns memory on one device. Contents start undefined.
template <class T>
class Array {
  static_assert(std::is_trivially_copyable_v<T>, "arrays are copied bytewise between devices");

 public:
  Array() = default;
  explicit Array(Device& device, std::int64_t size = 0) : device_(&device) { resize(size); }
  Array(Device& device, std::span<const T> values) : device_(&device) { assign(values); }
  ~Array() { free(); }
  Array(Array&& other) noexcept { swap(other); }
  Array& operator=(Array&& other) noexcept {
    swap(other);
    return *this;
  }
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;

  std::int64_t size() const { return size_; }
  std::int64_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  Device& device() const { return *device_; }
  ArrayView<T> view() { return {data_, size_}; }
  ArrayView<const T> view() const { return {data_, size_}; }

  /// Makes room for `capacity` elements and no more; keeps the contents, so both are held for a moment.
  void reserve(std::int64_t capacity) {
    if (capacity <= capacity_) return;
    Array bigger;
    bigger.allocate(device_, capacity);
    bigger.size_ = size_;
    if (size_ > 0) device_->copy(bigger.data_, data_, static_cast<std::size_t>(size_) * sizeof(T));
    swap(bigger);
  }
  /// Keeps the contents. Room grows by at least a quarter, so that a growing simulation allocates rarely.
  void resize(std::int64_t size) {
    WEIR_CHECK(size >= 0);
    if (size > capacity_) reserve(grownSize(capacity_, size));
    size_ = size;
  }
  /// For contents that nobody needs any more: growing copies nothing, never holds both, and takes no more
  /// than is asked for.
  void resizeDiscarding(std::int64_t size) {
    WEIR_CHECK(size >= 0);
    reserveDiscarding(size);
    size_ = size;
  }
  /// Room for `capacity` elements, of which there are none yet if it had to be made.
  void reserveDiscarding(std::int64_t capacity) {
    if (capacity <= capacity_) return;
    free();
    allocate(device_, capacity);
  }

  void assign(std::span<const T> values) {
    resizeDiscarding(static_cast<std::int64_t>(values.size()));
    if (!values.empty()) device_->upload(data_, values.data(), values.size_bytes());
  }
  void fillZero() {
    if (size_ > 0) device_->fillBytes(data_, 0, static_cast<std::size_t>(size_) * sizeof(T));
  }
  /// Waits for the device.
  std::vector<T> toHost() const { return toHost(size_); }
  std::vector<T> toHost(std::int64_t count) const {
    WEIR_CHECK(count <= size_);
    std::vector<T> values(static_cast<std::size_t>(count));
    if (count > 0) device_->download(values.data(), data_, values.size() * sizeof(T));
    return values;
  }

  void swap(Array& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  void allocate(Device* device, std::int64_t capacity) {
    WEIR_CHECK(device != nullptr);
    device_ = device;
    data_ = static_cast<T*>(device->allocate(static_cast<std::size_t>(capacity) * sizeof(T)));
    capacity_ = capacity;
  }
  void free() noexcept {
    if (data_ != nullptr) device_->release(data_, static_cast<std::size_t>(capacity_) * sizeof(T));
    data_ = nullptr, size_ = capacity_ = 0;
  }

  Device* device_ = nullptr;
  T* data_ = nullptr;
  std::int64_t size_ = 0, capacity_ = 0;
};

}  // namespace weir
