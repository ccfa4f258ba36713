#include "tests/nodes/particle_fluid/modules/module_test_support.h"

#include <random>

namespace weir::test {

Vec3d toDouble(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

std::vector<Vec3f> randomVelocities(std::size_t count, float max, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> component(-max, max);
  std::vector<Vec3f> velocities(count);
  for (Vec3f& v : velocities) v = {component(random), component(random), component(random)};
  return velocities;
}

double largestDifference(const std::vector<Vec3f>& found, const std::vector<Vec3d>& expected) {
  double largest = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    largest = std::max(largest, length(toDouble(found.at(i)) - expected[i]));
  return largest;
}

Vec3d sumOf(const std::vector<Vec3f>& vectors) {
  Vec3d sum{};
  for (const Vec3f& v : vectors) sum += toDouble(v);
  return sum;
}

ReferenceFluid referenceWith(ReferenceFluid settings, const std::vector<Vec3f>& positions,
                             const std::vector<Vec3f>& velocities) {
  for (const Vec3f& p : positions) settings.positions.push_back(toDouble(p));
  for (const Vec3f& v : velocities) settings.velocities.push_back(toDouble(v));
  return settings;
}

Value inserted(const char* type, const char* after, Value params) {
  return object({{"type", type}, {"after", after}, {"params", std::move(params)}});
}

Value disabled() {
  return object({{"enabled", false}});
}

}  // namespace weir::test
