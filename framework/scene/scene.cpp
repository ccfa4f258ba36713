#include "framework/scene/scene.h"

#include <fmt/format.h>

namespace weir {

void World::validate() const {
  if (!minDt.get()) return;
  if (!cfl.get())
    throw sceneError("min_dt is given, which means nothing without cfl", "cfl beside it, or no min_dt")
        .inParameter(minDt.name());
  if (*minDt.get() > dt)
    throw sceneError(fmt::format("the shortest step of {} s is longer than the longest one of {} s",
                                 *minDt.get(), dt.get()),
                     "a min_dt that is not above dt")
        .inParameter(minDt.name());
}

}  // namespace weir
