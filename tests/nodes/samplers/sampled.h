// A sampler in a scene with something that asks it for a spacing.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "framework/particles/particle_batch.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {

/// Asks for a spacing, like a fluid.
class Asker final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Asker", "Asks for a spacing."};
  const NodeInfo& info() const override { return kInfo; }
  Inputs<ParticleBatch> in{*this, "in", "Particles."};
  float spacing = 0.1f;
  float supportRatio = 1.5f;
  bool disordered = false;
  void configure(const SetupContext&) override { in.request({spacing, supportRatio, disordered}); }
  void reset(const SetupContext&) override {}
};

template <class S>
class Sampled {
 public:
  explicit Sampled(const Value& parameters, float spacing, const std::string& device = "cpu", int threads = 0)
      : device_(openDevice(device, threads)) {
    node_ = static_cast<S*>(&graph_.add(std::make_unique<S>(), "block"));
    asker_ = static_cast<Asker*>(&graph_.add(std::make_unique<Asker>(), "asker"));
    asker_->spacing = spacing;
    graph_.link(SceneGraph::parseLink("block.particles -> asker.in"));
    node_->assignAll(parameters, {});
  }
  S& node() { return *node_; }
  Asker& asker() { return *asker_; }
  SceneGraph& graph() { return graph_; }
  std::vector<Vec3f> positions(std::int64_t seed = 1) {
    warnings.clear();
    graph_.reset({*device_, log_, registry_, {}, 1e-3, seed});
    EXPECT_EQ(node_->particles->positions.size(), node_->particles->count);
    EXPECT_EQ(node_->particles->velocities.size(), 0);  // all have the same
    return node_->particles->positions.toHost();
  }
  std::vector<Vec3f> velocities() const {
    return std::vector<Vec3f>(static_cast<std::size_t>(node_->particles->count), node_->particles->velocity);
  }
  void step(std::int64_t index) { graph_.step({*device_, log_, {}, 1e-3 * double(index), 1e-3, index}); }

  std::vector<std::string> warnings;

 private:
  std::unique_ptr<Device> device_;
  Log log_{[this](LogLevel, std::string_view text) { warnings.emplace_back(text); }};
  Registry registry_;
  SceneGraph graph_;
  S* node_;
  Asker* asker_;
};

}  // namespace weir::test
