#include "tests/support/fluid_scene.h"

#include <random>

#include "nodes/register_nodes.h"

namespace weir::test {

namespace {

/// The paper's solver, with its few iterations, where a test names none.
Value withSolver(Value modules) {
  if (Value& solver = modules["solver"]; solver.find("type") == nullptr)
    solver["type"] = "SemiImplicitSolver";
  return modules;
}

}  // namespace

FluidScene::FluidScene(Device& device, std::vector<Vec3f> positions, std::vector<Vec3f> velocities,
                       const Value& parameters, const Value& modules)
    : device_(device) {
  registerNodes(registry_);
  auto given = std::make_unique<GivenParticles>();
  given->positions = std::move(positions);
  given->velocities = std::move(velocities);
  given->velocities.resize(given->positions.size());
  graph_.add(std::move(given), "given");
  fluid_ = static_cast<ParticleFluid*>(&graph_.add(std::make_unique<ParticleFluid>(), "water"));
  Value all = parameters;
  if (!all.find("support_ratio")) all["support_ratio"] = 1.5;
  fluid_->assignAll(all, {"test", "", ""});
  fluid_->pipeline()->assign(withSolver(modules), registry_, {"test", "", ""});
  graph_.link(SceneGraph::parseLink("given.particles -> water.initial"));
}

void FluidScene::reset(double dt) {
  dt_ = dt;
  steps_ = 0;
  graph_.reset({device_, log_, registry_, gravity, dt, seed});
}

StepContext FluidScene::context() const {
  return {device_, const_cast<Log&>(log_), gravity, double(steps_) * dt_, dt_, steps_};
}

void FluidScene::step(int steps) {
  for (int k = 0; k < steps; ++k, ++steps_) graph_.step(context());
}

void FluidScene::frame() {
  graph_.frame(context());
}

std::vector<Vec3f> FluidScene::byId(const Attribute<const Vec3f>& values) const {
  ParticleSet& particles = fluid_->fluid->set();
  const std::int64_t n = particles.refreshCount();
  const std::vector<std::int64_t> ids = particles.ids().toHost(n);
  const std::vector<Vec3f> unordered = values.toHost(n);
  std::vector<Vec3f> ordered(unordered.size());
  for (std::size_t k = 0; k < ids.size(); ++k) ordered.at(static_cast<std::size_t>(ids[k])) = unordered[k];
  return ordered;
}

std::vector<Vec3f> FluidScene::positions() const {
  return byId(fluid_->fluid->set().positions());
}

std::vector<Vec3f> FluidScene::velocities() const {
  return byId(fluid_->fluid->set().velocities());
}

NodeReport FluidScene::report() {
  NodeReport report;
  frame();
  fluid_->report(report);
  return report;
}

std::vector<Vec3f> jitteredCube(int n, float spacing, float jitter, unsigned seed, Vec3f corner) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> offset(-jitter, jitter);
  std::vector<Vec3f> positions;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < n; ++z)
        positions.push_back(corner +
                            spacing * Vec3f{x + offset(random), y + offset(random), z + offset(random)});
  return positions;
}

Value object(std::initializer_list<std::pair<const char*, Value>> members) {
  Value v = Value::object();
  for (const auto& [name, value] : members) v[name] = value;
  return v;
}

}  // namespace weir::test
