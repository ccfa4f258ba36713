// Many bodies on the device, moved on and brought to the host and back together: one kernel and one copy each
// way, whatever their number.
#pragma once

#include <cstdint>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/array.h"
#include "nodes/body_contacts/body_dynamics.h"

namespace WEIR_API weir {

class BodyBatch {
 public:
  /// A body on the device, which must outlive the batch.
  struct Member {
    FreeBody* body = nullptr;
    std::int64_t moves = 0;  ///< whether the batch moves it on; otherwise somebody else has done so
  };
  /// A motion's end, of member k.
  struct Placed {
    std::int64_t k = 0;
    BodyState state;
  };

  BodyBatch(Device& device, const std::vector<Member>& members);

  /// Brings the bodies to where forces lead at the end of a step of `dt` s. Returns from where to where, in
  /// the order of the members. Waits for the device.
  std::vector<BodyDynamics::Motion> moveOn(const Vec3f& gravity, double dt);
  /// Puts those bodies that are held where their motion ends. Returns how many.
  std::int64_t place(const std::vector<BodyDynamics::Motion>& motions);

 private:
  template <class Backend>
  void moveOnOn(Backend& device, const Vec3f& gravity, double dt);
  template <class Backend>
  void placeOn(Backend& device);

  Array<Member> members_;
  Array<BodyDynamics::Motion> motions_;
  Array<Placed> placed_;
};

}  // namespace weir
