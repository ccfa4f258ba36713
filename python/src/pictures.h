// Pictures of a simulation as arrays, by the first plugin that draws.
#pragma once

#include <memory>
#include <optional>

#include "framework/graph/guard.h"
#include "framework/run/live_pictures.h"
#include "framework/run/simulation.h"

namespace weir::python {

class Pictures {
 public:
  /// Throws a usage Error if no plugin draws pictures.
  explicit Pictures(Simulation& simulation);

  /// Of the simulation as it is, which must be up to date (Simulation::refresh). Throws as
  /// LiveRenderer::pixels.
  LivePixels draw(Simulation& simulation, const LivePictureOptions& options);

 private:
  GuardedPart part_;
  std::unique_ptr<LivePictures> pictures_;
  std::unique_ptr<LiveRenderer> renderer_;
  std::unique_ptr<Snapshot> snapshot_;
};

}  // namespace weir::python
