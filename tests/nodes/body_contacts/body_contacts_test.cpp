// What is refused where no plugin holds bodies; tests/plugins/bodies has what one does.
#include "nodes/body_contacts/body_contacts.h"

#include <gtest/gtest.h>

#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

TEST(BodyContacts, AreRefusedWithoutALibrary) {
  const auto device = openDevice("cpu");
  const std::string refusal = errorOf([&] {
                                SimulatedScene scene(*device, R"({"weir": 1, "nodes": {
      "box": {"type": "BoxMesh"}, "body": {"type": "RigidBody", "params": {"density": 500}},
      "contacts": {"type": "BodyContacts"}},
      "links": ["box.surface -> body.mesh", "body.body -> contacts.bodies"]})");
                                scene->reset();
                              }).what();
  EXPECT_CONTAINS(refusal, "node 'contacts': no plugin that holds bodies is loaded, so they cannot collide");
  EXPECT_CONTAINS(refusal, "build Weir with Bullet");
}

}  // namespace
}  // namespace weir::test
