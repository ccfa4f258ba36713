// Memory: what is estimated before a scene starts is what it comes to, and growing takes little more than the
// end.
#include <gtest/gtest.h>

#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir {
namespace {

using test::SimulatedScene;

struct Variant {
  std::string modules;     // of the fluid
  std::string parameters;  // of the fluid, beside its spacing
  std::string nodes, links;
};

/// A block of 2,000 particles, and an emitter of 20 x 20 that adds 24 layers in 0.24 s.
std::string sceneOf(const Variant& variant) {
  return R"({"weir": 1, "world": {"dt": 0.01, "frame_rate": 25, "duration": 0.24, "gravity": [0, 0, 0]},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.4, 0.1, 0.4]}},
      "nozzle": {"type": "SquareEmitter",
                 "params": {"position": [0.2, 1, 0.2], "width": 0.4, "height": 0.4, "speed": 2}},
      "water": {"type": "ParticleFluid",
                "params": {"spacing": 0.02, "rest_steps": 0)" +
         variant.parameters + R"(}, "modules": {)" + variant.modules + "}}" + variant.nodes +
         R"(},
    "links": ["block.particles -> water.initial", "nozzle.particles -> water.emitters")" +
         variant.links + "]}";
}

void run(SimulatedScene& scene) {
  scene->reset();
  const std::atomic<bool> stop = false;
  while (scene->advanceFrame(stop)) continue;
}

const char* const kSolids =
    R"(, "ball": {"type": "TurningModel", "params": {"profile": [[0, -0.2], [0.2, 0], [0, 0.2]],
                                                     "position": [2, 0, 0]}},
        "box": {"type": "BoxMesh", "params": {"min": [3, 0, 0], "max": [3.1, 0.1, 0.1]}},
        "walls": {"type": "SemiAnalyticalSFI"})";
const char* const kSolidLinks =
    R"(, "water.fluid -> walls.fluid", "ball.surface -> walls.solids", "box.surface -> walls.solids")";
const char* const kBody =
    R"(, "ball": {"type": "TurningModel", "params": {"profile": [[0, -0.2], [0.2, 0], [0, 0.2]],
                                                     "position": [2, 0, 0]}},
        "body": {"type": "RigidBody", "params": {"density": 500}})";
const char* const kBodyLinks = R"(, "water.fluid -> body.fluid", "ball.surface -> body.mesh")";

const std::vector<Variant> kVariants{
    {"", "", "", ""},
    {"", R"(, "support_ratio": 2.4)", "", ""},
    {R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.01, "max_iterations": 3, "acceleration": "nesterov"}})",
     "", "", ""},
    {R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.01, "max_iterations": 3, "acceleration": "nesterov", "step_length": "global"}})",
     "", "", ""},
    {R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": 0.01, "max_iterations": 3, "acceleration": "conjugate"}})",
     "", "", ""},
    {R"("solver": {"type": "Pbf"}, "viscosity": {"params": {"form": "implicit"}})", "", "", ""},
    {R"("solver": {"type": "TwoProjections"})", "", "", ""},
    {R"("viscous": {"type": "ViscositySolver", "after": "walls"})", "", kSolids, kSolidLinks},
    {R"("tension": {"type": "SurfaceTension", "after": "viscosity", "params": {"coefficient": 0.001}},
        "drops": {"type": "CapillaryForce", "after": "viscosity", "params": {"tension": 0.01}},
        "eddies": {"type": "VorticityConfinement", "after": "viscosity"})",
     R"(, "support_ratio": 2)", "", ""},
    {"", "", kSolids, kSolidLinks},
    {R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": null, "max_iterations": 3, "acceleration": "nesterov"}})",
     "", kSolids, kSolidLinks},
    {R"("solver": {"type": "AcceleratedSolver", "params": {"tolerance": null, "max_iterations": 3, "acceleration": "conjugate"}})",
     "", kSolids, kSolidLinks},
    {"", "", kBody, kBodyLinks},
};

TEST(FluidMemory, ComesToWhatIsEstimated) {
  for (const Variant& variant : kVariants) {
    CpuDevice device(2);
    SimulatedScene scene(device, sceneOf(variant), {"world.duration=0.08"});
    run(scene);
    const double estimated = scene->memoryNeeds().device;
    const auto held = static_cast<double>(device.memoryUse().peak);
    EXPECT_LE(held, estimated) << variant.modules << variant.nodes;
    // Trees and grids of solids are bounded, not counted; so are the cells of the grid.
    const double solids = variant.nodes.empty() ? 0 : 40e6;
    EXPECT_GE(held, 0.85 * (estimated - solids)) << variant.modules << variant.nodes;
    // The emitter's last layer may not have left.
    EXPECT_GE(scene->particleCount(), scene->memoryNeeds().particles - 2 * 400);
    EXPECT_LE(scene->particleCount(), scene->memoryNeeds().particles);
  }
}

TEST(FluidMemory, GrowsWithoutASpike) {
  for (const std::string& modules : {kVariants[0].modules, kVariants[8].modules}) {
    CpuDevice device(2);
    // Nobody expects an end, so room is made by and by.
    SimulatedScene scene(device, sceneOf({modules, R"(, "domain_max": [9, 9, 9])", "", ""}),
                         {"world.duration=0.6", "block.max=[0.1, 0.1, 0.1]"});
    run(scene);
    const MemoryUse use = device.memoryUse();
    EXPECT_GT(scene->particleCount(), 20000);
    // That of the final arrays, not of half-filled ones.
    EXPECT_LE(use.peak, 1.02 * static_cast<double>(use.inUse)) << modules;
    EXPECT_LE(use.peakReserved, 1.2 * static_cast<double>(use.inUse)) << modules;
    EXPECT_LE(static_cast<double>(use.reserved), 1.1 * static_cast<double>(use.inUse)) << modules;
  }
}

TEST(FluidMemory, IsNotMadeForMoreParticlesThanThereWillBe) {
  CpuDevice device(2);
  SimulatedScene scene(device, sceneOf({}));
  run(scene);
  const auto& particles = scene.node<ParticleFluid>("water").fluid->set();
  EXPECT_LE(particles.capacity(), scene->memoryNeeds().particles);
}

TEST(FluidMemory, RefusesWhatDoesNotFitBeforeAnythingIsMade) {
  CpuDevice device(2);
  SimulatedScene scene(device, sceneOf({}), {"world.duration=4e4"});
  const Error error = test::errorOf([&] { scene->reset(); });
  EXPECT_EQ(error.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(error.what(), "there are");
  EXPECT_CONTAINS(error.what(), "a spacing of at least");
  EXPECT_LT(device.memoryUse().peak, 1u << 20);
}

TEST(FluidMemory, RefusesMoreParticlesThanCanBeNumbered) {
  CpuDevice device(2);
  // The domain may remove some, but each gets a number of its own.
  SimulatedScene scene(device, sceneOf({"", R"(, "domain_max": [9, 9, 9])", "", ""}), {"world.duration=1e5"});
  const Error error = test::errorOf([&] { scene->reset(); });
  EXPECT_CONTAINS(error.what(), "at most 2147483647");
  EXPECT_CONTAINS(error.what(), "a spacing of at least");
}

TEST(FluidMemory, AFittingSpacingFits) {
  constexpr double kAvailable = 1e9;
  CpuDevice device(2);
  Log silent;
  Registry registry;
  const auto check = [&](double spacing) {
    SimulatedScene scene(device, sceneOf({}), {"water.spacing=" + std::to_string(spacing)});
    const SetupContext setup{.device = device, .log = silent, .registry = registry, .end = 0.24};
    return scene->scene().graph.estimate(setup).check(kAvailable, "cpu");
  };
  const std::string allowed = test::errorOf([&] { check(0.001); }).allowed();
  const std::string before = "a spacing of at least ";
  ASSERT_NE(allowed.find(before), std::string::npos);
  const double fitting = std::stod(allowed.substr(allowed.find(before) + before.size()));
  EXPECT_EQ(check(fitting), "");
  // It is no coarser than it must be.
  EXPECT_THROW(check(0.9 * fitting), Error);
}

TEST(FluidMemory, OfARunThatEndsSoonCountsWhatIsBornByThen) {
  CpuDevice device(2);
  SimulatedScene scene(device, sceneOf({}), {"world.duration=1000"});
  scene->reset(0);
  EXPECT_LE(scene->memoryNeeds().particles, 2000 + 400);
}

using FluidMemoryOn = test::OnDevice;
WEIR_ON_EVERY_DEVICE(FluidMemoryOn);

/// Bytes for each of more than a million particles.
double bytesPerParticle(Device& device, const std::string& solver) {
  SimulatedScene scene(device, R"({"weir": 1, "world": {"dt": 0.001, "frame_rate": 500, "duration": 0.004},
        "nodes": {
          "block": {"type": "BoxSampler",
                    "params": {"min": [0, 0, 0], "max": [1.06, 1.02, 0.99], "arrangement": "lattice"}},
          "tank": {"type": "StaticBoundary",
                   "params": {"shape": "box", "min": [0, 0, 0], "max": [2, 2, 1], "inverted": true}},
          "water": {"type": "ParticleFluid", "params": {"spacing": 0.01, "support_ratio": 1.2},
                    "modules": {"solver": )" +
                                   solver + R"(}}},
        "links": ["block.particles -> water.initial", "tank.boundary -> water.boundaries"]})");
  run(scene);
  const auto particles = static_cast<double>(scene->particleCount());
  EXPECT_GT(particles, ParticleSet::kFew);
  const auto held = static_cast<double>(device.memoryUse().peak);
  EXPECT_LE(held, scene->memoryNeeds().device);
  return held / particles;
}

TEST_P(FluidMemoryOn, ADamBreakOfManyTakesLittleForEach) {
  // Lists of 32-bit indices, and coordinates in columns, make the difference.
  const double plain = device->kind() == DeviceKind::kCuda ? 160 : 235;
  EXPECT_LE(bytesPerParticle(*device, R"({"type": "SemiImplicitSolver"})"), plain);
}

TEST_P(FluidMemoryOn, AToleranceTakesLittleMore) {
  const double plain = bytesPerParticle(*device, R"({"type": "SemiImplicitSolver"})");
  const std::string few = R"({"type": "AcceleratedSolver", "params": {"max_iterations": 3}})";
  EXPECT_LE(bytesPerParticle(*device, few), plain + 70);
}

}  // namespace
}  // namespace weir
