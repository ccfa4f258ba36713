// Whether a run that is resumed goes on as if it had never ended: for the tests of whoever writes nodes and
// modules. It finds what no State declares, as that is missing in the resumed run.
//
//   const auto make = [&] { return std::make_unique<Simulation>(sceneOfTheTest(), device, log, registry); };
//   EXPECT_EQ(resumeDifferences(make), std::vector<std::string>{});
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/simulation.h"

namespace WEIR_API weir {

struct ResumeCheck {
  std::int64_t savedAt = 3;      ///< frame
  std::int64_t comparedFor = 3;  ///< frames after that
  /// Writes what else is compared, such as outputs of nodes. Called at each of these frames.
  std::function<void(Simulation&, const StateWriter&)> observe;
};

/// Runs a simulation, saves it at a frame, and lets another one go on from there. Compares both at the next
/// frames, as nobody looks before that, bit by bit: the states of all nodes and modules with the attributes
/// of all particles, and what nodes and modules report. Returns what differs at the first frame where
/// anything does, by name; empty if nothing does. `make` gives a new simulation of the same scene at each
/// call, which lasts for the frames.
std::vector<std::string> resumeDifferences(const std::function<std::unique_ptr<Simulation>()>& make,
                                           const ResumeCheck& check = {});

}  // namespace weir
