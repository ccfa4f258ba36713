// What a simulation was told to do and has not done yet. An order takes the place of those that it makes
// void, so what waits stays small, however many come.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/studio/session/body_pull.h"
#include "apps/studio/session/frame_packet.h"
#include "apps/studio/session/scene_check.h"

namespace weir::studio {

/// Done in the order of the members.
struct RunOrders {
  struct Load {
    std::unique_ptr<Scene> scene;
    std::string device;
    std::unique_ptr<Scene> again = {};  ///< once more, for those who look back
    /// To go on from this frame of the run that is there, or the last one before it that is kept; none: from
    /// time 0.
    std::optional<std::int64_t> from = {};
  };

  bool serveFirst = false;  ///< the simulation that is there is to be shown to those who asked, see serve
  bool replay = false;      ///< the run that is there
  std::optional<FrameView> view;
  std::optional<Load> load;
  std::vector<LiveChange> changes;
  bool release = false;  ///< what is pulled
  std::optional<BodyWish> pull;
  bool serve = false;
  bool pause = false, play = false;
  std::int64_t frames = 0;  ///< to advance by

  void addLoad(Load next);
  void addChanges(std::vector<LiveChange> more);
  void addPull(BodyWish wish);
  void addRelease();
  void addPause();
  void addPlay();
  bool empty() const;
};

}  // namespace weir::studio
