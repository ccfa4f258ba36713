#include "tests/support/resting_tanks.h"

#include <cmath>
#include <memory>

#include "framework/base/check.h"
#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/static_boundary/static_boundary.h"

namespace weir::test {

namespace {

constexpr double kSpacing = 0.01, kStep = 2e-3, kBulkModulus = 1e7;  // m, s, Pa
constexpr float kGravity = 9.8f;                                     // m/s²

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
  return {{8, 8}, {8, 16}, {16, 8}, {12, 12}, {16, 16}, {20, 20}};
}

double restingHeight(Device& device, const Tank& tank, const TankWater& water) {
  Registry registry;
  registerNodes(registry);
  SceneGraph graph;
  const auto add = [&](const char* type, const char* name, const Value& parameters) -> Node& {
    std::unique_ptr<Node> node = registry.createNode(type);
    node->assignAll(parameters, {});
    return graph.add(std::move(node), name);
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
  const Value solver = members({{"tolerance", 1e-3}, {"iterations", 1000}, {"acceleration", "nesterov"}});
  made->pipeline()->assign(members({{"solver", members({{"params", solver}})}}), registry, {});
  auto& fluid = static_cast<ParticleFluid&>(graph.add(std::move(made), "water"));
  graph.link(SceneGraph::parseLink("block.particles -> water.initial"));
  if (water.mesh) {
    graph.link(SceneGraph::parseLink("tank.surface -> walls.solids"));
    graph.link(SceneGraph::parseLink("water.fluid -> walls.fluid"));
  } else {
    graph.link(SceneGraph::parseLink("tank.boundary -> water.boundaries"));
  }

  Log log;
  const Vec3f gravity{0, -kGravity, 0};
  graph.reset({device, log, registry, gravity, kStep, water.seed});
  if (water.wallFactor) {
    // No parameter of scenes: it is found here once for all of them.
    auto& constants = const_cast<FluidConstants&>(*fluid.fluid->constants);
    constants.wallFactor = static_cast<float>(*water.wallFactor) * constants.calibration;
  }
  const auto steps = static_cast<std::int64_t>(std::llround(water.seconds / kStep));
  constexpr int kFrame = 50;  // the grid follows the fluid at frames
  for (std::int64_t k = 0; k < steps; ++k) {
    graph.step({device, log, gravity, kStep * double(k), kStep, k});
    if (k % kFrame == kFrame - 1) graph.frame({device, log, gravity, kStep * double(k + 1), kStep, k + 1});
  }
  const ParticleSet& particles = *fluid.fluid->particles;
  const std::vector<Vec3f> positions = particles.positions().toHost(particles.bound());
  double sum = 0;
  for (const Vec3f& p : positions) sum += double(p.y) / kSpacing;
  const auto count = double(positions.size());
  return 2 * (sum / count) / (count / (w * w));
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
