#include "nodes/box_mesh/box_mesh.h"

#include <gtest/gtest.h>

#include "framework/graph/scene_graph.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

TEST(BoxMesh, IsClosedFacesOutwardsAndTurnsAboutItsCentre) {
  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  auto& node = static_cast<BoxMesh&>(graph.add(std::make_unique<BoxMesh>(), "box"));
  node.assignAll(object({{"min", Value::Array{1, 2, 3}},
                         {"max", Value::Array{2, 4, 6}},
                         {"rotation", Value::Array{0, 0, 90}}}),
                 {});
  for (int again = 0; again < 2; ++again) graph.reset({*device, log, registry, {}, 1e-3, 1});
  EXPECT_TRUE(diagnose(*node.surface).good()) << diagnose(*node.surface).message();
  EXPECT_EQ(node.surface->triangles.size(), 12u);
  EXPECT_NEAR(node.surface->volume(), 6, 1e-5);
  EXPECT_NEAR(node.surface->area(), 22, 1e-5);
  const Aabb bounds = node.surface->bounds();  // its sides along x and y have changed places
  EXPECT_NEAR(bounds.lo.x, 0.5, 1e-6);
  EXPECT_NEAR(bounds.hi.x, 2.5, 1e-6);
  EXPECT_NEAR(bounds.lo.y, 2.5, 1e-6);
  EXPECT_NEAR(bounds.hi.z, 6, 1e-6);
}

TEST(BoxMesh, SaysThatItHasNoVolume) {
  BoxMesh node;
  const Error e = errorOf([&] { node.assignAll(object({{"max", Value::Array{1, 0, 1}}}), {}); });
  EXPECT_EQ(e.kind(), ErrorKind::kScene);
  EXPECT_EQ(e.location().parameter, "max");
  EXPECT_CONTAINS(e.what(), "1.5 x 0 x 1.5");
}

}  // namespace
}  // namespace weir::test
