// Finds the packing calibration: which normalisation of the kernel gives rest density to settled fluid at one
// particle per d³.
//
//   weir_packing_curve table [SWEEPS [TILES]]   the table of nodes/particle_fluid/fluid_constants.cpp
//   weir_packing_curve columns [RATIO…]         whether simulated fluid settles to it, and what a lattice
//   loses
//   weir_packing_curve contact [THREADS [RATIO…]]   how near to signed-distance walls particles may come
//   weir_packing_curve factor [THREADS [RATIO…]]    the factor of semi-analytic walls
//
// The table comes from tiles of fluid at rest, see nodes/particles/relaxed_tile.h, which have no walls and no
// surface: s makes their mean density the rest density.
//
// For the check, a block collapses in a tank, splashes and settles, so that the packing that is left is the
// one that motion makes. In its bulk, by a smooth window that is zero near walls and surface, stand n
// particles per d³ at a mean relative density of λ. Gravity is weak, so that the column's own weight does not
// compress it: with support ratios below 1.5 a particle is most of its own density, and a compression of λ by
// one per thousand takes one per cent of the volume.
//
// What walls need comes from the heights at which water rests in tanks of several sizes, see
// tests/support/resting_tanks.h. `contact` prints the table of contactRatio: the fluid at a signed-distance
// wall does not know where the wall is, only how near it may come, so what is missing at the wall now is what
// this distance is too large by. `factor` prints the table of wallFactor: the a between two others at which
// nothing is missing at walls.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <future>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "framework/compute/cpu_threads.h"
#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/particles/relaxed_tile.h"
#include "nodes/register_nodes.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/static_boundary/static_boundary.h"
#include "tests/support/resting_tanks.h"

namespace weir {
namespace {

constexpr double kSpacing = 0.01;                            // m
constexpr double kWidth = 24, kBlockWidth = 12, kTall = 44;  // spacings
constexpr double kMargin = 4;                                // spacings that walls and surface may disturb
constexpr double kStep = 1e-3;                               // s
constexpr double kSeconds = 1.5;
constexpr float kGravity = 2;         // m/s²
constexpr double kBulkModulus = 1e7;  // Pa
constexpr int kIterations = 20;

Value box(double x, double y, double z) {
  return Value::Array{x * kSpacing, y * kSpacing, z * kSpacing};
}

struct Bulk {
  double number = 0;   // particles per d³
  double density = 0;  // mean relative density
};

/// A block of water that has collapsed in a tank for some seconds.
class Column {
 public:
  Column(Device& device, double supportRatio, const char* calibration) : device_(device) {
    registerNodes(registry_);
    auto block = std::make_unique<BoxSampler>();
    block->assignAll(object({{"min", box(0, 0, 0)},
                             {"max", box(kBlockWidth, kTall, kWidth)},
                             {"jitter", 0.3},
                             {"arrangement", "lattice"}}),
                     {});
    graph_.add(std::move(block), "block");
    auto tank = std::make_unique<StaticBoundary>();
    tank->assignAll(
        object(
            {{"shape", "box"}, {"min", box(0, 0, 0)}, {"max", box(kWidth, 100, kWidth)}, {"inverted", true}}),
        {});
    graph_.add(std::move(tank), "tank");
    auto fluid = std::make_unique<ParticleFluid>();
    fluid->assignAll(object({{"spacing", kSpacing},
                             {"support_ratio", supportRatio},
                             {"calibration", calibration},
                             {"bulk_modulus", kBulkModulus}}),
                     {});
    Value solver = object({{"params", object({{"iterations", kIterations}})}});
    fluid->pipeline()->assign(object({{"solver", solver}}), registry_, {});
    fluid_ = static_cast<ParticleFluid*>(&graph_.add(std::move(fluid), "water"));
    graph_.link(SceneGraph::parseLink("block.particles -> water.initial"));
    graph_.link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
  }

  Bulk settle() {
    const Vec3f gravity{0, -kGravity, 0};
    graph_.reset({device_, log_, registry_, gravity, kStep, 1});
    const auto steps = static_cast<std::int64_t>(std::llround(kSeconds / kStep));
    for (std::int64_t k = 0; k < steps; ++k)
      graph_.step({device_, log_, gravity, kStep * double(k), kStep, k});
    graph_.frame({device_, log_, gravity, kSeconds, kStep, steps});
    return measure();
  }

 private:
  static Value object(std::initializer_list<std::pair<const char*, Value>> members) {
    Value v = Value::object();
    for (const auto& [name, value] : members) v[name] = value;
    return v;
  }

  Bulk measure() const {
    const ParticleSet& particles = *fluid_->fluid->particles;
    const std::vector<Vec3f> positions = particles.positions().toHost(particles.bound());
    const std::vector<float> densities = particles.get<float>("density").toHost(particles.bound());
    const double height = kTall * kBlockWidth / kWidth;
    const Vec3d lo{kMargin, kMargin, kMargin}, hi{kWidth - kMargin, height - kMargin, kWidth - kMargin};
    double number = 0, weighted = 0, volume = 1;
    for (int axis = 0; axis < 3; ++axis) volume *= (hi[axis] - lo[axis]) / 2;  // of the mean of 1 - cos
    for (std::size_t i = 0; i < positions.size(); ++i) {
      double weight = 1;
      for (int axis = 0; axis < 3; ++axis) {
        const double t = (double(positions[i][axis]) / kSpacing - lo[axis]) / (hi[axis] - lo[axis]);
        weight *= t > 0 && t < 1 ? 0.5 * (1 - std::cos(2 * std::numbers::pi * t)) : 0;
      }
      number += weight;
      weighted += weight * double(densities[i]) / fluid_->fluid->constants->restDensity;
    }
    return {number / volume, weighted / number};
  }

  Device& device_;
  Log log_;
  Registry registry_;
  SceneGraph graph_;
  ParticleFluid* fluid_;
};

void printTable(int sweeps, int tiles) {
  CpuThreads threads(0);
  constexpr int kSide = 12;
  for (int k = 22; k <= 60; ++k) {
    const double ratio = 0.05 * k;
    double factor = 0;
    for (int seed = 1; seed <= tiles; ++seed)
      factor +=
          calibrationOf(RelaxedTile(ratio, kSide, sweeps, static_cast<std::uint64_t>(seed), threads), ratio) /
          latticeCalibration(ratio) / tiles;
    fmt::print("{{{:.2f}, {:.4f}}},\n", ratio, factor);
    std::fflush(stdout);
  }
}

void printColumns(const std::vector<double>& ratios) {
  CpuDevice device;
  fmt::print(
      "| support ratio | volume, packing | λ - 1 | volume, lattice | λ - 1 |\n|---:|---:|---:|---:|---:|\n");
  for (const double ratio : ratios) {
    const Bulk packing = Column(device, ratio, "packing").settle();
    const Bulk lattice = Column(device, ratio, "lattice").settle();
    fmt::print("| {} | {:.4f} | {:.5f} | {:.4f} | {:.5f} |\n", ratio, 1 / packing.number, packing.density - 1,
               1 / lattice.number, lattice.density - 1);
    std::fflush(stdout);
  }
}

struct Walls {
  double offset = 0, error = 0;  // spacings: of several fillings, the mean and its standard error
};

/// How much too far away walls hold water, from all calibration tanks filled a few times, on so many threads.
Walls restInTanks(const test::TankWater& water, int threads) {
  constexpr int kFillings = 3;
  const std::vector<test::Tank> tanks = test::calibrationTanks();
  std::vector<double> heights(kFillings * tanks.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::future<void>> workers;
  for (int k = 0; k < threads; ++k)
    workers.push_back(std::async(std::launch::async, [&] {
      CpuDevice device(1);
      for (std::size_t i = next++; i < heights.size(); i = next++) {
        test::TankWater filled = water;
        filled.seed = 1 + static_cast<std::int64_t>(i / tanks.size());
        heights[i] = test::restingHeight(device, tanks[i % tanks.size()], filled);
      }
    }));
  for (std::future<void>& worker : workers) worker.get();
  Walls walls;
  double squares = 0;
  for (int filling = 0; filling < kFillings; ++filling) {
    const auto first = heights.begin() + static_cast<std::ptrdiff_t>(tanks.size()) * filling;
    const double offset = test::wallOffset(tanks, {first, first + static_cast<std::ptrdiff_t>(tanks.size())});
    walls.offset += offset / kFillings;
    squares += offset * offset / kFillings;
  }
  walls.error = std::sqrt(std::max(0.0, squares - walls.offset * walls.offset) / (kFillings - 1));
  return walls;
}

void printContact(int threads, const std::vector<double>& ratios) {
  fmt::print("| support ratio | contact | error |\n|---:|---:|---:|\n");
  for (const double ratio : ratios) {
    const Walls walls = restInTanks({.supportRatio = ratio}, threads);
    fmt::print("| {} | {:.3f} | {:.3f} |\n", ratio, contactRatio(ratio, Calibration::kPacking) - walls.offset,
               walls.error);
    std::fflush(stdout);
  }
}

void printFactors(int threads, const std::vector<double>& ratios) {
  constexpr double kLow = 1.0, kHigh = 1.3;
  constexpr double kCalming = 0.3;  // to rest with the factor that it is given then
  fmt::print(
      "| support ratio | missing at walls, a = {} | a = {} | a | error |\n|---:|---:|---:|---:|---:|\n", kLow,
      kHigh);
  for (const double ratio : ratios) {
    const auto with = [&](double a) {
      return restInTanks({.supportRatio = ratio, .mesh = true, .wallFactor = a, .seconds = kCalming},
                         threads);
    };
    const Walls low = with(kLow), high = with(kHigh);
    const double slope = (high.offset - low.offset) / (kHigh - kLow);
    fmt::print("| {} | {:+.4f} | {:+.4f} | {:.3f} | {:.3f} |\n", ratio, low.offset, high.offset,
               kLow - low.offset / slope, std::hypot(low.error, high.error) / std::abs(slope));
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace weir

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const auto number = [&](std::size_t k, int otherwise) {
    return k < words.size() ? std::atoi(words[k].c_str()) : otherwise;
  };
  const auto ratios = [&](std::size_t first, std::vector<double> otherwise) {
    std::vector<double> given;
    for (std::size_t k = first; k < words.size(); ++k) given.push_back(std::atof(words[k].c_str()));
    return given.empty() ? otherwise : given;
  };
  if (!words.empty() && words[0] == "table") {
    weir::printTable(number(1, 400), number(2, 3));
  } else if (!words.empty() && words[0] == "columns") {
    weir::printColumns(ratios(1, {1.2, 1.5, 2.0, 2.4}));
  } else if (!words.empty() && words[0] == "contact") {
    weir::printContact(number(1, 4), ratios(2, {1.2, 1.5, 2.0, 2.4, 3.0}));
  } else if (!words.empty() && words[0] == "factor") {
    weir::printFactors(number(1, 4), ratios(2, {1.2, 1.5, 2.0, 2.4, 3.0}));
  } else {
    fmt::print(stderr,
               "usage: weir_packing_curve table [SWEEPS [TILES]] | columns [RATIO...] | contact [THREADS "
               "[RATIO...]] | factor [THREADS [RATIO...]]\n");
    return 2;
  }
}
