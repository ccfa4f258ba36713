// The CPU and the CUDA back end simulate the same fluid: not bit for bit over a long time, as a splash is
// chaotic, but in what can be measured of it.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/scene/scene_file.h"
#include "tests/support/child_process.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr const char* kLongTank = R"({
  "weir": 1,
  "world": { "dt": 0.001, "duration": 1 },
  "nodes": {
    "block": { "type": "BoxSampler", "params": { "min": [0, 0, 0], "max": [0.4, 0.4, 0.4] } },
    "tank": { "type": "StaticBoundary",
              "params": { "shape": "box", "min": [0, 0, 0], "max": [5, 1, 0.4], "inverted": true } },
    "water": { "type": "ParticleFluid",
               "params": { "spacing": 0.01, "support_ratio": 1.5, "calibration": "lattice", "bulk_modulus": 100000 },
               "modules": { "solver": { "type": "SemiImplicitSolver" } } }
  },
  "links": [ "block.particles -> water.initial", "tank.boundary -> water.boundaries" ]
})";

struct Outcome {
  double front, height, compression, kinetic, potential;
};

Outcome outcomeOn(const std::string& device) {
  const TemporaryFolder folder;
  const std::string stats = folder / "stats.json";
  const ChildResult result =
      runWeir({"run", folder.write("s.json", kLongTank), "--device", device, "--stats", stats, "--quiet"});
  if (result.code != 0) throw std::runtime_error(result.err);
  const Value v = parseJson(readFile(stats), stats);
  const Value& water = *v.find("nodes")->find("water");
  const auto& upper = water.find("bounds")->asArray()[1].asArray();
  return {upper[0].asDouble(), upper[1].asDouble(), water.find("compression")->find("mean")->asDouble(),
          water.find("kinetic_energy")->asDouble(), water.find("potential_energy")->asDouble()};
}

TEST(BackEnds, AgreeOnADamBreakAfterOneSecond) {
  if (availableDevices().size() < 2) GTEST_SKIP() << "there is no CUDA device to compare with";
  const Outcome cpu = outcomeOn("cpu"), cuda = outcomeOn("cuda");
  const auto expectNear = [](const char* what, double a, double b) {
    EXPECT_NEAR(b / a, 1, 0.02) << what << ": " << a << " on the CPU, " << b << " on CUDA";
    std::printf("%s: %.6g on the CPU, %.6g on CUDA (%+.3f %%)\n", what, a, b, 100 * (b / a - 1));
  };
  expectNear("front position [m]", cpu.front, cuda.front);
  expectNear("mean compression", cpu.compression, cuda.compression);
  expectNear("kinetic energy [J]", cpu.kinetic, cuda.kinetic);
  expectNear("potential energy [J]", cpu.potential, cuda.potential);
}

}  // namespace
}  // namespace weir::test
