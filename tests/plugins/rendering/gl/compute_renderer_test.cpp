// Pictures by a compute device alone are those that OpenGL makes.
#include "plugins/rendering/compute/compute_renderer.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "framework/communication/thread_ranks.h"
#include "tests/plugins/rendering/gl/like_pictures.h"

namespace weir::rendering {
namespace {

class ComputedPictures : public testing::TestWithParam<std::string> {
 protected:
  gl::Renderer reference{gl::makeContext()};
  std::unique_ptr<Device> device = openDevice(GetParam());
  ComputeRenderer renderer{*device};

  ComputedPictures() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> part(0, 1);
    constexpr int kSide = 14;
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      const Vec3f cell{float(i % kSide), float(i / kSide % kSide), float(i / kSide / kSide)};
      const Vec3f jitter{part(random), part(random), part(random)};
      block.push_back((cell + jitter * 0.6f) * (2.0f / kSide) - Vec3f{1, 0, 1});
      values.push_back(part(random));
    }
    values[3] = std::nanf("");
    for (int i = 0; i < 12; ++i)
      drops.push_back({3 * part(random) - 1.5f, 2 + part(random), 3 * part(random) - 1.5f});
    for (const Vec3f& corner :
         {Vec3f{-1.2f, 0, -1.2f}, {1.2f, 0, -1.2f}, {1.2f, 0, 1.2f}, {-1.2f, 0, 1.2f}}) {
      edges.push_back(corner);
      edges.push_back({-corner.z, 0, corner.x});
      edges.push_back(corner);
      edges.push_back(corner + Vec3f{0, 2.2f, 0});
    }
    view.width = 400;
    view.height = 300;
    view.camera = {.eye = {2.5f, 3, 5}, .target = {0, 0.9f, 0}, .fovDegrees = 45};
    view.particles = {{.positions = block, .values = values, .radius = 1.0f / kSide},
                      {.positions = drops, .radius = 0.15f, .fixed = {0.9f, 0.2f, 0.1f, 1}}};
    view.ground.radius = 12;
    view.lines = {{.points = edges}};
  }

  /// Pixels differ by no more than two grey levels, but for one in two thousand: rounding may move an outline
  /// over a sample's middle, or a tap of the occlusion to the next sample.
  void expectSamePicture() {
    ASSERT_TRUE(ComputeRenderer::canDraw(view));
    const Picture wanted = reference.draw(view), found = renderer.draw(view);
    expectLike(wanted, found, view.width * view.height / 2000);
  }

  /// Of the particles of each view, one rank has those behind another's.
  Picture drawnByRanks(int count) {
    Picture picture;
    runOnThreads(count, [&](Communicator& ranks) {
      const std::unique_ptr<Device> own = openDevice(GetParam());
      ComputeRenderer drawing(*own);
      View part = view;
      for (ParticleView& particles : part.particles) {
        const auto placeOf = [&, all = particles.positions.size()](int rank) {
          return all * std::size_t(rank) / std::size_t(ranks.size());
        };
        const std::size_t first = placeOf(ranks.rank()), size = placeOf(ranks.rank() + 1) - first;
        particles.positions = particles.positions.subspan(first, size);
        if (!particles.values.empty()) particles.values = particles.values.subspan(first, size);
      }
      const SeenOfRanks seen = drawing.seenOf(part, ranks);
      part.particles.clear();
      if (ranks.rank() == 0) picture = drawing.draw(part, seen);
    });
    return picture;
  }

  std::vector<Vec3f> block, drops, edges;
  std::vector<float> values;
  View view;
};

INSTANTIATE_TEST_SUITE_P(Devices, ComputedPictures, testing::ValuesIn(test::availableDevices()),
                         [](const auto& tested) { return tested.param; });

TEST_P(ComputedPictures, AreThoseOfOpenGl) {
  expectSamePicture();
  view.worldUp = {0.2f, 1, 0.1f};
  view.lighting.towardsSun = {-1, 0.7f, 0.5f};
  view.backgroundTop = {0.05f, 0.06f, 0.09f, 1};
  view.backgroundBottom = {0.2f, 0.1f, 0.1f, 1};
  view.samplesPerAxis = 3;
  expectSamePicture();
}

TEST_P(ComputedPictures, MayDoWithoutAnyPartOfTheirLight) {
  view.samplesPerAxis = 1;
  for (int left = 0; left < 8; ++left) {
    SCOPED_TRACE(left);
    view.lighting.shadows = (left & 1) != 0;
    view.lighting.occlusion = (left & 2) != 0;
    view.lighting.unlit = (left & 4) != 0;
    expectSamePicture();
  }
}

TEST_P(ComputedPictures, MayBeTakenWithinTheFluidAndFromBelow) {
  view.width = 240;
  view.height = 180;
  view.camera = {.eye = {0.1f, 1, 0.1f}, .target = {1, 0.9f, 0.3f}, .fovDegrees = 100};
  expectSamePicture();
  view.camera = {.eye = {1, -3, 2}, .target = {0, 1, 0}, .fovDegrees = 60};  // the ground is not seen
  expectSamePicture();
}

TEST_P(ComputedPictures, ShowWhiteWater) {
  view.particles[1].white = true;
  expectSamePicture();
  view.lighting.towardsSun = {-1, 0.7f, -2};  // behind it
  expectSamePicture();
}

TEST_P(ComputedPictures, MayBeEmpty) {
  view.particles.clear();
  expectSamePicture();
  view.ground.visible = false;
  view.lines.clear();
  expectSamePicture();
}

TEST_P(ComputedPictures, LeaveOutParticlesThatAreNowhere) {
  block[0].x = std::numeric_limits<float>::quiet_NaN();
  block[1].y = std::numeric_limits<float>::infinity();
  expectSamePicture();
}

/// Also where spheres are equally near: each stands in the place of another one, of its own view, of another
/// rank or of the other view, and has another colour.
TEST_P(ComputedPictures, OfSeveralRanksHaveTheBitsOfOne) {
  const std::vector<Vec3f> once = block;
  block.insert(block.end(), once.begin(), once.end());
  const std::vector<float> others(values.rbegin(), values.rend());
  values.insert(values.end(), others.begin(), others.end());
  drops.insert(drops.end(), once.begin(), once.begin() + 1000);
  view.particles[0].positions = block;
  view.particles[0].values = values;
  view.particles[1].positions = drops;
  view.particles[1].radius = view.particles[0].radius;
  for (const bool white : {false, true}) {
    view.particles[1].white = white;
    const Picture wanted = renderer.draw(view);
    for (const int ranks : {1, 2, 3, 5}) {
      SCOPED_TRACE(ranks);
      const Picture found = drawnByRanks(ranks);
      EXPECT_EQ(found.width, wanted.width);
      EXPECT_TRUE(found.rgb == wanted.rgb);
    }
  }
}

TEST_P(ComputedPictures, OfRanksThatHaveNothingAreThoseOfOne) {
  view.particles[1].positions = {};
  view.particles[0].positions = view.particles[0].positions.first(1);
  view.particles[0].values = view.particles[0].values.first(1);
  EXPECT_TRUE(drawnByRanks(3).rgb == renderer.draw(view).rgb);
  view.particles[0].positions = {};
  view.particles[0].values = {};
  EXPECT_TRUE(drawnByRanks(2).rgb == renderer.draw(view).rgb);
}

TEST_P(ComputedPictures, LeaveSurfacesToOpenGl) {
  const TriangleMesh plate =
      quad({-1.5f, 0.2f, 0.5f}, {1.5f, 0.2f, 0.5f}, {1.5f, 2, -0.5f}, {-1.5f, 2, -0.5f});
  gl::Renderer both(gl::makeContext(), openDevice(GetParam()), gl::ComputeShare::kWhatCanBe);
  EXPECT_EQ(both.draw(view).rgb, renderer.draw(view).rgb);
  view.surfaces = {{.mesh = both.addMesh(plate)}};
  EXPECT_FALSE(ComputeRenderer::canDraw(view));
  ASSERT_EQ(reference.addMesh(plate), view.surfaces[0].mesh);
  expectLike(reference.draw(view), both.draw(view), view.width * view.height / 2000);
}

}  // namespace
}  // namespace weir::rendering
