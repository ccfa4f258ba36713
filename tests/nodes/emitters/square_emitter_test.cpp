// Flux, geometry and timing of the nozzle, through the particles that a fluid without forces receives.
#include "nodes/emitters/square_emitter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/nodes/emitters/jet.h"

namespace weir::test {
namespace {

using Nozzle = Jet<SquareEmitter>;

TEST(SquareEmitter, FluxIsExactWhateverTheStep) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const auto& [dt, steps] : {std::pair{1e-3, 777}, {3.1e-3, 251}, {0.05, 16}}) {
      Nozzle jet(*device, 0.01f, object({{"width", 0.03}, {"height", 0.02}, {"speed", 1.37}}));
      const double layers = std::ceil(1.37 * dt * steps / double(0.01f));
      EXPECT_EQ(double(jet.after(dt, steps).size()), 6 * layers) << name << " dt " << dt;
    }
  }
}

TEST(SquareEmitter, ARelaxedJetHasTheSameFluxNoOrderAndRestDensity) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    constexpr float kSpacing = 0.01f;
    const auto jetOf = [&](const char* calibration) {
      return std::make_unique<Nozzle>(
          *device, kSpacing, object({{"width", 0.08}, {"height", 0.06}, {"speed", 1.37}}), calibration);
    };
    const auto relaxed = jetOf("packing"), lattice = jetOf("lattice");
    // Steps of less and of more than a layer, over many periods of the tile.
    for (const auto& [dt, steps] : {std::pair{1e-3, 371}, {0.05, 8}}) {
      const std::vector<Vec3f> p = relaxed->after(dt, steps), q = lattice->after(dt, steps);
      ASSERT_EQ(p.size(), q.size()) << name;
      double moved = 0;
      for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_LT(length(p[i] - q[i]), 1.6f * kSpacing);
        moved += length(p[i] - q[i]);
      }
      EXPECT_GT(moved / double(p.size()), 0.15 * kSpacing) << name;
      // Neighbours of one layer or of two that follow each other, whichever step they left in.
      EXPECT_GT(minDistance(p), 0.4 * kSpacing) << name;
    }
    const double compressionOfLattice = [&] {
      Nozzle dense(*device, kSpacing, object({{"width", 0.08}, {"height", 0.06}, {"arrangement", "lattice"}}),
                   "packing");
      dense.after(1e-3, 200);
      return dense.scene().report().statistics["compression"]["mean"].asDouble();
    }();
    relaxed->after(1e-3, 200);
    EXPECT_LT(relaxed->scene().report().statistics["compression"]["mean"].asDouble(),
              0.5 * compressionOfLattice);
  }
}

TEST(SquareEmitter, LayersAreOneSpacingApartAndLeaveDownwards) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    Nozzle jet(
        *device, 0.01f,
        object(
            {{"position", Value::Array{0.2, 1.0, -0.3}}, {"width", 0.01}, {"height", 0.01}, {"speed", 2.0}}));
    const std::vector<Vec3f> p = jet.after(7.1e-3, 20);  // more than one layer a step
    ASSERT_EQ(p.size(), 29u);
    for (std::size_t k = 0; k < p.size(); ++k) {
      EXPECT_NEAR(p[k].x, 0.2f, 1e-6);
      EXPECT_NEAR(p[k].z, -0.3f, 1e-6);
      // Layer k has travelled for what is left of 0.142 s after k spacings.
      EXPECT_NEAR(p[k].y, 1.0 - (2.0 * 0.142 - 0.01 * double(k)), 2e-6) << name;
    }
  }
}

TEST(SquareEmitter, RotationKeepsTheSpacing) {
  const auto device = openDevice("cpu");
  Nozzle straight(*device, 0.01f, object({{"width", 0.05}, {"height", 0.04}, {"speed", 1.0}}));
  Nozzle turned(
      *device, 0.01f,
      object({{"width", 0.05}, {"height", 0.04}, {"speed", 1.0}, {"rotation", Value::Array{30, -70, 110}}}));
  const std::vector<Vec3f> a = straight.after(1e-3, 50), b = turned.after(1e-3, 50);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 1; i < a.size(); ++i) EXPECT_NEAR(length(a[i] - a[0]), length(b[i] - b[0]), 1e-6);
}

TEST(SquareEmitter, StartStopAndLimit) {
  const auto device = openDevice("cpu");
  Nozzle window(
      *device, 0.01f,
      object({{"width", 0.01}, {"height", 0.01}, {"speed", 1.0}, {"start", 0.0505}, {"stop", 0.1}}));
  EXPECT_EQ(window.after(1e-3, 50).size(), 0u);
  EXPECT_EQ(window.after(1e-3, 200).size(), 5u);  // 0.0495 m of jet: layers 0 to 4
  Nozzle limited(*device, 0.01f,
                 object({{"width", 0.03}, {"height", 0.01}, {"speed", 1.0}, {"max_particles", 7}}));
  EXPECT_EQ(limited.after(1e-3, 200).size(), 7u);
  EXPECT_EQ(limited.report().statistics["particles_emitted"], Value(7));
}

TEST(SquareEmitter, WithoutAFluidItSaysSo) {
  const auto device = openDevice("cpu");
  Log log;
  Registry registry;
  SceneGraph graph;
  graph.add(std::make_unique<SquareEmitter>(), "nozzle");
  try {
    graph.reset({*device, log, registry, {}, 1e-3, 1});
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("nozzle"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace weir::test
