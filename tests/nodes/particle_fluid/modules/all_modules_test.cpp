// What every module of a fluid must keep: no allocation and no waiting within a step, and results that do not
// depend on the number of threads.
#include <gtest/gtest.h>

#include "tests/nodes/particle_fluid/modules/module_test_support.h"

namespace weir::test {
namespace {

/// The fluid's pipeline with Pbf, implicit viscosity and all that can be added behind it.
Value everyModule() {
  return object({{"solver", object({{"type", "Pbf"}})},
                 {"viscosity", object({{"params", object({{"form", "implicit"}})}})},
                 {"viscous", inserted("ViscositySolver", "walls", object({{"viscosity", 5.0}}))},
                 {"tension", inserted("SurfaceTension", "viscosity", object({{"air_pressure", 5.0}}))},
                 {"drops", inserted("CapillaryForce", "tension", object({{"tension", 0.1}}))},
                 {"eddies", inserted("VorticityConfinement", "tension", object({{"strength", 2.0}}))},
                 {"air", inserted("Drag", "eddies", object({{"damping", 0.1}}))}});
}

FluidScene everythingOn(Device& device) {
  const std::vector<Vec3f> positions = jitteredCube(12, 0.01f, 0.2f, 5);
  return {device, positions, randomVelocities(positions.size(), 0.5f, 6), object({{"support_ratio", 2.0}}),
          everyModule()};
}

TEST(AllModules, StepsAllocateNothingAndReadNothingBack) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene = everythingOn(*device);
    scene.reset(1e-3);
    scene.step(3);
    const std::uint64_t allocations = device->memoryUse().allocations;
    const std::uint64_t readbacks = device->blockingReadbacks();
    scene.step(20);
    EXPECT_EQ(device->memoryUse().allocations, allocations) << name;
    EXPECT_EQ(device->blockingReadbacks(), readbacks) << name;
  }
}

TEST(AllModules, CpuIsBitwiseTheSameForAnyNumberOfThreads) {
  std::vector<Vec3f> expected;
  for (const int threads : {1, 3, 4}) {
    CpuDevice device(threads);
    FluidScene scene = everythingOn(device);
    scene.reset(1e-3);
    for (int frame = 0; frame < 3; ++frame) scene.step(10), scene.frame();
    if (expected.empty()) expected = scene.positions();
    EXPECT_EQ(scene.positions(), expected) << threads << " threads";
  }
}

TEST(AllModules, CpuIsBitwiseTheSameForAllItsInstructions) {
  std::vector<Vec3f> expected;
  for (const CpuIsa isa : usableCpuIsas()) {
    CpuDevice device(2, isa);
    FluidScene scene = everythingOn(device);
    scene.reset(1e-3);
    for (int frame = 0; frame < 3; ++frame) scene.step(10), scene.frame();
    if (expected.empty()) expected = scene.positions();
    EXPECT_EQ(scene.positions(), expected) << cpuIsaName(isa);
  }
}

TEST(AllModules, AResetStartsAgain) {
  const auto device = openDevice("cpu");
  FluidScene scene = everythingOn(*device);
  scene.reset(1e-3);
  scene.step(10);
  const std::vector<Vec3f> first = scene.positions();
  scene.reset(1e-3);
  scene.step(10);
  EXPECT_EQ(scene.positions(), first);
}

}  // namespace
}  // namespace weir::test
