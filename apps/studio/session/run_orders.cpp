#include "apps/studio/session/run_orders.h"

#include <algorithm>
#include <utility>

namespace weir::studio {

void RunOrders::addLoad(Load next) {
  serveFirst = serveFirst || std::exchange(serve, false);
  load = std::move(next);
  // What was to be done with the simulation that goes.
  changes.clear();
  pull.reset();
  release = false;
  pause = play = false;
  frames = 0;
}

void RunOrders::addChanges(std::vector<LiveChange> more) {
  for (LiveChange& change : more) {
    const auto same = std::find_if(changes.begin(), changes.end(), [&](const LiveChange& earlier) {
      return earlier.node == change.node && earlier.module == change.module &&
             earlier.parameter == change.parameter;
    });
    if (same != changes.end())
      same->value = std::move(change.value);
    else
      changes.push_back(std::move(change));
  }
}

void RunOrders::addPull(BodyWish wish) {
  pull = std::move(wish);
}

void RunOrders::addRelease() {
  pull.reset();
  release = true;
}

void RunOrders::addPause() {
  pause = true;
  play = false;
  frames = 0;
}

void RunOrders::addPlay() {
  play = true;
  frames = 0;
}

bool RunOrders::empty() const {
  return !serveFirst && !replay && !view && !load && changes.empty() && !release && !pull && !serve &&
         !pause && !play && frames == 0;
}

}  // namespace weir::studio
