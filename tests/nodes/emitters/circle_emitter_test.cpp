// The round nozzle: exact flux, shape of a layer, jitter.
#include "nodes/emitters/circle_emitter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "nodes/emitters/square_emitter.h"
#include "tests/nodes/emitters/jet.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.01f;

TEST(CircleEmitter, FluxIsAreaTimesSpeedWhateverTheRadiusAndTheStep) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const double radius : {0.004, 0.01, 0.0237, 0.05, 0.0611})
      for (const auto& [dt, steps] : {std::pair{1e-3, 301}, {0.023, 13}}) {
        Jet<CircleEmitter> jet(*device, kSpacing, object({{"radius", radius}, {"speed", 1.3}}));
        const double area = std::numbers::pi * radius * radius, d = double(kSpacing);
        const double layers = std::ceil(double(1.3f) * dt * steps / d);
        const double count = double(jet.after(dt, steps).size());
        EXPECT_NEAR(count / layers, area / (d * d), 0.5) << radius;
        EXPECT_EQ(count, layers * std::max(1.0, std::round(area / (d * d)))) << radius << " dt " << dt;
      }
  }
}

TEST(CircleEmitter, ALayerIsALatticeInTheDisc) {
  const auto device = openDevice("cpu");
  for (const double radius : {0.01, 0.013, 0.0237, 0.05, 0.0611}) {
    Jet<CircleEmitter> jet(*device, kSpacing,
                           object({{"radius", radius}, {"speed", 1.0}, {"position", Value::Array{1, 2, 3}}}));
    const std::vector<Vec3f> layer = jet.after(1e-3, 5);  // 0.5 spacings: the first layer only
    Vec3f middle{};
    for (const Vec3f& p : layer) {
      EXPECT_NEAR(p.y, 2 - 0.005, 1e-6);
      EXPECT_LT(std::hypot(p.x - 1, p.z - 3), radius + 0.5 * kSpacing) << radius;
      middle += p / float(layer.size());
    }
    EXPECT_GT(minDistance(layer), 0.999 * kSpacing);
    // Balanced but for one particle that has no partner.
    EXPECT_LT(std::hypot(middle.x - 1, middle.z - 3), 1.5 * radius / double(layer.size()) + 1e-6) << radius;
  }
}

TEST(CircleEmitter, TooLargeOrTooFastIsRefused) {
  const auto device = openDevice("cpu");
  Jet<CircleEmitter> huge(*device, kSpacing, object({{"radius", 1000.0}}));
  try {
    huge.after(1e-3, 1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("10 million"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("nozzle"), std::string::npos) << e.what();
  }
  Jet<CircleEmitter> fast(*device, kSpacing, object({{"speed", 1e30}}));
  EXPECT_THROW(fast.after(1e-3, 1), Error);
}

TEST(Emitter, GravityHasAllLayersForAsLongWhereverStepsCutThem) {
  constexpr double kSpeed = 6, kGravity = 9.8, kDt = 0.0007,
                   kApart = double(kSpacing) / kSpeed;  // 2.38 steps
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Jet<SquareEmitter> jet(*device, kSpacing, object({{"width", 0.01}, {"height", 0.01}, {"speed", kSpeed}}));
    jet.scene().gravity = {0, kGravity, 0};
    const std::vector<Vec3f> layers = jet.after(kDt, 700);
    ASSERT_GT(layers.size(), 280u);
    // On parabolas that are one as far behind another, second differences are g·(d/v)².
    for (std::size_t k = 1; k + 4 < layers.size(); ++k) {
      const double bent = double(layers[k - 1].y) - 2 * double(layers[k].y) + double(layers[k + 1].y);
      EXPECT_NEAR(bent, kGravity * kApart * kApart, 0.01 * double(kSpacing)) << name << " layer " << k;
    }
  }
}

TEST(CircleEmitter, WhatIsRelaxedDoesNotRepeatItselfAfterAFewLayers) {
  const auto device = openDevice("cpu");
  Jet<CircleEmitter> jet(*device, kSpacing,
                         object({{"radius", 0.05}, {"speed", 1.0}, {"arrangement", "relaxed"}}));
  const std::vector<Vec3f> p = jet.after(0.002, 479);
  constexpr int kLayers = 96;
  ASSERT_EQ(p.size() % kLayers, 0u);
  const std::size_t inLayer = p.size() / kLayers;
  std::vector<double> widths(kLayers);  // the root of the mean square away from the axis
  for (std::size_t i = 0; i < p.size(); ++i) widths[i / inLayer] += p[i].x * p[i].x + p[i].z * p[i].z;
  for (double& width : widths) width = std::sqrt(width / double(inLayer));
  const double mean = std::accumulate(widths.begin(), widths.end(), 0.0) / kLayers;
  for (int lag = 3; lag <= 40; ++lag) {
    double both = 0, squares = 0;
    for (int k = 0; k + lag < kLayers; ++k) {
      both += (widths[k] - mean) * (widths[k + lag] - mean);
      squares += 0.5 * (std::pow(widths[k] - mean, 2) + std::pow(widths[k + lag] - mean, 2));
    }
    EXPECT_LT(both / squares, 0.6) << "layers apart: " << lag;
  }
}

TEST(Emitter, JitterIsBoundedAndDecidedByTheSeed) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const auto positions = [&](double jitter, std::int64_t seed) {
      Jet<SquareEmitter> jet(*device, kSpacing, object({{"jitter", jitter}, {"speed", 1.0}}));
      jet.scene().seed = seed;
      return jet.after(1e-3, 60);
    };
    const std::vector<Vec3f> still = positions(0, 1), moved = positions(0.3, 1), again = positions(0.3, 1),
                             other = positions(0.3, 2);
    ASSERT_EQ(still.size(), moved.size());
    EXPECT_EQ(moved, again);
    EXPECT_NE(moved, other);
    Vec3d sum{}, squares{};
    for (std::size_t i = 0; i < still.size(); ++i)
      for (int axis = 0; axis < 3; ++axis) {
        const double share = double(moved[i][axis] - still[i][axis]) / kSpacing;
        EXPECT_LE(std::abs(share), 0.3 + 1e-4);
        sum[axis] += share;
        squares[axis] += share * share;
      }
    const double n = double(still.size());
    for (int axis = 0; axis < 3; ++axis) {
      // Of a uniform distribution on [-0.3, 0.3]: variance 0.03. Five standard errors.
      EXPECT_NEAR(sum[axis] / n, 0, 5 * std::sqrt(0.03 / n));
      EXPECT_NEAR(squares[axis] / n, 0.03, 5 * std::sqrt(7.2e-4 / n));
    }
  }
}

}  // namespace
}  // namespace weir::test
