// The sums over a fluid against the slow, obvious ones: one particle after the other, on the host.
#include "nodes/particle_fluid/fluid_statistics.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "framework/communication/thread_ranks.h"
#include "tests/nodes/particle_fluid/modules/module_test_support.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

constexpr double kRestDensity = 1000;

struct Particles {
  std::vector<Vec3f> positions, velocities;
  std::vector<float> densities;
  std::vector<int> neighbors;
};

/// Far from the origin, and fast all together, so that sums lose digits where they can.
Particles randomParticles(int count) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_real_distribution<float> unit(-1, 1);
  std::uniform_int_distribution<int> neighbors(0, 60);
  Particles p;
  for (int i = 0; i < count; ++i) {
    p.positions.push_back({100 + unit(random), -50 + 3 * unit(random), unit(random)});
    p.velocities.push_back({7 * unit(random), 20 + unit(random), 1e-3f * unit(random)});
    p.densities.push_back(1000 * (1 + 0.05f * unit(random)));
    p.neighbors.push_back(neighbors(random));
  }
  return p;
}

FluidSums sumsOn(Device& device, const Particles& given) {
  ParticleSet particles(device);
  const Attribute<float> density =
      particles.add<float>({.name = "density", .unit = "kg/m^3", .doc = "Density.", .derived = true});
  ParticleBatch batch;
  batch.assign(device, given.positions, given.velocities);
  particles.append(batch);
  density.assign(given.densities);
  const Array<int> neighbors(device, std::span<const int>(given.neighbors));
  Array<FluidSums> sums(device, 1);
  dispatch(device, [&](auto& backend) {
    sumFluid(backend, particles, std::as_const(neighbors).view(), kRestDensity, sums.data());
  });
  return sums.toHost().front();
}

/// As exact as sums of that many numbers in double precision are in any order.
void expectNear(const Vec3d& found, const Vec3d& expected, double magnitude, const std::string& where) {
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(found[a], expected[a], 1e-13 * magnitude) << where << ", axis " << a;
}

void expectObvious(const FluidSums& found, const Particles& p, const std::string& where) {
  const auto count = static_cast<double>(p.positions.size());
  Vec3d velocity, position;
  double speedSquared = 0, max = 0, compression = 0, maxCompression = 0;
  std::int64_t neighbors = 0;
  int maxNeighbors = 0;
  Aabb box;
  for (std::size_t i = 0; i < p.positions.size(); ++i) {
    const Vec3d v = toDouble(p.velocities[i]);
    velocity += v;
    position += toDouble(p.positions[i]);
    speedSquared += dot(v, v);
    max = std::max(max, dot(v, v));
    const double over = std::max(double(p.densities[i]) / kRestDensity - 1, 0.0);
    compression += over;
    maxCompression = std::max(maxCompression, over);
    neighbors += p.neighbors[i];
    maxNeighbors = std::max(maxNeighbors, p.neighbors[i]);
    box.extend(p.positions[i]);
  }
  expectNear(found.velocity, velocity, 30 * count, where);
  expectNear(found.position, position, 110 * count, where);
  EXPECT_NEAR(found.speedSquared, speedSquared, 1e-13 * 500 * count) << where;
  EXPECT_NEAR(found.compression, compression, 1e-13 * count) << where;
  // The extremes are some particle's, and whole numbers are exact.
  EXPECT_DOUBLE_EQ(found.maxSpeedSquared, max) << where;
  EXPECT_DOUBLE_EQ(found.maxCompression, maxCompression) << where;
  EXPECT_EQ(found.neighbors, neighbors) << where;
  EXPECT_EQ(found.maxNeighbors, maxNeighbors) << where;
  EXPECT_EQ(found.box.lo, box.lo) << where;
  EXPECT_EQ(found.box.hi, box.hi) << where;
}

TEST(FluidStatistics, AreTheSumsOverAllParticles) {
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const int count : {1, 7, 256, 4096, 4097, 50001, 300000})
      expectObvious(sumsOn(*device, randomParticles(count)), randomParticles(count),
                    name + ", " + std::to_string(count) + " particles");
  }
}

TEST(FluidStatistics, AreTheSameBitsForAnyNumberOfThreads) {
  const Particles particles = randomParticles(100003);
  CpuDevice one(1);
  const FluidSums expected = sumsOn(one, particles);
  for (int threads = 2; threads <= 5; ++threads) {
    CpuDevice device(threads);
    const FluidSums found = sumsOn(device, particles);
    EXPECT_EQ(found.velocity, expected.velocity) << threads;
    EXPECT_EQ(found.position, expected.position) << threads;
    EXPECT_EQ(found.speedSquared, expected.speedSquared) << threads;
    EXPECT_EQ(found.compression, expected.compression) << threads;
  }
}

/// Of the k-th part of particles that several share in turn.
Particles partOf(const Particles& all, int k, int parts) {
  Particles part;
  for (std::size_t i = 0; i < all.positions.size(); ++i) {
    if (static_cast<int>(i / 100) % parts != k) continue;
    part.positions.push_back(all.positions[i]);
    part.velocities.push_back(all.velocities[i]);
    part.densities.push_back(all.densities[i]);
  }
  return part;
}

FluidSums sumsOnRanks(const std::string& deviceName, const Particles& all, int ranks) {
  FluidSums found;
  runOnThreads(ranks, [&](Communicator& communicator) {
    const auto device = openDevice(deviceName);
    const Particles part = partOf(all, communicator.rank(), ranks);
    ParticleSet particles(*device);
    const Attribute<float> density =
        particles.add<float>({.name = "density", .unit = "kg/m^3", .doc = "Density.", .derived = true});
    ParticleBatch batch;
    batch.assign(*device, part.positions, part.velocities);
    particles.append(batch);
    density.assign(part.densities);
    const NeighborList none(*device);
    FluidConstants constants;
    constants.restDensity = kRestDensity;
    const FluidSums sums = sumsOfFluid(communicator, particles, none, constants);
    if (communicator.rank() == 0) found = sums;
  });
  return found;
}

TEST(FluidStatistics, OfRanksAreTheSameBitsForAnyNumberOfThem) {
  Particles particles = randomParticles(30001);
  particles.neighbors.assign(particles.neighbors.size(), 0);
  for (const std::string& name : availableDevices()) {
    const FluidSums one = sumsOnRanks(name, particles, 1);
    expectObvious(one, particles, name + ", on ranks");
    for (int ranks = 2; ranks <= 4; ++ranks) {
      const FluidSums several = sumsOnRanks(name, particles, ranks);
      EXPECT_EQ(several.velocity, one.velocity) << name << ranks;
      EXPECT_EQ(several.position, one.position) << name << ranks;
      EXPECT_EQ(several.speedSquared, one.speedSquared) << name << ranks;
      EXPECT_EQ(several.compression, one.compression) << name << ranks;
      EXPECT_EQ(several.maxSpeedSquared, one.maxSpeedSquared) << name << ranks;
      EXPECT_EQ(several.maxCompression, one.maxCompression) << name << ranks;
      EXPECT_EQ(several.box.lo, one.box.lo) << name << ranks;
      EXPECT_EQ(several.box.hi, one.box.hi) << name << ranks;
    }
  }
}

TEST(FluidStatistics, ExtremesLeaveOutWhatIsNoNumber) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    for (const std::size_t bad : {0, 2, 4}) {
      Particles p = randomParticles(5);
      p.velocities[bad] = {kNone, 0, 0};
      p.densities[bad] = kNone;
      double max = 0, maxCompression = 0;
      for (std::size_t i = 0; i < 5; ++i) {
        if (i == bad) continue;
        max = std::max(max, dot(toDouble(p.velocities[i]), toDouble(p.velocities[i])));
        maxCompression = std::max(maxCompression, double(p.densities[i]) / kRestDensity - 1);
      }
      const FluidSums sums = sumsOn(*device, p);
      EXPECT_DOUBLE_EQ(sums.maxSpeedSquared, max) << name << bad;
      EXPECT_DOUBLE_EQ(sums.maxCompression, maxCompression) << name << bad;
      EXPECT_TRUE(std::isnan(sums.speedSquared)) << name << bad;
    }
  }
}

double numberIn(const Value& statistics, const char* key) {
  return statistics.find(key)->asDouble();
}

Vec3d vectorIn(const Value& v) {
  const Value::Array& a = v.asArray();
  return {a[0].asDouble(), a[1].asDouble(), a[2].asDouble()};
}

TEST(FluidStatistics, AreReportedInTheirUnits) {
  constexpr float kSpacing = 0.01f;
  for (const std::string& name : availableDevices()) {
    const auto device = openDevice(name);
    const std::vector<Vec3f> cube = jitteredCube(18, kSpacing, 0.1f, 3, {0.2f, 0.5f, 0});
    FluidScene scene(*device, cube, randomVelocities(cube.size(), 0.3f, 5), object({{"spacing", kSpacing}}));
    scene.reset(1e-3);
    scene.step(3);
    scene.frame();
    const Value statistics = scene.report().statistics;
    const std::vector<Vec3f> positions = scene.positions(), velocities = scene.velocities();
    const double mass = 1000 * std::pow(double(kSpacing), 3), count = static_cast<double>(positions.size());
    const Vec3d velocity = sumOf(velocities), position = sumOf(positions);
    double speedSquared = 0, max = 0;
    Aabb box;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double v2 = dot(toDouble(velocities[i]), toDouble(velocities[i]));
      speedSquared += v2;
      max = std::max(max, v2);
      box.extend(positions[i]);
    }
    constexpr double kFloat = 1e-6;  // relative; the mass of a particle is one
    EXPECT_EQ(*statistics.find("particles"), Value(static_cast<std::int64_t>(positions.size()))) << name;
    EXPECT_NEAR(numberIn(statistics, "kinetic_energy"), mass / 2 * speedSquared,
                kFloat * mass * speedSquared);
    EXPECT_NEAR(numberIn(statistics, "potential_energy"), mass * 9.8 * position.y,
                kFloat * mass * 9.8 * count);
    EXPECT_NEAR(numberIn(statistics, "max_speed"), std::sqrt(max), kFloat);
    const double scale = count * std::sqrt(max);
    const Vec3d momentum = vectorIn(*statistics.find("linear_momentum")),
                center = vectorIn(*statistics.find("center_of_mass"));
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(momentum[a], mass * velocity[a], kFloat * mass * scale) << name << a;
      EXPECT_NEAR(center[a], position[a] / count, kFloat) << name << a;
      EXPECT_EQ(vectorIn(statistics.find("bounds")->asArray()[0])[a], double(box.lo[a])) << name << a;
      EXPECT_EQ(vectorIn(statistics.find("bounds")->asArray()[1])[a], double(box.hi[a])) << name << a;
    }
  }
}

}  // namespace
}  // namespace weir::test
