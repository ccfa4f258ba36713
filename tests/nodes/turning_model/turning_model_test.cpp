// The node: its place in the scene, and what it refuses.
#include "nodes/turning_model/turning_model.h"

#include <gtest/gtest.h>

#include "framework/graph/scene_graph.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

const Value kCylinder = Value::Array{Value::Array{0.5, 0}, Value::Array{0.5, 2}};

TEST(TurningModel, IsPlacedByPositionAndRotation) {
  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  auto& node = static_cast<TurningModel&>(graph.add(std::make_unique<TurningModel>(), "cylinder"));
  node.assignAll(object({{"profile", kCylinder},
                         {"position", Value::Array{1, 2, 3}},
                         {"rotation", Value::Array{0, 0, 90}}}),
                 {});
  graph.reset({*device, log, registry, {}, 1e-3, 1});
  EXPECT_TRUE(diagnose(*node.surface).good());
  const Aabb box = node.surface->bounds();  // its axis runs along -x now
  EXPECT_NEAR(box.lo.x, -1, 1e-6);
  EXPECT_NEAR(box.hi.x, 1, 1e-6);
  EXPECT_NEAR(box.lo.y, 1.5, 1e-6);
  EXPECT_NEAR(box.hi.z, 3.5, 1e-6);
  EXPECT_EQ(node.surface->triangles.size(), 4u * 64);
}

TEST(TurningModel, SaysWhatIsWrong) {
  TurningModel node;
  const auto expect = [&](const Value& parameters, const char* parameter, const char* part) {
    const Error e = errorOf([&] { node.assignAll(parameters, {}); });
    EXPECT_EQ(e.kind(), ErrorKind::kScene);
    EXPECT_EQ(e.location().parameter, parameter);
    EXPECT_CONTAINS(e.what(), part);
  };
  expect(Value::object(), "profile", "no profile");
  // Value, as Clang takes an array in the braces of an array, alone there, for a copy.
  expect(object({{"profile", Value::Array{Value(Value::Array{1, 0})}}}), "profile", "at least 2");
  expect(object({{"profile", Value::Array{Value::Array{1, 0}, Value::Array{-1, 0}}}}), "profile", "negative");
  expect(object({{"profile", kCylinder}, {"thickness", 0.0}}), "thickness", "above 0");
  expect(object({{"profile", kCylinder}, {"thickness", 0.1}, {"caps", true}}), "caps", "one of them");
  expect(object({{"profile", kCylinder}, {"segments", 2}}), "segments", "at least 3");
  Value::Array steps;
  for (int i = 0; i < 5000; ++i) steps.push_back(Value::Array{1, i});
  expect(object({{"profile", steps}, {"segments", 4096}}), "segments", "at most 5000000");
}

}  // namespace
}  // namespace weir::test
