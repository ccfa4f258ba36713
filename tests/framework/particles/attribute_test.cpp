// Attributes by their handles, leased scratch memory, and by-products that go with what they were made from.
#include "framework/particles/attribute.h"

#include <gtest/gtest.h>

#include <optional>

#include "framework/particles/particle_set.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// As a kernel that only reads takes it.
std::int64_t sizeOf(ArrayView<const float> elements) {
  return elements.size;
}

constexpr ByProduct<float> kSums{"sums of a test"};

/// A few particles in a row.
class AttributeTest : public OnDevice {
 protected:
  static constexpr int kCount = 5;

  void SetUp() override {
    OnDevice::SetUp();
    set_.emplace(*device);
    std::vector<Vec3f> positions, velocities;
    for (int i = 0; i < kCount; ++i) positions.push_back({float(i), 0, 0}), velocities.push_back({0, 1, 0});
    batch_.assign(*device, positions, velocities);
    set_->append(batch_);
    heat_ = set_->add<float>({.name = "heat", .unit = "J", .doc = ""});
  }
  void TearDown() override { set_.reset(); }

  ParticleSet& set() { return *set_; }
  void turnAround() {
    std::vector<int> order;
    for (int i = set().bound() - 1; i >= 0; --i) order.push_back(i);
    const Array<int> onDevice(*device, order);
    set().permute(onDevice.view());
  }
  std::vector<std::pair<std::string, std::function<void()>>> rearrangements() {
    return {{"permute", [this] { turnAround(); }},
            {"append", [this] { set().append(batch_); }},
            {"clear", [this] { set().clear(); }}};
  }

  std::optional<ParticleSet> set_;
  ParticleBatch batch_;
  Attribute<float> heat_;
};
WEIR_ON_EVERY_DEVICE(AttributeTest);

TEST_P(AttributeTest, WritingEndsTheVersionOfThatAttributeAlone) {
  const Version heat = heat_.version(), positions = set().positions().version();
  heat_.read();
  heat_.toHost(kCount);
  set().get<float>("heat").read();
  EXPECT_TRUE(heat.isPresent()) << "reading changes nothing";
  heat_.write();
  EXPECT_FALSE(heat.isPresent());
  EXPECT_TRUE(positions.isPresent());
  const Version written = heat_.version();
  EXPECT_TRUE(written.isPresent());
  heat_.assign(std::vector<float>{1, 2});
  EXPECT_FALSE(written.isPresent());
  const Version assigned = heat_.version();
  heat_.fillZero();
  EXPECT_FALSE(assigned.isPresent());
  EXPECT_EQ(heat_.toHost(2), (std::vector<float>{0, 0}));
}

TEST_P(AttributeTest, EveryVersionEndsWhereParticlesAreRearranged) {
  for (const auto& [name, rearrange] : rearrangements()) {
    const Version heat = heat_.version(), positions = set().positions().version();
    rearrange();
    EXPECT_FALSE(heat.isPresent()) << name;
    EXPECT_FALSE(positions.isPresent()) << name;
  }
}

TEST_P(AttributeTest, AMotionThatIsPutOffEndsTheVersionsOfWhatMoves) {
  const Version heat = heat_.version(), positions = set().positions().version(),
                velocities = set().velocities().version();
  set().move({{0, 0, 2}, 0.5f});
  EXPECT_TRUE(heat.isPresent());
  EXPECT_FALSE(positions.isPresent());
  EXPECT_FALSE(velocities.isPresent());
  // Whoever reads, by a set that is const or not, reads what has moved, and does not move it again.
  const Version noted = set().positions().version();
  EXPECT_EQ(std::as_const(set()).velocities().toHost(1).front(), (Vec3f{0, 1, 1}));
  EXPECT_EQ(set().positions().toHost(2).back(), (Vec3f{1, 0.5f, 0.5f}));
  EXPECT_TRUE(noted.isPresent());
}

TEST_P(AttributeTest, AViewThatIsKeptTooLongFailsAndItsHandleDoesNot) {
  for (const auto& [name, rearrange] : rearrangements()) {
    const auto heat = heat_.write();
    const auto positions = set().positions().read();
    EXPECT_EQ(sizeOf(heat), set().capacity());
    rearrange();
    EXPECT_THROW(heat.view(), InternalError) << name;
    EXPECT_THROW(positions.data(), InternalError) << name;
    EXPECT_THROW(sizeOf(heat), InternalError) << name;
    EXPECT_EQ(heat_.write().size(), set().capacity()) << name;
  }
}

TEST_P(AttributeTest, AViewOfWhatHasNotMovedYetFails) {
  const auto positions = set().positions().read();
  const auto velocities = set().velocities().write();
  const auto heat = heat_.read();
  set().move({{0, 0, 2}, 0.5f});
  EXPECT_THROW(positions.view(), InternalError);
  EXPECT_THROW(velocities.view(), InternalError);
  EXPECT_NO_THROW(heat.view());
}

TEST_P(AttributeTest, AHandleOfParticlesThatAreNoMoreFails) {
  const auto heat = heat_.read();
  const Version version = heat_.version();
  EXPECT_TRUE(heat_);
  set_.emplace(*device);
  EXPECT_FALSE(heat_);
  EXPECT_THROW(heat_.read(), InternalError);
  EXPECT_THROW(heat.view(), InternalError);
  EXPECT_FALSE(version.isPresent());
  EXPECT_THROW(Attribute<int>().write(), InternalError);
}

TEST_P(AttributeTest, IsFoundByItsNameAndType) {
  EXPECT_TRUE(set().get<float>("heat") == heat_);
  EXPECT_TRUE(set().add<float>({.name = "heat", .unit = {}, .doc = {}}) == heat_);
  EXPECT_EQ(heat_.info().unit, "J");
  EXPECT_THROW(set().get<int>("heat"), InternalError);
  EXPECT_THROW(set().get<float>("cold"), InternalError);
  EXPECT_CONTAINS(errorOf([&] { set().add<Mat3f>({.name = "heat", .unit = {}, .doc = {}}); }).message(),
                  "'heat'");
}

TEST_P(AttributeTest, TakesTheMemoryOfALease) {
  const Attribute<Vec3f> velocities = set().velocities();
  const auto before = velocities.read();
  const Version version = velocities.version();
  const std::vector<Vec3f> faster(kCount, Vec3f{3, 2, 1}), slower = velocities.toHost(kCount);
  {
    const Lease<Vec3f> room = set().leaseVectors();
    device->upload(room.data(), faster.data(), faster.size() * sizeof(Vec3f));
    velocities.swap(room);
    std::vector<Vec3f> left(kCount);
    device->download(left.data(), room.data(), left.size() * sizeof(Vec3f));
    EXPECT_EQ(left, slower);
  }
  EXPECT_EQ(velocities.toHost(kCount), faster);
  EXPECT_FALSE(version.isPresent());
  EXPECT_THROW(before.view(), InternalError);
}

TEST_P(AttributeTest, ARoomIsLentToOneAtATime) {
  const Lease<Vec3f> vectors = set().leaseVectors();
  EXPECT_GE(vectors.size(), kCount);
  EXPECT_THROW(set().leaseVectors(), InternalError);
  {
    Lease<Vec4f> wide = set().leaseWide();
    const Lease<Vec4f> places = set().leasePlaces();
    EXPECT_NE(wide.data(), places.data());
    EXPECT_THROW(set().leasePlaces(), InternalError);
    EXPECT_THROW(set().leaseWide(), InternalError);
    EXPECT_THROW(set().leaseUnordered(1), InternalError);
    const Lease<Vec4f> moved = std::move(wide);
    EXPECT_THROW(set().leaseWide(), InternalError) << "a lease may change hands";
    EXPECT_THROW(wide.view(), InternalError);
  }
  EXPECT_GE(set().leaseUnordered(10'000).size(), 10'000);
  EXPECT_GE(set().leaseWide().size(), kCount);
}

TEST_P(AttributeTest, ParticlesAreNotRearrangedWhileScratchMemoryIsLent) {
  for (const auto& [name, rearrange] : rearrangements()) {
    {
      const Lease<Vec4f> room = set().leasePlaces();
      EXPECT_THROW(rearrange(), InternalError) << name;
    }
    {
      const Lease<Vec4f> unordered = set().leaseUnordered(1);
      EXPECT_NO_THROW(rearrange()) << name;
    }
  }
}

TEST_P(AttributeTest, AByProductIsThereAsLongAsItIsTrue) {
  ByProducts& byProducts = set().byProducts();
  EXPECT_EQ(byProducts.find(kSums).size, 0);
  const auto keep = [&] {
    const Lease<Vec3f> room = set().leaseVectors();
    byProducts.keep<float>(kSums, {reinterpret_cast<const float*>(room.data()), kCount},
                           {heat_.version(), room.version()});
  };
  keep();
  EXPECT_EQ(byProducts.find(kSums).size, kCount);
  set().positions().write();
  set().leasePlaces();
  EXPECT_EQ(byProducts.find(kSums).size, kCount) << "it was made from neither";
  heat_.write();
  EXPECT_EQ(byProducts.find(kSums).size, 0) << "what it was made from may have changed";
  keep();
  set().leaseVectors();
  EXPECT_EQ(byProducts.find(kSums).size, 0) << "its memory was lent to somebody else";
  for (const auto& [name, rearrange] : rearrangements()) {
    keep();
    rearrange();
    EXPECT_EQ(byProducts.find(kSums).size, 0) << name;
  }
  keep();
  byProducts.forget(kSums);
  EXPECT_EQ(byProducts.find(kSums).size, 0);
  EXPECT_FALSE(byProducts.isRequested(kSums));
  byProducts.request(kSums);
  EXPECT_TRUE(byProducts.isRequested(kSums));
}

TEST_P(AttributeTest, ATensorStartsAsZeroAndIsSavedAndRestored) {
  const Attribute<Mat3f> stress = set().add<Mat3f>({.name = "stress", .unit = "Pa", .doc = ""});
  EXPECT_EQ(set().find("stress")->type, AttributeType::kMat3);
  EXPECT_EQ(stress.toHost(kCount), std::vector<Mat3f>(kCount));
  std::vector<Mat3f> values;
  for (int i = 0; i < kCount; ++i) {
    const auto x = float(i);
    values.push_back({{{x, 1, 2}, {3, 4, 5}, {6, 7, 8}}});
  }
  stress.assign(values);
  set().append(batch_);
  turnAround();
  set().refreshCount();
  StateArrays arrays;
  set().save(StateWriter(arrays));
  EXPECT_EQ(arrays.at("stress").kind, StateKind::kFloat);
  EXPECT_EQ(arrays.at("stress").columns, 9);

  ParticleSet other(*device);
  const Attribute<Mat3f> restored = other.add<Mat3f>({.name = "stress", .unit = "Pa", .doc = ""});
  other.add<float>({.name = "heat", .unit = "J", .doc = ""});
  other.restore(StateReader(arrays));
  std::vector<Mat3f> expected(kCount);  // of those that were born without stress
  expected.insert(expected.end(), values.rbegin(), values.rend());
  EXPECT_EQ(restored.toHost(2 * kCount), expected);
}

TEST(AttributeTypes, AreFoundByTheirNames) {
  EXPECT_EQ(attributeTypeNames(), (std::vector<std::string>{"float", "vec3", "int", "mat3", "int64"}));
  for (const std::string& name : attributeTypeNames()) EXPECT_EQ(nameOf(*attributeTypeNamed(name)), name);
  EXPECT_FALSE(attributeTypeNamed("double"));
  EXPECT_EQ(numbersIn(AttributeType::kMat3), 9);
  EXPECT_EQ(componentsOf(AttributeType::kMat3).at(5), "yz");
  EXPECT_TRUE(isWhole(AttributeType::kInt));
  EXPECT_TRUE(isWhole(AttributeType::kInt64));
  EXPECT_FALSE(isWhole(AttributeType::kMat3));
}

}  // namespace
}  // namespace weir::test
