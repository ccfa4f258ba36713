// Gauges beside closed forms: uniform and linear fields, a still column, a jet in free flight.
#include "nodes/gauge/gauge.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>

#include "nodes/emitters/circle_emitter.h"
#include "tests/nodes/emitters/jet.h"
#include "tests/support/expect_error.h"
#include "tests/support/simulated_scene.h"

namespace weir::test {
namespace {

constexpr float kSpacing = 0.05f;
const std::atomic<bool> never = false;

Value vector(double x, double y, double z) {
  return Value::Array{x, y, z};
}

Vec3d asVector(const Value& v) {
  return {v.asArray()[0].asDouble(), v.asArray()[1].asDouble(), v.asArray()[2].asDouble()};
}

/// v = (1 + 2y, -z, 0.5x).
Vec3f linearField(const Vec3f& p) {
  return {1 + 2 * p.y, -p.z, 0.5f * p.x};
}

/// A lattice that fills the cube [0, 1]³, with that field as its velocity.
std::vector<Vec3f> cube() {
  const Vec3f corner{kSpacing / 2, kSpacing / 2, kSpacing / 2};
  return jitteredCube(20, kSpacing, 0, 1, corner);
}

class Gauged {
 public:
  Gauged(Device& device, const Value& parameters) : scene_(device, cube(), velocities(), fluidOf()) {
    gauge_ = static_cast<Gauge*>(&scene_.graph().add(std::make_unique<Gauge>(), "gauge"));
    gauge_->assignAll(parameters, {"test", "", ""});
    scene_.graph().link(SceneGraph::parseLink("water.fluid -> gauge.particles"));
    scene_.gravity = {};
    scene_.reset(1e-3);
  }
  Value found() {
    NodeReport report;
    gauge_->report(report);
    return report.statistics;
  }
  FluidScene& scene() { return scene_; }

 private:
  static Value fluidOf() {
    return object({{"spacing", kSpacing}, {"calibration", "lattice"}, {"pressure", true}});
  }
  static std::vector<Vec3f> velocities() {
    std::vector<Vec3f> all;
    for (const Vec3f& p : cube()) all.push_back(linearField(p));
    return all;
  }
  FluidScene scene_;
  Gauge* gauge_;
};

TEST(Gauge, APointSeesALinearFieldExactlyAndIsFullWithinFluid) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    // On a node of the lattice and in the middle of a cell, neighbours lie evenly to all sides.
    for (const double at : {0.5, 0.525}) {
      const Value found = Gauged(*device, object({{"position", vector(at, at, at)}})).found();
      EXPECT_NEAR(found.find("filled")->asDouble(), 1, 0.02) << name;
      const Vec3d v = asVector(*found.find("velocity"));
      EXPECT_NEAR(v.x, 1 + 2 * at, 1e-5) << name;
      EXPECT_NEAR(v.y, -at, 1e-5) << name;
      EXPECT_NEAR(v.z, 0.5 * at, 1e-5) << name;
      EXPECT_NEAR(found.find("density")->asDouble(), 1000, 1) << name;
      EXPECT_NE(found.find("pressure"), nullptr) << name;
    }
  }
}

TEST(Gauge, APointAtAFlatSurfaceIsHalfFullAndOneFarAwayIsEmpty) {
  const auto device = openDevice("cpu");
  EXPECT_NEAR(Gauged(*device, object({{"position", vector(0.5, 1, 0.5)}})).found().find("filled")->asDouble(),
              0.5, 0.01);
  const Value nothing = Gauged(*device, object({{"position", vector(0.5, 2, 0.5)}})).found();
  EXPECT_EQ(nothing.find("filled")->asDouble(), 0);
  EXPECT_EQ(nothing.find("velocity"), nullptr);
}

TEST(Gauge, ALineFindsWhereTheSurfaceIsInWhateverDirectionItPoints) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const Value up =
        Gauged(
            *device,
            object({{"shape", "line"}, {"position", vector(0.5, -0.5, 0.5)}, {"end", vector(0.5, 2.5, 0.5)}}))
            .found();
    EXPECT_NEAR(up.find("height")->asDouble(), 1.5, 0.02 * double(kSpacing)) << name;
    EXPECT_NEAR(up.find("length")->asDouble(), 1, 0.04 * double(kSpacing)) << name;
    const Value across = Gauged(*device, object({{"shape", "line"},
                                                 {"position", vector(0.25, 0.25, 0.5)},
                                                 {"end", vector(1.5, 1.5, 0.5)}}))
                             .found();
    // Out through the cube's edge, where a quarter of the neighbourhood is filled: half of it is farther in.
    EXPECT_LT(across.find("height")->asDouble(), 0.75 * std::numbers::sqrt2) << name;
    EXPECT_GT(across.find("height")->asDouble(), 0.75 * std::numbers::sqrt2 - double(kSpacing)) << name;
    const Value beside =
        Gauged(*device, object({{"shape", "line"}, {"position", vector(2, 0, 2)}, {"end", vector(2, 1, 2)}}))
            .found();
    EXPECT_EQ(beside.find("height")->asDouble(), 0) << name;
    EXPECT_EQ(beside.find("length")->asDouble(), 0) << name;
  }
}

TEST(Gauge, ABoxSumsTheParticlesInIt) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    // 10 × 20 × 4 particles.
    const Value found =
        Gauged(*device, object({{"shape", "box"}, {"min", vector(0.5, 0, 0.2)}, {"max", vector(1, 1, 0.4)}}))
            .found();
    EXPECT_EQ(*found.find("particles"), Value(800)) << name;
    EXPECT_NEAR(found.find("volume")->asDouble(), 0.1, 1e-7) << name;
    EXPECT_NEAR(found.find("filled")->asDouble(), 1, 1e-6) << name;
    EXPECT_NEAR(found.find("mass")->asDouble(), 100, 1e-4) << name;
    const Vec3d v = asVector(*found.find("velocity"));
    EXPECT_NEAR(v.x, 2, 1e-6) << name;
    EXPECT_NEAR(v.y, -0.3, 1e-6) << name;
    EXPECT_NEAR(v.z, 0.375, 1e-6) << name;
    double energy = 0;
    for (const Vec3f& p : cube())
      if (p.x > 0.5f && p.z > 0.2f && p.z < 0.4f) {
        const Vec3f u = linearField(p);
        energy += 0.5 * 0.125 * double(dot(u, u));
      }
    EXPECT_NEAR(found.find("kinetic_energy")->asDouble(), energy, 1e-5 * energy) << name;
  }
}

/// A jet of 0.1 m² at 2 m/s in free flight, along -y from the origin, and a plane across it 0.5 m below.
struct JetThroughAPlane {
  explicit JetThroughAPlane(Device& device, const Value& disc = Value())
      : jet(device, kRaster, object({{"radius", std::sqrt(0.1 / std::numbers::pi)}, {"speed", 2}})) {
    gauge = static_cast<Gauge*>(&jet.scene().graph().add(std::make_unique<Gauge>(), "gauge"));
    // Turned away from the jet by 60°: its velocity across the plane is half as much, the area twice.
    gauge->assignAll(object({{"shape", "plane"},
                             {"position", vector(0, -0.5, 0)},
                             {"normal", vector(std::sqrt(3.0), -1, 0)},
                             {"radius", disc}}),
                     {"test", "", ""});
    jet.scene().graph().link(SceneGraph::parseLink("water.fluid -> gauge.particles"));
  }
  double number(const char* name) {
    NodeReport report;
    gauge->report(report);
    return report.statistics.find(name)->asDouble();
  }

  static constexpr float kRaster = 0.02f;
  Jet<CircleEmitter> jet;
  Gauge* gauge;
};

TEST(Gauge, FlowThroughAPlaneIsAreaTimesSpeedAndVolumeWhatHasPassed) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const double dt : {0.002, 0.01}) {
      JetThroughAPlane through(*device);
      const std::vector<Vec3f> particles = through.jet.after(dt, static_cast<int>(std::lround(0.6 / dt)));
      EXPECT_NEAR(through.number("flow_rate"), 0.2, 0.004) << name << " " << dt;
      double passed = 0;
      for (const Vec3f& p : particles)
        if (std::sqrt(3.0) * double(p.x) - (double(p.y) + 0.5) > 0)
          passed += std::pow(double(through.kRaster), 3);
      EXPECT_GT(passed, 0.05) << name;
      EXPECT_NEAR(through.number("volume"), passed, 0.02 * passed) << name << " " << dt;
    }
  }
}

TEST(Gauge, FlowBesideTheDiscDoesNotCount) {
  const auto device = openDevice("cpu");
  JetThroughAPlane through(*device, Value(0.05));
  through.jet.after(0.005, 120);
  // The disc of radius 0.05 lies within the jet.
  EXPECT_NEAR(through.number("flow_rate"), std::numbers::pi * 0.05 * 0.05,
              0.15 * std::numbers::pi * 0.05 * 0.05);
}

/// A column of 0.3 m at rest, with more nodes and links.
std::string column(const std::string& gauges, const std::string& links) {
  return R"({"weir": 1, "world": {"dt": 0.001, "frame_rate": 50, "duration": 0.12},
    "nodes": {
      "block": {"type": "BoxSampler", "params": {"min": [0, 0, 0], "max": [0.2, 0.3, 0.2]}},
      "room": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.2, 0.5, 0.2]}},
      "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
      "water": {"type": "ParticleFluid", "params": {"spacing": 0.02, "bulk_modulus": 1e6, "pressure": true},
        "modules": {"solver": {"type": "AcceleratedSolver", "params": {"tolerance": 2e-4, "max_iterations": 400}}}})" +
         gauges + R"(},
    "links": ["block.particles -> water.initial", "room.surface -> walls.solids", "water.fluid -> walls.fluid")" +
         links + "]}";
}

TEST(Gauge, PressureInAColumnAtRestIsHydrostatic) {
  const std::string gauges = R"(,
      "low": {"type": "Gauge", "params": {"shape": "box", "min": [0.05, 0.06, 0.05], "max": [0.15, 0.1, 0.15]}},
      "high": {"type": "Gauge", "params": {"shape": "box", "min": [0.05, 0.16, 0.05], "max": [0.15, 0.2, 0.15]}},
      "level": {"type": "Gauge", "params": {"shape": "line", "position": [0.1, 0.1, 0.1], "end": [0.1, 0.5, 0.1]}})";
  const std::string links =
      R"(, "water.fluid -> low.particles", "water.fluid -> high.particles", "water.fluid -> level.particles")";
  const auto device = openDevice("cpu");
  SimulatedScene scene(*device, column(gauges, links));
  scene->reset();
  double low = 0, high = 0;
  int frames = 0;
  while (scene->advanceFrame(never)) {
    const auto pressureOf = [&](const char* name) {
      NodeReport report;
      scene.node<Gauge>(name).report(report);
      return report.statistics.find("pressure")->asDouble();
    };
    low += pressureOf("low"), high += pressureOf("high"), ++frames;
  }
  NodeReport level;
  scene.node<Gauge>("level").report(level);
  EXPECT_NEAR(level.statistics.find("height")->asDouble() + 0.1, 0.3, 0.01);
  ASSERT_GT(frames, 0);
  EXPECT_NEAR(low / frames, 1000 * 9.8 * 0.22, 0.1 * 1000 * 9.8 * 0.22);
  EXPECT_NEAR((low - high) / frames, 1000 * 9.8 * 0.1, 0.1 * 1000 * 9.8 * 0.1);
}

TEST(Gauge, DoesNotChangeTheFluid) {
  const auto device = openDevice("cpu");
  const auto run = [&](const std::string& gauges, const std::string& links) {
    SimulatedScene scene(
        *device, column(gauges, links),
        {"world.duration=0.03", "world.frame_rate=100", "water.spacing=0.04", "water.rest_steps=0"});
    scene->reset();
    NodeReport ignored;
    while (scene->advanceFrame(never))
      if (!gauges.empty()) scene.node<Gauge>("at").report(ignored);
    ParticleSet& set = scene->scene().graph.find("water")->particleCount() > 0
                           ? scene.node<ParticleFluid>("water").fluid->set()
                           : throw std::runtime_error("no water");
    return set.positions().toHost(set.bound());
  };
  const std::vector<Vec3f> without = run("", "");
  const char* kinds[] = {R"("shape": "point", "position": [0.1, 0.1, 0.1])",
                         R"("shape": "line", "position": [0.1, 0, 0.1], "end": [0.1, 0.4, 0.1])",
                         R"("shape": "plane", "position": [0.1, 0.1, 0.1])", R"("shape": "box")"};
  for (const char* kind : kinds)
    EXPECT_EQ(run(std::string(R"(, "at": {"type": "Gauge", "params": {)") + kind + "}}",
                  R"(, "water.fluid -> at.particles")"),
              without)
        << kind;
}

TEST(Gauge, RefusesShapesWithoutExtent) {
  const auto refused = [](const Value& parameters) {
    Gauge gauge;
    const auto given = [&] { gauge.assignAll(parameters, {"test", "", ""}); };
    return std::string(errorOf(given).what());
  };
  EXPECT_CONTAINS(refused(object({{"shape", "line"}, {"end", vector(0, 0, 0)}})), "the line has no length");
  EXPECT_CONTAINS(refused(object({{"shape", "plane"}, {"normal", vector(0, 0, 0)}})), "the normal is 0");
  EXPECT_CONTAINS(refused(object({{"shape", "box"}, {"min", vector(1, 0, 0)}})), "the box has no volume");
}

TEST(Gauge, PressureNeedsAModuleThatKnowsIt) {
  const auto device = openDevice("cpu");
  FluidScene scene(*device, {{0, 0, 0}}, {}, object({{"spacing", 0.1}, {"pressure", true}}),
                   object({{"solver", object({{"type", "Pbf"}})}}));
  EXPECT_CONTAINS(errorOf([&] { scene.reset(1e-3); }).what(), "no enabled module that knows its pressure");
}

}  // namespace
}  // namespace weir::test
