#include "nodes/particle_fluid/particle_limit.h"

#include <fmt/format.h>

#include "framework/base/error.h"

namespace weir {

void checkParticleCount(const ParticleOutlook& outlook,
                        const std::function<std::string(double share)>& remedy) {
  constexpr double kMax = 2147483647, kMaxOfRanks = 4294967296;
  const std::string many = fmt::format("at a spacing of {:.4g} m the fluid would get {:.4g} particles",
                                       outlook.spacing, outlook.all);
  const auto check = [&](double count, double max, const std::string& what, const std::string& allowed,
                         const std::string& more) {
    if (!(count <= max))
      throw sceneError(many + what, fmt::format("at most {:.0f}", max) + allowed, remedy(max / count) + more);
  };
  if (outlook.ranks == 0) return check(outlook.all, kMax, "", "", "");
  check(outlook.onRank, kMax,
        fmt::format(", and each of {} ranks up to {:.4g} with copies of others'", outlook.ranks,
                    outlook.onRank),
        " on a rank", ", or more ranks");
  check(outlook.all, kMaxOfRanks, "", " of all ranks, as their sums have room for no more", "");
  if (outlook.gathered)
    check(outlook.all, kMax, ", which the first rank would gather", " where it does",
          ", or a run without what gathers them, as pictures and exports but those by rank do");
}

}  // namespace weir
