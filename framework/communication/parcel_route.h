// The role of communicators that have more than one way for parcels, such as straight from GPU to GPU.
#pragma once

#include <memory>
#include <string>

#include "framework/base/api.h"
#include "framework/compute/device.h"

namespace WEIR_API weir {

/// The way that parcels of a device take while it lives. Must go before the device, and before what waits for
/// the device when it goes.
class ParcelRoute {
 public:
  /// Where end() was not called, since an error travels, what is on its way is given up.
  virtual ~ParcelRoute() = default;
  /// Which way that is, and why: the end of a sentence, for the log.
  virtual std::string description() const = 0;
  /// Until all have arrived. All ranks take part.
  virtual void end() = 0;
};

class ParcelRoutes {
 public:
  virtual ~ParcelRoutes() = default;
  /// All ranks take part, each with the device of all its parcels, before the first of them; all get the same
  /// way. Null on CPUs.
  virtual std::unique_ptr<ParcelRoute> openRoute(Device& device) = 0;
};

}  // namespace weir
