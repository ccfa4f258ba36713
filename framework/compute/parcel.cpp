#include "framework/compute/parcel.h"

#include <utility>

#include "framework/compute/cuda_support.h"

namespace weir {

Parcel::Parcel(Array<std::byte> bytes) : bytes_(std::move(bytes)) {
  if (bytes_.empty()) return;
  ready_ = detail::makeMoment(bytes_.device());
  ready_->set();
}

void Parcel::copyTo(Device& reader, void* to) const {
  if (bytes_.empty()) return;
  Device& sender = bytes_.device();
  const bool areAlike = sender.kind() == reader.kind();
  WEIR_CHECK(areAlike);
  ready_->letWait(reader);
  const auto bytes = static_cast<std::size_t>(size());
  if (reader.kind() == DeviceKind::kCuda)
    detail::copyBetween(static_cast<CudaDevice&>(reader), to, static_cast<const CudaDevice&>(sender),
                        bytes_.data(), bytes);
  else
    reader.copy(to, bytes_.data(), bytes);
}

}  // namespace weir
