// What a picture shows of the particles of one fluid, in memory of the device that draws.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "framework/compute/array.h"
#include "plugins/views/device_output.h"
#include "plugins/views/frame_kernels.h"
#include "plugins/views/lone_particles.h"
#include "plugins/views/render_settings.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/view.h"

namespace weir::rendering {

std::vector<Cut> cutsOf(const GroupList<ClipSettings>& clips);
/// Whether no cut hides a place.
bool isShown(std::span<const Cut> cuts, const Vec3f& place);

/// What it gives is good until the next load(), as long as the snapshot holds the same frame.
class ShownParticles {
 public:
  /// No other thread may use the device. It must be of the hardware that the frame comes from.
  explicit ShownParticles(Device& device) : device_(device) {}

  /// Takes the particles of a frame. With `foamEnds`, the numbers that colour them become parts of foam: 0 at
  /// the first end, 1 at the second.
  void load(FluidSnapshot& fluid, const std::optional<Vec2f>& foamEnds);
  /// Leaves those alone that all cuts show.
  void cut(std::span<const Cut> cuts);
  /// Gives those that are lone, in fluid of this spacing (m), to `spray`, as white water without radii.
  void giveLone(float spacing, ShownParticles& spray);

  // These wait for the device.

  /// The box around all finite places.
  Aabb box();
  /// The least and the largest number that is finite; {inf, -inf} without any.
  Vec2f range();
  /// The mean of all finite places, if there are any.
  std::optional<Vec3f> middle();

  /// Lets a view have places and numbers: those in the device's memory, or on the host.
  void give(ParticleView& view, bool onDevice);
  /// Of white water, the kind (WhiteKind) of each particle, on the host; empty if they are not known.
  std::span<const int> kinds() { return kindsOnHost_.of(kinds_); }

 private:
  template <class T>
  T found(const Array<T>& result) const;
  ArrayView<float> roomForValues(std::int64_t count);
  void loadRadii(FluidSnapshot& fluid);
  void keep(ArrayView<const int> chosen);
  template <class T>
  void keepOf(ArrayView<const int> chosen, ArrayView<const T>& elements, std::array<Array<T>, 2>& rooms);

  Device& device_;
  ArrayView<const Vec3f> positions_;
  ArrayView<const float> values_;  // radii of white water
  ArrayView<const int> kinds_;
  bool isWhite_ = false;
  ArrayView<const Vec3f> velocities_;  // none where they are not captured
  // For a frame that the device had no room for.
  Array<Vec3f> positionRoom_{device_}, velocityRoom_{device_};
  AttributeTypes::TupleOf<Array> numberRooms_{AttributeTypes::makeTuple<Array>(device_)};
  Array<float> made_{device_};  // numbers that no attribute holds as they are
  Array<Cut> cuts_{device_};
  Array<int> chosen_{device_}, kept_{device_, 1};
  LoneParticles lone_{device_};
  template <class T>
  static std::array<Array<T>, 2> twoOf(Device& device) {
    return {Array<T>(device), Array<T>(device)};
  }
  // What is kept of what has been kept is in the other one of two.
  std::array<Array<Vec3f>, 2> keptPositions_{twoOf<Vec3f>(device_)}, keptVelocities_{twoOf<Vec3f>(device_)};
  std::array<Array<float>, 2> keptValues_{twoOf<float>(device_)};
  std::array<Array<int>, 2> keptKinds_{twoOf<int>(device_)};
  Array<Aabb> box_{device_, 1};
  Array<Vec2f> range_{device_, 1};
  Array<PlacesSum> sum_{device_, 1};
  DeviceOutput<Vec3f> positionsOnHost_{device_}, velocitiesOnHost_{device_};
  DeviceOutput<float> valuesOnHost_{device_};
  DeviceOutput<int> kindsOnHost_{device_};
};

}  // namespace weir::rendering
