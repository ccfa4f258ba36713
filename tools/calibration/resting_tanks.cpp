#include "tools/calibration/resting_tanks.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "framework/base/check.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/static_boundary/static_boundary.h"

namespace weir::test {

namespace {

constexpr double kSpacing = 0.01, kStep = 2e-3, kBulkModulus = 1e7;  // m, s, Pa
constexpr Vec3f kGravity{0, -9.8f, 0};                               // m/s²

Value members(std::initializer_list<std::pair<const char*, Value>> given) {
  Value v = Value::object();
  for (const auto& [name, value] : given) v[name] = value;
  return v;
}

Value corner(double x, double y, double z) {
  return Value::Array{x * kSpacing, y * kSpacing, z * kSpacing};
}

}  // namespace

std::vector<Tank> calibrationTanks() {
  return {{8, 8}, {8, 16}, {16, 8}, {12, 12}, {16, 16}};
}

RestingTank::RestingTank(Device& device, const Tank& tank, const TankWater& water)
    : device_(device), tank_(tank) {
  registerNodes(registry_);
  const auto add = [&](const char* type, const char* name, const Value& parameters) {
    std::unique_ptr<Node> node = registry_.createNode(type);
    node->assignAll(parameters, {});
    graph_.add(std::move(node), name);
  };
  const double w = tank.width, h = tank.height;
  add("BoxSampler", "block", members({{"min", corner(0, 0, 0)}, {"max", corner(w, h, w)}}));
  const Value low = corner(0, 0, 0), high = corner(w, 6 * h, w);
  if (water.mesh) {
    add("BoxMesh", "tank", members({{"min", low}, {"max", high}}));
    add("SemiAnalyticalSFI", "walls", members({{"fill", "container"}}));
  } else {
    add("StaticBoundary", "tank",
        members({{"shape", "box"}, {"min", low}, {"max", high}, {"inverted", true}}));
  }
  auto made = std::make_unique<ParticleFluid>();
  made->assignAll(
      members({{"spacing", kSpacing}, {"support_ratio", water.supportRatio}, {"bulk_modulus", kBulkModulus}}),
      {});
  const Value solver =
      members({{"type", "AcceleratedSolver"}, {"params", members({{"tolerance", water.tolerance}})}});
  made->pipeline()->assign(members({{"solver", solver}}), registry_, {});
  fluid_ = static_cast<ParticleFluid*>(&graph_.add(std::move(made), "water"));
  graph_.link(SceneGraph::parseLink("block.particles -> water.initial"));
  if (water.mesh) {
    graph_.link(SceneGraph::parseLink("tank.surface -> walls.solids"));
    graph_.link(SceneGraph::parseLink("water.fluid -> walls.fluid"));
  } else {
    graph_.link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
  }
  graph_.reset({device_, log_, registry_, kGravity, kStep, water.seed});
  // The water comes to rest when somebody looks at it.
  graph_.frame({device_, log_, kGravity, 0, kStep, 0});
}

double RestingTank::height() const {
  const ParticleSet& particles = fluid_->fluid->set();
  const std::vector<Vec3f> positions = particles.positions().toHost(particles.bound());
  double sum = 0;
  for (const Vec3f& p : positions) sum += double(p.y) / kSpacing;
  const auto count = double(positions.size());
  return 2 * (sum / count) / (count / (tank_.width * tank_.width));
}

void RestingTank::settle(double seconds, std::optional<double> wallFactor) {
  // No parameter of scenes: it is found here once for all of them.
  auto& constants = const_cast<FluidConstants&>(fluid_->constants());
  const float before = constants.wallFactor;
  constexpr int kFrame = 50;  // the grid follows the fluid at frames
  const std::int64_t begin = steps_, end = steps_ + std::llround(seconds / kStep);
  while (steps_ < end) {
    if (wallFactor) {
      const float share = std::min(1.0f, 2 * float(steps_ + 1 - begin) / float(end - begin));
      constants.wallFactor =
          before + share * (static_cast<float>(*wallFactor) * constants.calibration - before);
    }
    graph_.step({device_, log_, kGravity, kStep * double(steps_), kStep, steps_});
    if (++steps_ % kFrame == 0)
      graph_.frame({device_, log_, kGravity, kStep * double(steps_), kStep, steps_});
  }
}

double wallOffset(const std::vector<Tank>& tanks, const std::vector<double>& heights) {
  WEIR_CHECK(tanks.size() == heights.size());
  double both = 0, squares = 0;
  for (std::size_t k = 0; k < tanks.size(); ++k) {
    const double each = 4.0 / tanks[k].width + 2.0 / tanks[k].height;
    both += each * (heights[k] - 1);
    squares += each * each;
  }
  return both / squares;
}

}  // namespace weir::test
