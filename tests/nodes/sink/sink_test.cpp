// Sinks: what flows in is what is still there and what was removed, for boxes and meshes.
#include "nodes/sink/sink.h"

#include <gtest/gtest.h>

#include "nodes/emitters/circle_emitter.h"
#include "tests/nodes/emitters/jet.h"
#include "tests/support/expect_error.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

class Drained {
 public:
  Drained(FluidScene& scene, const Value& parameters) : scene_(scene) {
    sink_ = static_cast<Sink*>(&scene.graph().add(std::make_unique<Sink>(), "drain"));
    sink_->assignAll(parameters, {"test", "", ""});
    scene.graph().link(SceneGraph::parseLink("drain.sink -> water.sinks"));
  }
  void linkMesh(TriangleMesh mesh) {
    scene_.graph().add(std::make_unique<GivenMesh>(std::move(mesh)), "body");
    scene_.graph().link(SceneGraph::parseLink("body.surface -> drain.meshes"));
  }
  Sink& sink() { return *sink_; }
  std::int64_t removed() {
    NodeReport report;
    sink_->report(report);
    return report.statistics["particles_removed"].asInt();
  }

 private:
  FluidScene& scene_;
  Sink* sink_;
};

/// n³ points on a lattice over the cube [-1, 1]³, none on a face of the regions below.
std::vector<Vec3f> lattice(int n) {
  std::vector<Vec3f> points = jitteredCube(n, 2.0f / float(n), 0, 1);
  for (Vec3f& p : points) p += Vec3f{-1 + 1.0f / float(n), -1 + 1.0f / float(n), -1 + 1.0f / float(n)};
  return points;
}

TEST(Sink, ABoxRemovesExactlyWhatIsInside) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> points = lattice(20);
    FluidScene scene(*device, points, {}, object({{"spacing", 0.05}}));
    Drained drain(scene,
                  object({{"min", Value::Array{-0.42, -3, 0.13}}, {"max", Value::Array{0.71, 0.2, 0.66}}}));
    scene.gravity = {};
    scene.reset(1e-3);
    std::int64_t inside = 0;
    for (const Vec3f& p : points)
      inside += p.x > -0.42f && p.x < 0.71f && p.y < 0.2f && p.z > 0.13f && p.z < 0.66f;
    EXPECT_GT(inside, 100);
    EXPECT_EQ(drain.removed(), inside) << name;
    EXPECT_EQ(scene.fluid().particleCount(), std::int64_t(points.size()) - inside) << name;
    NodeReport report = scene.report();
    EXPECT_EQ(report.statistics["particles_escaped"], Value(0));
  }
}

TEST(Sink, AMeshRemovesWhatIsInside) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> points = lattice(24);
    FluidScene scene(*device, points, {}, object({{"spacing", 0.05}}));
    Drained drain(scene, Value::object());
    drain.linkMesh(icosphere(4, 0.7f));
    scene.gravity = {};
    scene.reset(1e-3);
    // Distances are interpolated, so a point within a tenth of a cell of the surface may go either way.
    constexpr double kBand = 0.004;
    std::int64_t surely = 0, perhaps = 0;
    for (const Vec3f& p : points) {
      surely += length(p) < 0.7 - kBand;
      perhaps += std::abs(length(p) - 0.7) <= kBand;
    }
    EXPECT_GT(surely, 1000);
    EXPECT_GE(drain.removed(), surely) << name;
    EXPECT_LE(drain.removed(), surely + perhaps) << name;
    EXPECT_EQ(scene.fluid().particleCount(), std::int64_t(points.size()) - drain.removed()) << name;
  }
}

TEST(Sink, WhatFlowsInIsInsideOrRemoved) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    FluidScene scene(*device, {}, {}, object({{"spacing", 0.02}}));
    auto& nozzle =
        static_cast<CircleEmitter&>(scene.graph().add(std::make_unique<CircleEmitter>(), "nozzle"));
    nozzle.assignAll(object({{"radius", 0.06}, {"speed", 3.0}, {"jitter", 0.2}}), {});
    scene.graph().link(SceneGraph::parseLink("nozzle.particles -> water.emitters"));
    Drained drain(scene, object({{"min", Value::Array{-2, -2, -2}}, {"max", Value::Array{2, -0.3, 2}}}));
    scene.reset(2e-3);
    for (int k = 0; k < 10; ++k) {
      scene.step(30);
      NodeReport emitted;
      nozzle.report(emitted);
      const std::int64_t in = emitted.statistics["particles_emitted"].asInt();
      const std::int64_t left = scene.report().statistics["particles"].asInt();
      EXPECT_EQ(in, left + drain.removed()) << name << " after " << 30 * (k + 1) << " steps";
    }
    EXPECT_GT(drain.removed(), 1000);
    scene.reset(2e-3);
    EXPECT_EQ(drain.removed(), 0);
  }
}

TEST(Sink, TwoSinksCountOnTheirOwn) {
  const auto device = openDevice("cpu");
  FluidScene scene(*device, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2.5f, 0, 0}}, {}, object({{"spacing", 0.1}}));
  Drained drain(scene, object({{"min", Value::Array{0.5, -1, -1}}, {"max", Value::Array{1.5, 1, 1}}}));
  auto& other = static_cast<Sink&>(scene.graph().add(std::make_unique<Sink>(), "other"));
  other.assignAll(object({{"min", Value::Array{1.5, -1, -1}}, {"max", Value::Array{3, 1, 1}}}), {});
  scene.graph().link(SceneGraph::parseLink("other.sink -> water.sinks"));
  scene.reset(1e-3);
  NodeReport report;
  other.report(report);
  EXPECT_EQ(drain.removed(), 1);
  EXPECT_EQ(report.statistics["particles_removed"], Value(2));
  EXPECT_EQ(scene.fluid().particleCount(), 1);
}

TEST(Sink, CountsMoreOfAllRanksThan32BitsHold) {
  const auto device = openDevice("cpu");
  FluidScene scene(*device, {{0, 0, 0}, {1, 0, 0}}, {}, object({{"spacing", 0.1}}));
  Drained drain(scene, object({{"min", Value::Array{0.5, -1, -1}}, {"max", Value::Array{1.5, 1, 1}}}));
  scene.reset(1e-3);
  for (int frame = 0; frame < 2; ++frame) drain.sink().addRemoved(3'000'000'000);
  EXPECT_EQ(drain.removed(), 6'000'000'001);
  scene.reset(1e-3);
  EXPECT_EQ(drain.removed(), 1);
}

TEST(Sink, RefusesHalfABoxAndNothing) {
  Sink sink;
  EXPECT_CONTAINS(errorOf([&] {
                    sink.assignAll(object({{"min", Value::Array{0, 0, 0}}}), {});
                  }).what(),
                  "no max");
  EXPECT_CONTAINS(
      errorOf([&] {
        sink.assignAll(object({{"min", Value::Array{0, 0, 0}}, {"max", Value::Array{1, 0, 1}}}), {});
      }).what(),
      "no volume");
  const auto device = openDevice("cpu");
  FluidScene scene(*device, {}, {}, object({{"spacing", 0.1}}));
  Drained drain(scene, Value::object());
  EXPECT_CONTAINS(errorOf([&] { scene.reset(1e-3); }).what(), "the sink is empty");
}

}  // namespace
}  // namespace weir::test
