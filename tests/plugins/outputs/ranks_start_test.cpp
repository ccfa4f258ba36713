// How a run with ranks starts: each samples a share of the particles, and takes what belongs to it.
#include <fstream>

#include "tests/plugins/outputs/ranks_run.h"

namespace weir::test {
namespace {

/// A relaxed block that comes to rest, a drop on a lattice and particles of a file, which are held meanwhile.
constexpr const char* kHeld = R"({
  "weir": 1,
  "world": { "dt": 0.004, "frame_rate": 30 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [1.2, 0.5, 1] } },
    "drop": { "type": "SphereSampler",
              "params": { "center": [0.6, 1, 0.5], "radius": 0.3, "arrangement": "lattice", "velocity": [0, -1, 0] } },
    "few": { "type": "ParticleFile", "params": { "file": "few.csv" } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [1.2, 2, 1], "inverted": true } },
    "water": { "type": "ParticleFluid", "params": { "spacing": 0.03, "rest_steps": 40 } }
  },
  "links": ["block.particles -> water.initial", "drop.particles -> water.initial",
            "few.particles -> water.initial", "tank.boundary -> water.boundaries"]
})";

TEST_F(RanksTest, WhatIsHeldBesideWhatComesToRestIsTheSameForAnyNumber) {
  // 22,222 nodes are two chunks, so that ranks share them.
  std::ofstream(folder_ / "few.csv") << "x,y,z,vx,vy,vz\n0.2,1.5,0.3,1,0,0\n0.9,1.6,0.8,0,0,-1\n";
  scene_ = folder_.write("held.json", kHeld);
  duration_ = "0.34";
  rest_.clear();
  expectSameForAnyNumber({"water.solver.type=SemiImplicitSolver"}, {"2", "3"});
}

}  // namespace
}  // namespace weir::test
