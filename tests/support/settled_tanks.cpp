#include "tests/support/settled_tanks.h"

#include <array>
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
constexpr int kRestSteps = 3000;

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
  return {{6, 6}, {6, 12}, {8, 8}, {10, 10}, {12, 6}, {12, 12}};
}

double settledHeight(Device& device, const Tank& tank, const TankWater& water) {
  Registry registry;
  registerNodes(registry);
  SceneGraph graph;
  const auto add = [&](const char* type, const char* name, const Value& parameters) -> Node& {
    std::unique_ptr<Node> node = registry.createNode(type);
    node->assignAll(parameters, {});
    return graph.add(std::move(node), name);
  };
  const double w = tank.width, h = tank.height;
  Value block = members({{"min", corner(0, 0, 0)}, {"max", corner(w, h, w)}});
  if (!water.fresh) {
    block["max"] = corner(w / 2, 2 * h, w);
    block["arrangement"] = "lattice";
    block["jitter"] = water.jitter;
  }
  add("BoxSampler", "block", block);
  const Value low = corner(0, 0, 0), high = corner(w, 6 * h, w);
  if (water.mesh) {
    add("BoxMesh", "tank", members({{"min", low}, {"max", high}}));
    add("SemiAnalyticalSFI", "walls", members({{"fill", "container"}}));
  } else {
    add("StaticBoundary", "tank",
        members({{"shape", "box"}, {"min", low}, {"max", high}, {"inverted", true}}));
  }
  auto made = std::make_unique<ParticleFluid>();
  made->assignAll(members({{"spacing", kSpacing},
                           {"support_ratio", water.supportRatio},
                           {"bulk_modulus", kBulkModulus},
                           {"rest_steps", water.fresh ? kRestSteps : 0}}),
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

WallFit fitWalls(const std::vector<Tank>& tanks, const std::vector<double>& heights) {
  constexpr std::size_t kUnknowns = 3;
  WEIR_CHECK(tanks.size() == heights.size());
  WEIR_CHECK(tanks.size() > kUnknowns);
  using Row = std::array<double, kUnknowns>;
  const auto rowOf = [](const Tank& t) { return Row{1, 4.0 / t.width + 2.0 / t.height, 1.0 / t.height}; };
  // Normal equations, beside them the unit matrix, which elimination makes the inverse.
  std::array<std::array<double, 2 * kUnknowns>, kUnknowns> m{};
  Row right{};
  for (std::size_t i = 0; i < kUnknowns; ++i) m[i][kUnknowns + i] = 1;
  for (std::size_t k = 0; k < tanks.size(); ++k) {
    const Row row = rowOf(tanks[k]);
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      right[i] += row[i] * (heights[k] - 1);
      for (std::size_t j = 0; j < kUnknowns; ++j) m[i][j] += row[i] * row[j];
    }
  }
  for (std::size_t p = 0; p < kUnknowns; ++p) {
    const double pivot = m[p][p];
    for (double& value : m[p]) value /= pivot;
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      if (i == p) continue;
      const double times = m[i][p];
      for (std::size_t j = 0; j < 2 * kUnknowns; ++j) m[i][j] -= times * m[p][j];
    }
  }
  Row found{};
  for (std::size_t i = 0; i < kUnknowns; ++i)
    for (std::size_t j = 0; j < kUnknowns; ++j) found[i] += m[i][kUnknowns + j] * right[j];
  double squares = 0;
  for (std::size_t k = 0; k < tanks.size(); ++k) {
    const Row row = rowOf(tanks[k]);
    double left = heights[k] - 1;
    for (std::size_t i = 0; i < kUnknowns; ++i) left -= row[i] * found[i];
    squares += left * left;
  }
  const double variance = squares / double(tanks.size() - kUnknowns);
  return {found[0], found[1], found[2], std::sqrt(variance * m[1][kUnknowns + 1])};
}

}  // namespace weir::test
