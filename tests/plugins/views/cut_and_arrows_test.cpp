// Clip planes, slices and arrows.
#include <gtest/gtest.h>

#include "framework/base/error.h"
#include "framework/scene/scene_file.h"
#include "plugins/views/shown_particles.h"
#include "plugins/views/velocity_arrows.h"
#include "tests/support/devices.h"

namespace weir::rendering {
namespace {

class CutAndArrows : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Device> device = openDevice(GetParam());
  RenderSettings settings;
  std::vector<Vec3f> positions, velocities;
  std::vector<float> values;

  CutAndArrows() {
    for (int i = 0; i < 10; ++i) {
      positions.push_back({0.1f * static_cast<float>(i), 1, 0});
      velocities.push_back({0, static_cast<float>(i), 0});
      values.push_back(static_cast<float>(i));
    }
  }

  void set(const std::string& json) { settings.assignAll(parseJson(json, "render"), {}); }

  std::vector<Cut> cuts() const { return cutsOf(settings.clips); }

  std::vector<float> shownValues() {
    FluidSnapshot fluid(*device);
    fluid.colorType = AttributeType::kFloat;
    const auto count = static_cast<std::int64_t>(positions.size());
    fluid.positions.start(Array<Vec3f>(*device, std::span<const Vec3f>(positions)), count);
    fluid.numbers<float>().start(Array<float>(*device, std::span<const float>(values)), count);
    ShownParticles shown(*device);
    shown.load(fluid, {});
    shown.cut(cuts());
    ParticleView view;
    shown.give(view, false);
    EXPECT_EQ(view.positions.size(), view.values.size());
    for (std::size_t i = 0; i < view.values.size(); ++i)
      EXPECT_EQ(view.positions[i], positions[static_cast<std::size_t>(view.values[i])]);
    return {view.values.begin(), view.values.end()};
  }
};

INSTANTIATE_TEST_SUITE_P(Devices, CutAndArrows, testing::ValuesIn(test::availableDevices()),
                         [](const auto& tested) { return tested.param; });

TEST_P(CutAndArrows, APlaneHidesWhatIsAboveIt) {
  set(R"({"clips": [{"point": [0.35, 5, 5], "normal": [3, 0, 0]}]})");
  EXPECT_EQ(shownValues(), (std::vector<float>{0, 1, 2, 3}));
}

TEST_P(CutAndArrows, ASliceHasTwoSidesAndPlanesAddUp) {
  set(R"({"clips": [{"point": [0.5, 0, 0], "normal": [1, 0, 0], "thickness": 0.5}]})");
  EXPECT_EQ(shownValues(), (std::vector<float>{3, 4, 5, 6, 7}));
  set(R"({"clips": [{"point": [0.5, 0, 0], "normal": [1, 0, 0], "thickness": 0.5},
                    {"point": [0.45, 0, 0], "normal": [-1, 0, 0]}]})");
  EXPECT_EQ(shownValues(), (std::vector<float>{5, 6, 7}));
}

TEST_P(CutAndArrows, BadPlanesAndColoursAreRefused) {
  EXPECT_THROW(set(R"({"clips": [{"normal": [0, 0, 0]}]})"), Error);
  EXPECT_THROW(set(R"({"color": {"table": [[0, 0, 0]]}})"), Error);
  EXPECT_THROW(set(R"({"color": {"table": [[0, 0, 0], [1, 255, 0]]}})"), Error);
}

TEST_P(CutAndArrows, AnArrowHasTheMeanOfItsCube) {
  const Vec3f eye{0.45f, 1, 100};
  std::vector<Vec3f> lines;
  addVelocityArrows(positions, velocities, cuts(), 4, 0.5f, eye, lines);
  ASSERT_EQ(lines.size(), 6u);
  // From the eye it looks like one from the mean place (0.45, 1, 0) with 0.5 s of the mean speed 4.5 m/s.
  const auto seen = [&](const Vec3f& p) { return eye + (p - eye) * (eye.z / (eye.z - p.z)); };
  EXPECT_NEAR(seen(lines[0]).x, 0.45f, 1e-4f);
  EXPECT_NEAR(seen(lines[0]).y, 1, 1e-4f);
  EXPECT_NEAR(seen(lines[1]).x, 0.45f, 1e-4f);
  EXPECT_NEAR(seen(lines[1]).y, 1 + 2.25f, 1e-4f);
  EXPECT_NEAR(lines[0].z, 4, 1e-3f) << "one spacing nearer";
  EXPECT_NEAR(lines[3].x + lines[5].x, 2 * lines[1].x, 1e-4f) << "the head is even";
}

TEST_P(CutAndArrows, HiddenRestingAndLostParticlesHaveNoArrows) {
  std::vector<Vec3f> lines;
  const Vec3f eye{0, 0, 100};
  set(R"({"clips": [{"point": [0.05, 0, 0], "normal": [1, 0, 0]}]})");  // leaves the one that rests
  addVelocityArrows(positions, velocities, cuts(), 0.1f, 1, eye, lines);
  EXPECT_TRUE(lines.empty());
  set(R"({"clips": []})");
  positions[4].x = velocities[5].z = std::nanf("");
  addVelocityArrows(positions, velocities, cuts(), 4, 1, eye, lines);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_NEAR(length(lines[1] - lines[0]), 4.5f * (1 - 4 / 100.0f), 0.01f)
      << "the mean of the eight that are left";
}

TEST(OwnColorMap, IsLinearBetweenItsColours) {
  const ColorMap map(std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0.5f}, {1, 1, 1}});
  EXPECT_EQ(map.at(0), (Vec3f{0, 0, 0}));
  EXPECT_EQ(map.at(0.25f), (Vec3f{0.5f, 0, 0.25f}));
  EXPECT_EQ(map.at(0.5f), (Vec3f{1, 0, 0.5f}));
  EXPECT_EQ(map.at(2), (Vec3f{1, 1, 1}));
  EXPECT_EQ(map.at(std::nanf("")), ColorMap().at(std::nanf("")));
}

}  // namespace
}  // namespace weir::rendering
