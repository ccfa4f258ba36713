// Finds the packing calibration: which normalisation of the kernel gives rest density to fluid that has
// settled, at one particle per d³. Prints the table of nodes/particle_fluid/fluid_constants.cpp, and how much
// volume either calibration keeps.
//
//   weir_packing_curve [SECONDS [THREADS [RATIO…]]]
//
// A block with jittered particles collapses in a tank, splashes, and settles, so the packing that is left is
// the one that motion makes, not that of the start. In its bulk, by a smooth window that is zero near walls
// and surface, stand n particles per d³ at a mean relative density of λ. The kernel's sum over the same
// arrangement is exactly 1 with s' = s·n/λ for particles of volume d³/n, whose support ratio is R' = R·∛n. So each
// run gives a point (R', s') of the curve, whatever s it was made with, and neither the weight of the column
// nor iterations that have not converged change it. The point is moved to R by its distance to the lattice
// value, which varies slowly with R.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <vector>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/static_boundary/static_boundary.h"

namespace weir {
namespace {

constexpr double kSpacing = 0.01;                           // m
constexpr double kWidth = 24, kBlockWidth = 12, kTall = 44;  // spacings
constexpr double kMargin = 4;                               // spacings that walls and surface may disturb
constexpr double kStep = 1e-3;                              // s

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
    block->assignAll(object({{"min", box(0, 0, 0)}, {"max", box(kBlockWidth, kTall, kWidth)}, {"jitter", 0.3}}), {});
    graph_.add(std::move(block), "block");
    auto tank = std::make_unique<StaticBoundary>();
    tank->assignAll(object({{"shape", "box"}, {"min", box(0, 0, 0)}, {"max", box(kWidth, 100, kWidth)}, {"inverted", true}}), {});
    graph_.add(std::move(tank), "tank");
    auto fluid = std::make_unique<ParticleFluid>();
    fluid->assignAll(
        object({{"spacing", kSpacing}, {"support_ratio", supportRatio}, {"calibration", calibration}}), {});
    Value solver = object({{"params", object({{"iterations", 10}})}});
    fluid->pipeline()->assign(object({{"solver", solver}}), registry_, {});
    fluid_ = static_cast<ParticleFluid*>(&graph_.add(std::move(fluid), "water"));
    graph_.link(SceneGraph::parseLink("block.particles -> water.initial"));
    graph_.link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
  }

  Bulk settle(double seconds) {
    const Vec3f gravity{0, -9.8f, 0};
    graph_.reset({device_, log_, registry_, gravity, kStep, 1});
    const auto steps = static_cast<std::int64_t>(std::llround(seconds / kStep));
    for (std::int64_t k = 0; k < steps; ++k)
      graph_.step({device_, log_, gravity, kStep * double(k), kStep, k});
    graph_.frame({device_, log_, gravity, seconds, kStep, steps});
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

void printPoint(Device& device, double ratio, double seconds) {
  const Bulk packing = Column(device, ratio, "packing").settle(seconds);
  const Bulk lattice = Column(device, ratio, "lattice").settle(seconds);
  const double n = packing.number;
  const double factor = packingCalibration(ratio) * n / packing.density / latticeCalibration(ratio * std::cbrt(n));
  fmt::print("{:.2f}  {:.4f}  {:.4f}  {:.5f}  {:.4f}  {:.4f}\n", ratio, factor, n, packing.density - 1,
             lattice.number, lattice.density - 1);
  std::fflush(stdout);
}

}  // namespace
}  // namespace weir

int main(int count, char** arguments) {
  const double seconds = count > 1 ? std::atof(arguments[1]) : 2;
  weir::CpuDevice device(count > 2 ? std::atoi(arguments[2]) : 0);
  fmt::print("ratio factor  packing: particles per d³, λ - 1   lattice: particles per d³, λ - 1\n");
  std::vector<double> ratios;
  for (int k = 3; k < count; ++k) ratios.push_back(std::atof(arguments[k]));
  if (ratios.empty()) ratios = {1.1, 1.2, 1.3, 1.5, 1.75, 2.0, 2.4, 2.5, 3.0};
  for (const double ratio : ratios) weir::printPoint(device, ratio, seconds);
}
