// Finds the packing calibration: which normalisation of the kernel gives rest density to settled fluid at one
// particle per d³.
//
//   weir_packing_curve table [SWEEPS [TILES]]   the table of nodes/particle_fluid/fluid_constants.cpp
//   weir_packing_curve columns [RATIO…]         whether simulated fluid settles to it, and what a lattice
//   loses
//   weir_packing_curve offset [THREADS [RATIO…]]    how much too far away signed-distance walls hold water
//   weir_packing_curve factor [THREADS [RATIO…]]    the factor of semi-analytic walls
//
// The last two may end with tolerance=T, the mean compression that the solver leaves (0.001).
//
// The table comes from tiles of fluid at rest, see framework/particles/relaxed_tile.h, which have no walls
// and no surface: s makes their mean density the rest density.
//
// For the check, a block collapses in a tank, splashes and settles, so that the packing that is left is the
// one that motion makes. In its bulk, by a smooth window that is zero near walls and surface, stand n
// particles per d³ at a mean relative density of λ. Gravity is weak, so that the column's own weight does not
// compress it: with support ratios below 1.5 a particle is most of its own density, and a compression of λ by
// one per thousand takes one per cent of the volume.
//
// What walls need comes from the heights at which water rests in tanks of several sizes, see
// tools/calibration/resting_tanks.h. `offset` prints by how much walls of
// StaticBoundary hold the water too far away, which should be next to nothing. `factor` finds what wallFactor
// has a table of: the a at which nothing is missing at walls. Each ratio takes about a minute on four cores.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <future>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/compute/cpu_threads.h"
#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "framework/particles/relaxed_tile.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/static_boundary/static_boundary.h"
#include "tools/calibration/resting_tanks.h"

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
    Value solver =
        object({{"type", "SemiImplicitSolver"}, {"params", object({{"iterations", kIterations}})}});
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
    const ParticleSet& particles = fluid_->fluid->set();
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
      weighted += weight * double(densities[i]) / fluid_->constants().restDensity;
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

struct Measured {
  double value = 0, error = 0;  // the standard error
};

Measured meanOf(const std::vector<double>& values) {
  const auto count = double(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / count;
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return {mean, std::sqrt(squares / (count * (count - 1)))};
}

/// All calibration tanks, filled a few times, as they rest.
class Tanks {
 public:
  Tanks(const test::TankWater& water, std::size_t fillings, int threads)
      : tanks_(test::calibrationTanks()),
        fillings_(fillings),
        water_(fillings * tanks_.size()),
        ratio_(water.supportRatio),
        threads_(threads) {
    each("rests", [&](Water& one, const test::Tank& tank, std::size_t filling) {
      test::TankWater filled = water;
      filled.seed = static_cast<std::int64_t>(filling) + 1;
      one.tank.emplace(one.device, tank, filled);
    });
  }

  void settle(double seconds, std::optional<double> wallFactor = {}) {
    const std::string done =
        wallFactor ? fmt::format("has settled with a = {:.3f}", *wallFactor) : "has settled";
    each(done,
         [&](Water& water, const test::Tank&, std::size_t) { water.tank->settle(seconds, wallFactor); });
  }

  /// The same in each tank by itself, means over its fillings.
  std::vector<double> offsetsOfEach() const {
    std::vector<double> result(tanks_.size());
    for (std::size_t at = 0; at < water_.size(); ++at)
      result[at / fillings_] +=
          test::wallOffset({tanks_[at / fillings_]}, {water_[at].tank->height()}) / fillings_;
    return result;
  }

  /// How much too far away walls hold the water of each filling, in spacings.
  std::vector<double> offsets() const {
    std::vector<double> result;
    for (std::size_t filling = 0; filling < fillings_; ++filling) {
      std::vector<double> heights;
      for (std::size_t k = 0; k < tanks_.size(); ++k)
        heights.push_back(water_[k * fillings_ + filling].tank->height());
      result.push_back(test::wallOffset(tanks_, heights));
    }
    return result;
  }

 private:
  struct Water {
    CpuDevice device{1};
    std::optional<test::RestingTank> tank;
  };

  /// Does it to all of them on some threads, and tells on stderr how far that is.
  void each(const std::string& what, const std::function<void(Water&, const test::Tank&, std::size_t)>& act) {
    std::atomic<std::size_t> next{0}, done{0};
    const auto began = std::chrono::steady_clock::now();
    std::vector<std::future<void>> workers;
    for (int k = 0; k < threads_; ++k)
      workers.push_back(std::async(std::launch::async, [&] {
        for (std::size_t i = next++; i < water_.size(); i = next++) {
          const std::size_t at = water_.size() - 1 - i;  // the large ones, which take longest, first
          const test::Tank& tank = tanks_[at / fillings_];
          act(water_[at], tank, at % fillings_);
          const double seconds =
              std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
          fmt::print(stderr, "{}d: {} of {}, water of {} x {} {}, after {:.0f} s\n", ratio_, ++done,
                     water_.size(), tank.width, tank.height, what, seconds);
        }
      }));
    for (std::future<void>& worker : workers) worker.get();
  }

  std::vector<test::Tank> tanks_;
  std::size_t fillings_;
  std::vector<Water> water_;  // [tank][filling]
  double ratio_;
  int threads_;
};

/// Water that its region no longer holds moves a little, and is at rest again after this.
/// by.
constexpr double kSettling = 0.3;  // s

void printOffset(int threads, double tolerance, const std::vector<double>& ratios) {
  fmt::print(
      "| support ratio | too far, at rest (d) | error | settled | error |\n|---:|---:|---:|---:|---:|\n");
  for (const double ratio : ratios) {
    Tanks tanks({.supportRatio = ratio, .tolerance = tolerance}, 3, threads);
    const auto print = [&](const char* end) {
      const Measured offset = meanOf(tanks.offsets());
      fmt::print(" {:+.3f} | {:.3f} |{}", offset.value, offset.error, end);
      std::fflush(stdout);
    };
    fmt::print("| {} |", ratio);
    print("");
    tanks.settle(kSettling);
    print("\n");
  }
}

/// Where the straight line of least squares through (x, y) crosses zero.
double zeroOf(const std::vector<double>& xs, const std::vector<double>& ys) {
  const double meanX = meanOf(xs).value, meanY = meanOf(ys).value;
  double xx = 0, xy = 0;
  for (std::size_t k = 0; k < xs.size(); ++k) {
    xx += (xs[k] - meanX) * (xs[k] - meanX);
    xy += (xs[k] - meanX) * (ys[k] - meanY);
  }
  return meanX - meanY * xx / xy;
}

void printFactors(int threads, double tolerance, const std::vector<double>& ratios) {
  constexpr double kNearby = 0.1, kFar = 0.3;
  fmt::print(
      "| support ratio | a | missing at walls | error | in single tanks |\n|---:|---:|---:|---:|---|\n");
  for (const double ratio : ratios) {
    Tanks tanks({.supportRatio = ratio, .mesh = true, .tolerance = tolerance}, 2, threads);
    std::vector<double> factors, missing;
    std::vector<std::vector<double>> missingOfEach(test::calibrationTanks().size());
    const auto settleWith = [&](double a) {
      tanks.settle(kSettling, a);
      const Measured offset = meanOf(tanks.offsets());
      const std::vector<double> each = tanks.offsetsOfEach();
      factors.push_back(a);
      missing.push_back(offset.value);
      for (std::size_t k = 0; k < each.size(); ++k) missingOfEach[k].push_back(each[k]);
      fmt::print("| {} | {:.3f} | {:+.4f} | {:.4f} | {:+.4f} |\n", ratio, a, offset.value, offset.error,
                 fmt::join(each, ", "));
      std::fflush(stdout);
    };
    const double table = wallKernel(ratio, Calibration::kPacking).factor;
    settleWith(table);
    settleWith(table - kNearby);
    settleWith(std::clamp(zeroOf(factors, missing), table - kFar, table + kFar));
    std::vector<double> zeros;
    for (const std::vector<double>& one : missingOfEach) zeros.push_back(zeroOf(factors, one));
    const auto [min, max] = std::minmax_element(zeros.begin(), zeros.end());
    fmt::print("{}d: a = {:.3f}, in single tanks from {:.3f} to {:.3f}; in the table {:.3f}\n", ratio,
               zeroOf(factors, missing), *min, *max, table);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace weir

int main(int count, char** arguments) {
  std::vector<std::string> words(arguments + 1, arguments + count);
  double tolerance = 1e-3;
  constexpr std::string_view kTolerance = "tolerance=";
  if (!words.empty() && words.back().starts_with(kTolerance)) {
    tolerance = std::atof(words.back().c_str() + kTolerance.size());
    words.pop_back();
  }
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
  } else if (!words.empty() && words[0] == "offset") {
    weir::printOffset(number(1, 4), tolerance, ratios(2, {1.2, 1.5, 2.0, 2.4, 3.0}));
  } else if (!words.empty() && words[0] == "factor") {
    weir::printFactors(number(1, 4), tolerance, ratios(2, {1.5, 2.0, 2.4}));
  } else {
    fmt::print(stderr,
               "usage: weir_packing_curve table [SWEEPS [TILES]] | columns [RATIO...] | offset [THREADS "
               "[RATIO...]] [tolerance=T] | factor [THREADS [RATIO...]] [tolerance=T]\n");
    return 2;
  }
}
