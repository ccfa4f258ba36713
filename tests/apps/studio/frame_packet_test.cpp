// Frames for viewers hold the particles of every node that puts some out, fluids or not.
#include "apps/studio/session/frame_packet.h"

#include <gtest/gtest.h>

#include <cstring>

#include "apps/studio/session/particle_values.h"
#include "framework/particles/particles.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"

namespace weir::studio {
namespace {

/// Three points that are not a fluid; one of its kind with `empty` never makes any.
class Dust final : public Node {
 public:
  static constexpr NodeInfo kInfo{"Dust", "Three points."};
  const NodeInfo& info() const override { return kInfo; }
  Param<bool> empty{*this, "empty", false, {.doc = "Makes no particles."}};
  Output<Particles> particles{*this, "particles", "The points."};

  void reset(const SetupContext& context) override {
    if (empty) return;
    set_ = std::make_unique<ParticleSet>(context.device);
    ParticleBatch batch;
    batch.assign(context.device, std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}, Vec3f{0, 0, 3});
    set_->append(batch);
    particles->material.spacing = 0.25f;
    particles->assign(*set_);
  }

 private:
  std::unique_ptr<ParticleSet> set_;
};

Value headerOf(const std::string& packet) {
  std::uint32_t length = 0;
  std::memcpy(&length, packet.data(), sizeof length);
  return parseJson(packet.substr(sizeof length, length), "packet");
}

class FramePacket : public testing::Test {
 protected:
  FramePacket() {
    registerNodes(registry_);
    registry_.addNode<Dust>();
    constexpr const char* kScene = R"({"weir": 1, "nodes": {
      "dust": {"type": "Dust"}, "nothing": {"type": "Dust", "params": {"empty": true}}}})";
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(kScene, "test"), {"test", "", "."}, registry_, {}, warnings);
    simulation = std::make_unique<Simulation>(std::move(scene), *device, log_, registry_);
    simulation->reset();
  }

  std::unique_ptr<Device> device = openDevice("cpu", 1);
  std::unique_ptr<Simulation> simulation;

 private:
  Registry registry_;
  Log log_;
};

TEST_F(FramePacket, HoldsParticlesThatAreNoFluid) {
  FrameMaker maker(*device);
  const Value header = headerOf(*maker.make(*simulation, {}));
  const auto& sources = header.find("fluids")->asArray();
  ASSERT_EQ(sources.size(), 1u) << "a node without particles is left out";
  EXPECT_EQ(sources[0].find("node")->asString(), "dust");
  EXPECT_EQ(sources[0].find("count")->asInt(), 3);
  EXPECT_EQ(sources[0].find("spacing")->asDouble(), 0.25);
  EXPECT_EQ(sources[0].find("high")->asArray().at(1).asDouble(), 2);
}

TEST_F(FramePacket, ParticlesThatAreNoFluidAreListed) {
  const Value particle = particleValue(*simulation, "dust", 2);
  const Value* attributes = particle.find("attributes");
  ASSERT_NE(attributes, nullptr);
  EXPECT_EQ(attributes->find("position")->asArray().at(1).asDouble(), 2);
  EXPECT_EQ(attributes->find("velocity")->asArray().at(2).asDouble(), 3);
  EXPECT_TRUE(particleValue(*simulation, "nothing", 0).isNull());
}

}  // namespace
}  // namespace weir::studio
