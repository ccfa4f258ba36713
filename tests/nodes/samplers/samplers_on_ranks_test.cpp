// What ranks sample together is what one samples, each a share of it; and lattices of more nodes than 32 bits
// count.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <type_traits>
#include <vector>

#include "framework/communication/shared_by_ranks.h"
#include "framework/communication/thread_ranks.h"
#include "nodes/samplers/box_sampler.h"
#include "nodes/samplers/mesh_sampler.h"
#include "nodes/samplers/sphere_sampler.h"
#include "tests/nodes/samplers/sampled.h"
#include "tests/support/given_mesh.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

/// Asks like a fluid that ranks share, or like one that they do not.
template <class... Role>
class Reader final : public Node, public Role... {
 public:
  static constexpr NodeInfo kInfo{"Reader", "Asks for a spacing."};
  const NodeInfo& info() const override { return kInfo; }
  Inputs<ParticleBatch> in{*this, "in", "Particles."};
  bool disordered = false;
  void configure(const SetupContext&) override { in.request({kSpacing, 1.5f, disordered}); }
  void reset(const SetupContext&) override {}
  static constexpr float kSpacing = 0.02f;
};

class Sharing : public SharedByRanks {
 public:
  void watch(bool) override {}
  Value ranksReport() const override { return Value::object(); }
};

/// A sampler and its reader on one rank.
template <class S, class R = Reader<Sharing>>
class OneRank {
 public:
  OneRank(const Value& parameters, bool disordered, Communicator* ranks) : device_(1) {
    sampler_ = static_cast<S*>(&graph_.add(std::make_unique<S>(), "block"));
    auto& reader = static_cast<R&>(graph_.add(std::make_unique<R>(), "reader"));
    reader.disordered = disordered;
    graph_.link(SceneGraph::parseLink("block.particles -> reader.in"));
    if constexpr (std::is_same_v<S, MeshSampler>) {
      graph_.add(std::make_unique<GivenMesh>(sphereMesh()), "ball");
      graph_.link(SceneGraph::parseLink("ball.surface -> block.surface"));
    }
    sampler_->assignAll(parameters, {});
    if (ranks != nullptr) sampler_->join(*ranks);
    graph_.reset({device_, log_, registry_, {}, 1e-3, 5});
  }
  S& sampler() { return *sampler_; }
  std::vector<Vec3f> positions() const { return sampler_->particles->positions.toHost(); }
  std::int64_t sampled() {
    NodeReport report;
    sampler_->report(report);
    return report.statistics["particles_sampled"].asInt();
  }

 private:
  static TriangleMesh sphereMesh() { return icosphere(2, 0.4f); }

  CpuDevice device_;
  Log log_;
  Registry registry_;
  SceneGraph graph_;
  S* sampler_ = nullptr;
};

template <class S>
void expectSharedAlike(const Value& parameters, bool disordered) {
  OneRank<S> one(parameters, disordered, nullptr);
  const std::vector<Vec3f> all = one.positions();
  ASSERT_GT(std::ssize(all), LatticeShare::kChunk);
  for (const int ranks : {1, 3}) {
    std::vector<int> times(all.size());
    std::mutex mutex;
    runOnThreads(ranks, [&](Communicator& communicator) {
      OneRank<S> shared(parameters, disordered, &communicator);
      const BatchPart* const part = shared.sampler().part();
      const std::vector<Vec3f> own = shared.positions();
      const std::lock_guard lock(mutex);
      ASSERT_NE(part, nullptr);
      EXPECT_EQ(part->all, std::ssize(all));
      EXPECT_EQ(shared.sampled(), std::ssize(all));
      EXPECT_LE(std::ssize(own), std::ssize(all) / ranks + LatticeShare::kChunk);
      std::int64_t first = 0;
      for (const BatchPart::Run& run : part->runs) {
        ASSERT_EQ(run.first, first);
        ASSERT_LE(run.number + run.count, std::ssize(all));
        for (std::int64_t k = 0; k < run.count; ++k) {
          EXPECT_EQ(own[static_cast<std::size_t>(first + k)], all[static_cast<std::size_t>(run.number + k)]);
          ++times[static_cast<std::size_t>(run.number + k)];
        }
        first += run.count;
      }
      EXPECT_EQ(first, std::ssize(own));
    });
    EXPECT_TRUE(std::ranges::all_of(times, [](int n) { return n == 1; })) << ranks;
  }
}

TEST(SamplersOnRanks, ABoxIsTheSame) {
  for (const bool disordered : {false, true}) {
    expectSharedAlike<BoxSampler>(object({{"max", Value::Array{0.8, 0.8, 0.8}}, {"jitter", 0.3}}),
                                  disordered);
    // In rows.
    expectSharedAlike<BoxSampler>(object({{"max", Value::Array{0.81, 0.73, 0.69}}}), disordered);
  }
}

TEST(SamplersOnRanks, ASphereIsTheSame) {
  for (const bool disordered : {false, true})
    expectSharedAlike<SphereSampler>(object({{"radius", 0.47}}), disordered);
}

TEST(SamplersOnRanks, AMeshIsTheSame) {
  expectSharedAlike<MeshSampler>(object({}), false);
}

TEST(SamplersOnRanks, WhereOthersReadTheParticlesEachHasAll) {
  const Value box = object({{"max", Value::Array{0.4, 0.4, 0.4}}});
  runOnThreads(2, [&](Communicator& ranks) {
    OneRank<BoxSampler, Reader<>> whole(box, false, &ranks);
    EXPECT_EQ(whole.sampler().part(), nullptr);
    EXPECT_EQ(whole.positions().size(), 8000u);
    EXPECT_EQ(whole.sampled(), 8000);
  });
}

TEST(SamplersOnRanks, WhatHoldsNoParticleIsRefusedOnAllAlike) {
  const Error error = errorOf([&] {
    runOnThreads(2, [&](Communicator& ranks) {
      OneRank<MeshSampler>(object({{"margin", 1}}), false, &ranks);
    });
  });
  EXPECT_EQ(error.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(error.what(), "no particle fits in");
}

/// The last chunk of a lattice ends at the far corner of its box, whatever its numbers.
TEST(Lattice, MayHaveMoreNodesThan32BitsCount) {
  constexpr int kRanks = 8;
  constexpr float kSpacing = 1;
  for (const Vec3f& size : {Vec3f{2000, 2000, 2000},         // 8e9, whole
                            Vec3f{10.5f, 30'000, 30'000},    // in rows
                            Vec3f{3.4f, 50'000, 45'000}}) {  // whose number times nodes has more than 64 bits
    const Lattice lattice = Lattice::filling({{}, size}, kSpacing, kRanks);
    const double volume = double(size.x) * size.y * size.z;
    EXPECT_NEAR(double(lattice.size()) / volume, 1, 0.01);
    const std::int64_t chunks = (lattice.size() + LatticeShare::kChunk - 1) / LatticeShare::kChunk;
    const LatticePoints last = sampleLattice(lattice, {chunks - 1, chunks}, {}, 1);
    ASSERT_EQ(last.size(), 1u);
    EXPECT_EQ(std::ssize(last[0]), lattice.size() - (chunks - 1) * LatticeShare::kChunk);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(last[0].back()[axis], size[axis] - 0.5f * kSpacing, 0.3f) << size[axis];
    EXPECT_THROW(Lattice::filling({{}, size}, kSpacing), Error);
  }
}

}  // namespace
}  // namespace weir::test
