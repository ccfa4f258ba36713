// Makes packets of a simulation as it stands: its particles for a frame, its meshes once.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "apps/studio/session/packet.h"
#include "framework/compute/device.h"
#include "framework/run/simulation.h"

namespace weir::studio {

/// What viewers want to see of the particles.
struct FrameView {
  std::string attribute = "speed";  ///< that colours them; a vector counts by its length. "none": no values
  std::int64_t max = 200000;        ///< particles of a fluid; of more, those with every n-th id are sent
};

/// Makes frames, one after another, in memory that is kept. What viewers get is chosen and brought into 16
/// bits on the device, as the simulation waits meanwhile and most of it need not leave the device then.
class FrameMaker {
 public:
  explicit FrameMaker(Device& device);
  ~FrameMaker();
  FrameMaker(const FrameMaker&) = delete;
  FrameMaker& operator=(const FrameMaker&) = delete;

  /// A frame, kind "frame", of a simulation on the device. An attribute that a fluid does not have is left
  /// out.
  Packet make(const Simulation& simulation, const FrameView& view);

 private:
  class FluidFrame;

  Device& device_;
  PacketWriter writer_;
  std::map<std::string, std::unique_ptr<FluidFrame>> fluids_;  // by their nodes
};

/// The meshes that nodes put out, each in its own frame, and which of them move; kind "geometry".
Packet geometryPacket(const Simulation& simulation);

}  // namespace weir::studio
