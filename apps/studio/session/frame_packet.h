// Makes packets of a simulation as it stands: its particles for a frame, its meshes once.
#pragma once

#include <cstdint>
#include <string>

#include "apps/studio/session/packet.h"
#include "framework/run/simulation.h"

namespace weir::studio {

/// What viewers want to see of the particles.
struct FrameView {
  std::string attribute = "speed";  ///< that colours them; a vector counts by its length. "none": no values
  std::int64_t most = 200000;       ///< particles of a fluid; of more, those with every n-th id are sent
};

/// A frame, kind "frame". An attribute that a fluid does not have is left out. Waits for the device.
Packet framePacket(const Simulation& simulation, const FrameView& view);

/// The meshes that nodes put out, each in its own frame, and which of them move; kind "geometry".
Packet geometryPacket(const Simulation& simulation);

}  // namespace weir::studio
