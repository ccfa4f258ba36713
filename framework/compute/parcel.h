// Bytes on their way from one device to another, which may be the same one.
//
//   Parcel parcel(std::move(packed));       // an array of the sender's, after what it was asked for so far
//   ...                                     // on the thread of the reader:
//   parcel.copyTo(device, arrived.data());
//
// The host waits for neither. Between two GPUs of a machine bytes go directly, where the machine can do that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "framework/compute/frame_copy.h"

namespace WEIR_API weir {

class Parcel {
 public:
  Parcel() = default;
  /// Takes the array over, whose device must outlive the parcel.
  explicit Parcel(Array<std::byte> bytes);

  std::int64_t size() const { return bytes_.size(); }
  /// On the thread of the sender; waits for its device.
  std::vector<std::byte> toHost() const { return bytes_.toHost(); }
  /// The same array, in the order of its device's work.
  Array<std::byte> release() && { return std::move(bytes_); }
  /// Writes all bytes to memory of a device, in the order of its work. The parcel must stay until that is
  /// done.
  void copyTo(Device& reader, void* to) const;

 private:
  Array<std::byte> bytes_;
  std::unique_ptr<detail::Moment> ready_;  // when its device has written them
};

}  // namespace weir
