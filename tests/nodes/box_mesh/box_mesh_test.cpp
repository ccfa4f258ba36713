#include "nodes/box_mesh/box_mesh.h"

#include <gtest/gtest.h>

#include "framework/graph/registry.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

TEST(BoxMesh, IsAClosedBoxWhereItIsAsked) {
  CpuDevice device;
  const Registry registry;
  Log log([](LogLevel, std::string_view) {});
  BoxMesh box;
  box.assignAll(object({{"size", Value::Array{2, 0.5, 3}},
                        {"position", Value::Array{1, 2, 3}},
                        {"rotation", Value::Array{0, 0, 90}}}),
                {"test", "", ""});
  box.reset({device, log, registry});
  const TriangleMesh& mesh = *box.surface;
  EXPECT_TRUE(diagnose(mesh).good()) << diagnose(mesh).message();
  EXPECT_NEAR(mesh.volume(), 3, 1e-5);
  EXPECT_NEAR(mesh.area(), 2 * (2 * 0.5 + 2 * 3 + 0.5 * 3), 1e-5);
  // Turned about z, it is 0.5 wide and 2 high.
  const Aabb bounds = mesh.bounds();
  EXPECT_LT(length(bounds.lo - Vec3f{0.75f, 1, 1.5f}), 1e-5f);
  EXPECT_LT(length(bounds.hi - Vec3f{1.25f, 3, 4.5f}), 1e-5f);
}

TEST(BoxMesh, RefusesABoxWithoutVolume) {
  BoxMesh box;
  const Error error =
      errorOf([&] { box.assignAll(object({{"size", Value::Array{1, 0, 1}}}), {"test", "", ""}); });
  EXPECT_CONTAINS(error.message(), "size is [1, 0, 1]");
}

}  // namespace
}  // namespace weir::test
