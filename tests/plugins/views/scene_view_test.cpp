// Views of frames whose particles stay on the device, beside views of the same frame on the host, and beside
// what the test finds in the frame by itself.
#include "plugins/views/scene_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "framework/scene/scene_file.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/white_water/white_water.h"
#include "plugins/views/scene_capture.h"
#include "tests/plugins/rendering/gl/pictures.h"

namespace weir::rendering {
namespace {

class SceneViews : public testing::TestWithParam<std::string> {
 protected:
  std::unique_ptr<Device> device = openDevice(GetParam());
  gl::Renderer renderer{gl::makeContext(), openDevice(GetParam()), gl::ComputeShare::kWhatCanBe};
  RenderSettings settings;
  std::vector<Vec3f> positions, velocities;
  std::vector<float> heights;
  std::vector<int> numbers;
  SceneSnapshot snapshot;

  SceneViews() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> part(0, 1);
    for (int i = 0; i < 4000; ++i) {
      positions.push_back({2 * part(random) - 1, part(random), 2 * part(random) - 1});
      velocities.push_back({part(random), -3 * part(random), part(random)});
      heights.push_back(10 * positions.back().y);
      numbers.push_back(i / 100);
    }
    positions[7].x = heights[9] = velocities[11].y = std::nanf("");
    set(R"({"width": 200, "height": 120})");
    auto still = std::make_shared<StillScene>();
    still->bounds = {{-1, 0, -1}, {1, 1, 1}};
    snapshot.still = std::move(still);
  }

  void set(const std::string& json) { settings.assignAll(parseJson(json, "render"), {}); }

  template <class T>
  Array<T> onDevice(const std::vector<T>& values) {
    return Array<T>(*device, std::span<const T>(values));
  }

  /// The particles coloured by an attribute of this type, on their way.
  void capture(AttributeType colorType) {
    if (snapshot.fluids.empty()) snapshot.fluids.emplace_back(*device);
    FluidSnapshot& fluid = snapshot.fluids[0];
    const auto count = static_cast<std::int64_t>(positions.size());
    fluid.spacing = 0.1f;
    fluid.colorType = colorType;
    fluid.positions.start(onDevice(positions), count);
    fluid.velocities.start(onDevice(velocities), count);
    if (colorType == AttributeType::kFloat) fluid.numbers<float>().start(onDevice(heights), count);
    if (colorType == AttributeType::kVec3) fluid.numbers<Vec3f>().start(onDevice(velocities), count);
    if (colorType == AttributeType::kInt) fluid.numbers<int>().start(onDevice(numbers), count);
  }

  /// By both ways, which must be the same.
  Picture picture(bool fromDevice = true) {
    SceneView one(settings, *settings.camera, renderer), other(settings, *settings.camera, renderer);
    const View there = one.of(snapshot);
    EXPECT_EQ(there.particles[0].onDevice, fromDevice);
    Picture found = renderer.draw(there);
    const View here = other.of(snapshot, ParticlePlace::kHost);
    EXPECT_FALSE(here.particles[0].onDevice);
    EXPECT_EQ(found.rgb, renderer.draw(here).rgb);
    return found;
  }

  /// The particles that the test itself gives a view.
  Picture expected(std::vector<Vec3f> places, std::vector<float> values, float low, float high) {
    SceneView view(settings, *settings.camera, renderer);
    View plain = view.of(snapshot, ParticlePlace::kHost);
    plain.particles[0].positions = places;
    plain.particles[0].values = values;
    plain.particles[0].lowest = low;
    plain.particles[0].highest = high;
    return renderer.draw(plain);
  }
};

INSTANTIATE_TEST_SUITE_P(Devices, SceneViews, testing::ValuesIn(test::availableDevices()),
                         [](const auto& tested) { return tested.param; });

TEST_P(SceneViews, OfSpheresColouredByAnyAttribute) {
  capture(AttributeType::kFloat);
  EXPECT_EQ(picture().rgb, expected(positions, heights, 0, 10).rgb);
  capture(AttributeType::kInt);
  const std::vector<float> floats(numbers.begin(), numbers.end());
  EXPECT_EQ(picture().rgb, expected(positions, floats, 0, 40).rgb);
  capture(AttributeType::kVec3);
  std::vector<float> speeds;
  for (const Vec3f& v : velocities) speeds.push_back(std::hypot(v.x, v.y, v.z));
  // Nobody is faster than 3.32 m/s. Colours may be rounded the other way.
  EXPECT_LE(largestDifference(picture(), expected(positions, speeds, 0, 3.5f)), 1);
}

TEST_P(SceneViews, OfWhiteSpheres) {
  capture(AttributeType::kFloat);
  snapshot.fluids[0].colorType = std::nullopt;
  snapshot.fluids[0].white = true;
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot, ParticlePlace::kHost);
  EXPECT_TRUE(seen.particles[0].values.empty());
  EXPECT_EQ(seen.particles[0].fixed, kWhite);
  EXPECT_FALSE(view.colorKey().shown);
}

TEST_P(SceneViews, OfWhiteWaterWhoseRadiiSpreadAndFollowItsKinds) {
  constexpr float kMean = 0.05f;  // of the spacing 0.1
  for (std::size_t i = 0; i < heights.size(); ++i) {
    heights[i] = kMean * (0.5f + static_cast<float>(i) / static_cast<float>(heights.size()));
    numbers[i] = static_cast<int>(i % 3);
  }
  set(R"({"clips": [{"point": [0.1, 0, 0], "normal": [1, 0, 0]}]})");
  capture(AttributeType::kFloat);
  FluidSnapshot& fluid = snapshot.fluids[0];
  fluid.white = fluid.kinds = true;
  fluid.numbers<int>().start(onDevice(numbers), static_cast<std::int64_t>(numbers.size()));
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot, ParticlePlace::kHost);
  EXPECT_TRUE(seen.particles[0].white);
  EXPECT_TRUE(seen.particles[0].values.empty()) << "radii are no colours";
  std::vector<float> wanted;
  for (std::size_t i = 0; i < heights.size(); ++i)
    if (positions[i].x <= 0.1f)
      wanted.push_back((numbers[i] == 1 ? 0.5f : 0.3f) * heights[i] * heights[i] / kMean);
  ASSERT_EQ(seen.particles[0].radii.size(), wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    ASSERT_NEAR(seen.particles[0].radii[i], wanted[i], 1e-6f * wanted[i]) << i;
}

TEST_P(SceneViews, OfLiquidsWhoseLoneParticlesAreDrops) {
  // 4,000 in 4 cubic metres are 0.1 m apart, so most have others near them.
  positions[5] = {7, 8, 9};
  set(R"({"fluids": [{"node": "water", "look": "water"}], "clips": [{"point": [8, 0, 0], "normal": [1, 0, 0]}]})");
  capture(AttributeType::kFloat);
  FluidSnapshot& fluid = snapshot.fluids[0];
  fluid.node = "water";
  fluid.look = &settings.fluids[0];
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot, ParticlePlace::kHost);
  ASSERT_EQ(seen.particles.size(), 2U);
  const ParticleView &liquid = seen.particles[0], &spray = seen.particles[1];
  EXPECT_TRUE(liquid.water);
  EXPECT_EQ(liquid.foam.size(), liquid.positions.size());
  EXPECT_FALSE(spray.water);
  EXPECT_TRUE(spray.white && spray.values.empty());
  EXPECT_LT(spray.radius, 0.5f * liquid.radius);
  EXPECT_LT(spray.positions.size(), liquid.positions.size());
  EXPECT_EQ(liquid.positions.size() + spray.positions.size(), positions.size() - 1);  // one is nowhere
  const auto is = [](const Vec3f& p) { return p.x == 7; };
  EXPECT_TRUE(std::any_of(spray.positions.begin(), spray.positions.end(), is));
  EXPECT_FALSE(std::any_of(liquid.positions.begin(), liquid.positions.end(), is));
  fluid.spacing = 0.004f;  // drops of it hold together
  EXPECT_EQ(view.of(snapshot, ParticlePlace::kHost).particles.size(), 1U);
}

TEST_P(SceneViews, HaveFoamOnTheSurfacesThatItCovers) {
  std::fill(heights.begin(), heights.end(), 0.05f);
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<int>(i % 3);
  capture(AttributeType::kFloat);
  FluidSnapshot& fluid = snapshot.fluids[0];
  fluid.white = fluid.kinds = true;
  fluid.numbers<int>().start(onDevice(numbers), static_cast<std::int64_t>(numbers.size()));
  const DynamicMesh mesh{onDevice<Vec3f>({{0, 0.5f, 0}, {0.1f, 0.5f, 0}, {9, 0.5f, 0}}),
                         onDevice<Vec3f>({{0, 1, 0}, {0, 1, 0}, {0, 1, 0}}), onDevice<Vec3i>({{0, 2, 1}})};
  FluidSurfaceSnapshot& surface = snapshot.fluidSurfaces.emplace_back(*device);
  surface.mesh.start(mesh);
  SceneView plain(settings, *settings.camera, renderer);
  const View without = plain.of(snapshot, ParticlePlace::kHost);
  EXPECT_TRUE(without.surfaces[0].foam.empty()) << "unless the capture asks for it";
  surface.foamReach = 0.2f;
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot, ParticlePlace::kHost);
  ASSERT_EQ(seen.surfaces[0].foam.size(), 3U);
  EXPECT_GT(seen.surfaces[0].foam[0], 0);
  EXPECT_EQ(seen.surfaces[0].foam[2], 0);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const float away =
        std::min(length(positions[i] - Vec3f{0, 0.5f, 0}), length(positions[i] - Vec3f{0.1f, 0.5f, 0}));
    const bool lies = numbers[i] == 1 && away < 0.2f;
    ASSERT_EQ(seen.particles[0].radii[i] == 0, lies) << i;
  }
}

TEST(WhiteLook, IsThatOfWhiteWaterUnlessTheSceneSaysOtherwise) {
  RenderSettings settings;
  WhiteWater foam;
  ParticleFluid water;
  foam.setName("foam");
  water.setName("water");
  EXPECT_TRUE(isWhite(settings, foam));
  EXPECT_FALSE(isWhite(settings, water));
  settings.assignAll(
      parseJson(R"({"fluids": [{"node": "foam", "look": "spheres"}, {"node": "water", "look": "white"}]})",
                "render"),
      {});
  EXPECT_FALSE(isWhite(settings, foam));
  EXPECT_TRUE(isWhite(settings, water));
}

TEST_P(SceneViews, AreOfTheFrameThatWasCapturedLast) {
  capture(AttributeType::kFloat);
  const Picture before = picture();
  positions.resize(40);
  heights.resize(40);
  for (Vec3f& p : positions) p.y = 1 - p.y;
  heights[0] = 0, heights[1] = 9.5f;
  capture(AttributeType::kFloat);
  const Picture after = picture();
  EXPECT_NE(after.rgb, before.rgb);
  EXPECT_EQ(after.rgb, expected(positions, heights, 0, 10).rgb);
  positions.clear();
  heights.clear();
  capture(AttributeType::kFloat);
  EXPECT_EQ(picture().rgb, expected({}, {}, 0, 1).rgb);
}

TEST_P(SceneViews, OfWhatCutsLeave) {
  set(R"({"clips": [{"point": [0.1, 0, 0], "normal": [1, 0, 0]},
                    {"point": [0, 0.5, 0], "normal": [0, 1, 0], "thickness": 0.6}]})");
  capture(AttributeType::kFloat);
  std::vector<Vec3f> places;
  std::vector<float> values;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!(positions[i].x <= 0.1f && std::fabs(positions[i].y - 0.5f) <= 0.3f)) continue;
    places.push_back(positions[i]);
    values.push_back(heights[i]);
  }
  ASSERT_GT(places.size(), 1000u);
  EXPECT_EQ(picture().rgb, expected(places, values, 0, 10).rgb) << "colours mean the same as without cuts";
}

TEST_P(SceneViews, FollowTheMiddleAndSeeAllOfWhatTheyShow) {
  set(R"({"camera": {"follow": "water"}})");
  snapshot.still = std::make_shared<StillScene>();  // no bounds: particles make them
  capture(AttributeType::kFloat);
  snapshot.fluids[0].node = "water";
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot);
  Aabb box;
  Vec3d sum;
  int count = 0;
  for (const Vec3f& p : positions) {
    if (!isFinite(p)) continue;
    box.extend(p);
    sum += Vec3d{p.x, p.y, p.z};
    ++count;
  }
  EXPECT_EQ(seen.ground.center, box.center());
  EXPECT_LT(length(Vec3d{seen.camera.target.x, seen.camera.target.y, seen.camera.target.z} - sum / count),
            1e-6);
}

TEST_P(SceneViews, OfSurfacesOfTheSameWaterShareOne) {
  auto still = std::make_shared<StillScene>(*snapshot.still);
  for (const float scattering : {0.1f, 2.0f, 0.1f})
    still->surfaces.push_back({.look = SurfaceLook::kWater, .water = WaterView{.scattering = scattering}});
  snapshot.still = std::move(still);
  snapshot.poses.resize(3);
  snapshot.posesBefore.resize(3);
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot);
  ASSERT_EQ(seen.waters.size(), 2U);
  for (const std::size_t i : {0, 1, 2})
    EXPECT_EQ(seen.waters[seen.surfaces[i].water].scattering, i == 1 ? 2.0f : 0.1f) << i;
}

TEST_P(SceneViews, WithArrows) {
  set(R"({"arrows": {"spacing": 0.5, "seconds": 0.2}})");
  capture(AttributeType::kFloat);
  const Picture with = picture();
  set(R"({"arrows": {"spacing": 3, "seconds": 0.001}})");  // too short to be drawn
  EXPECT_NE(picture().rgb, with.rgb);
}

TEST_P(SceneViews, AreOnTheHostForWhatOpenGlDraws) {
  set(R"({"fluids": [{"node": "water", "foam": {"by": "height", "range": [8, 2]}}]})");
  capture(AttributeType::kFloat);
  snapshot.fluids[0].look = &settings.fluids[0];
  snapshot.fluids[0].spacing = 0.3f;  // so that none is lone
  const Picture water = picture(false);
  SceneView view(settings, *settings.camera, renderer);
  const View seen = view.of(snapshot);
  ASSERT_EQ(seen.particles[0].foam.size(), heights.size());
  for (std::size_t i = 0; i < heights.size(); ++i) {
    const float part = std::isnan(heights[i]) ? 0 : std::clamp((8 - heights[i]) / 6, 0.0f, 1.0f);
    ASSERT_NEAR(seen.particles[0].foam[i], part, 1e-6f) << i;
  }
  set(R"({"environment": {"look": "sky"}, "fluids": []})");
  snapshot.fluids[0].look = nullptr;
  EXPECT_NE(picture(false).rgb, water.rgb);
}

}  // namespace
}  // namespace weir::rendering
