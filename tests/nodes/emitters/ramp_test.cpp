// Emitters whose parameters move over time.
#include <gtest/gtest.h>

#include <cmath>

#include "nodes/emitters/circle_emitter.h"
#include "nodes/emitters/square_emitter.h"
#include "tests/nodes/emitters/jet.h"

namespace weir::test {
namespace {

Value keyframes(std::initializer_list<Value> keys) {
  return object({{"keyframes", Value::Array(keys)}});
}
Value key(double time, Value value) {
  return Value::Array{time, std::move(value)};
}

TEST(MovingEmitter, ARampGivesTheExactIntegralOfTheFlux) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    // From 0.5 m/s at 0.1 s to 3 m/s at 0.3 s, back to 1 m/s at 0.35 s: none of these times is a step's.
    const Value speed = keyframes({key(0.1, 0.5), key(0.3, 3.0), key(0.35, 1.0)});
    for (const auto& [dt, steps] : {std::pair{1.3e-3, 400}, {0.017, 30}, {0.11, 5}}) {
      Jet<SquareEmitter> jet(
          *device, 0.01f,
          object({{"width", 0.02}, {"height", 0.03}, {"speed", speed}, {"start", 0.03}, {"stop", 0.42}}));
      const double travel =
          0.5 * (0.1 - 0.03) + 0.5 * (0.5 + 3.0) * 0.2 + 0.5 * (3.0 + 1.0) * 0.05 + 1.0 * (0.42 - 0.35);
      EXPECT_EQ(double(jet.after(dt, steps).size()), 6 * std::ceil(travel / 0.01)) << name << " dt " << dt;
    }
  }
}

TEST(MovingEmitter, LayersOfAStepStayASpacingApart) {
  const auto device = openDevice("cpu");
  Jet<SquareEmitter> jet(
      *device, 0.01f,
      object({{"width", 0.01}, {"height", 0.01}, {"speed", keyframes({key(0, 0.0), key(1, 9.8)})}}));
  const std::vector<Vec3f> p = jet.after(0.1, 1);  // 0.049 m in one step
  ASSERT_EQ(p.size(), 5u);
  for (std::size_t k = 0; k < p.size(); ++k) EXPECT_NEAR(p[k].y, -(0.049 - 0.01 * double(k)), 1e-6);
  for (const Vec3f& v : jet.scene().velocities()) EXPECT_NEAR(v.y, -0.49, 1e-6);  // the mean speed
}

TEST(MovingEmitter, TheNozzleMovesAndTurns) {
  const auto device = openDevice("cpu");
  Jet<CircleEmitter> jet(
      *device, 0.01f,
      object({{"radius", 0.004},
              {"speed", 0.999},
              {"position", keyframes({key(0, Value::Array{0, 0, 0}), key(0.1, Value::Array{10, 0, 0})})},
              {"rotation", keyframes({key(0, Value::Array{0, 0, 0}), key(0.1, Value::Array{0, 0, 90})})}}));
  const std::vector<Vec3f> p = jet.after(0.01, 10);  // a particle a step
  const std::vector<Vec3f> v = jet.scene().velocities();
  ASSERT_EQ(p.size(), 10u);
  for (std::size_t k = 0; k < p.size(); ++k) {
    const double angle = 0.1 * double(k) * std::acos(-1.0) / 2, away = 0.0999 - 0.01 * double(k);
    EXPECT_NEAR(v[k].x, 0.999 * std::sin(angle), 1e-5) << k;
    EXPECT_NEAR(v[k].y, -0.999 * std::cos(angle), 1e-5) << k;
    EXPECT_NEAR(p[k].x, double(k) + away * std::sin(angle), 1e-4) << k;
    EXPECT_NEAR(p[k].y, -away * std::cos(angle), 1e-4) << k;
  }
}

}  // namespace
}  // namespace weir::test
