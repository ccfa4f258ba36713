// What systems of particles put out: their material is the same for all or each particle's own.
#include "framework/particles/particles.h"

#include <gtest/gtest.h>

#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

TEST(Particles, ExistOnceTheyAreAssigned) {
  const auto device = openDevice("cpu", 1);
  Particles particles;
  EXPECT_FALSE(particles.exist());
  ParticleSet set(*device);
  particles.assign(set);
  EXPECT_TRUE(particles.exist());
  EXPECT_EQ(&particles.set(), &set);
}

TEST(Particles, AMaterialIsConstantOrAnAttribute) {
  const auto device = openDevice("cpu", 1);
  ParticleSet set(*device);
  const Attribute<const float> sizes = set.add<float>({"size", AttributeType::kFloat, "m^3", "Volume."});
  set.add<Vec3f>({"color", AttributeType::kVec3, "", "Not a number."});
  Particles particles;
  particles.assign(set);
  particles.material.volume = {.value = 2};
  EXPECT_FALSE(particles.ownValues(particles.material.volume));
  particles.material.volume = {.value = 2, .attribute = "size"};
  EXPECT_TRUE(particles.ownValues(particles.material.volume) == sizes);
  for (const char* wrong : {"sizes", "color"}) {
    particles.material.volume.attribute = wrong;
    const Error error = errorOf([&] { particles.ownValues(particles.material.volume); });
    EXPECT_CONTAINS(error.message(), wrong);
    EXPECT_CONTAINS(error.what(), "size");
  }
}

}  // namespace
}  // namespace weir::test
