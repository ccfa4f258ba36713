// Whoever asks the solids that a grid lists misses none: against each solid's own answer, and against the
// distance to every triangle.
#include "framework/solids/solid_grid.h"
#include "framework/compute/dispatch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "framework/solids/solid.h"
#include "tests/framework/solids/solid_grid_kernel.h"
#include "tests/support/devices.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using SolidGridTest = OnDevice;
WEIR_ON_EVERY_DEVICE(SolidGridTest);

constexpr float kReach = 0.1f, kWay = 0.02f, kGap = 0.002f, kDetail = 0.02f;

struct AtRest final : RigidMotion {
  Pose poseAt(double) const override { return {}; }
  Vec3f pivotAt(double) const override { return {}; }
};

/// How solids lie, and how they move in a step.
struct Layout {
  const char* name;
  int solids;
  float half;      // they lie in a cube of that half side, m
  Vec3f middle;    // about that place
  float way;       // m, at most along each axis
  float turn;      // rad, at most
  bool huge;       // whether the first of them is as large as the cube
  bool selective;  // whether the grid shall leave out most
};

const std::vector<Layout> kLayouts{
    {"none", 0, 1, {}, 0, 0, false, false},
    {"one", 1, 1, {}, 0.02f, 0.1f, false, false},
    {"so few that all are asked", 15, 1, {}, 0.02f, 0.1f, false, false},
    {"at rest", 64, 1, {}, 0, 0, false, true},
    {"moved", 200, 1, {}, 0.15f, 0.1f, false, true},
    {"turned", 100, 2, {}, 0, 0.7f, false, true},
    {"one upon the other", 40, 0.05f, {}, 0.02f, 0.1f, false, false},
    {"wider than the cells reach", 120, 20, {}, 0.02f, 0.1f, false, true},
    {"far off", 64, 1, {700, -300, 5}, 0.02f, 0.1f, false, true},
    {"one of them huge", 100, 1, {}, 0.02f, 0.01f, true, true},
    {"more than a word of groups", 1100, 3, {}, 0.01f, 0.05f, false, true},
    {"flung about", 32, 1, {}, 1, 3, false, false},
};

class Heap {
 public:
  Heap(Device& device, const Layout& layout) : random_(unsigned(layout.solids)), layout_(layout) {
    const float h = layout.half;
    meshes_ = {boxMesh({-0.02f, -0.03f, -0.05f}, {0.02f, 0.03f, 0.05f}), icosphere(1, 0.06f),
               boxMesh({0.3f, 0, 0}, {0.32f, 0.01f, 0.2f}),  // aside of its frame's origin
               boxMesh({-0.002f, -0.002f, -0.002f}, {0.002f, 0.002f, 0.002f})};
    if (layout.huge) meshes_.push_back(boxMesh({-h, -h, -h}, {h, h, h}));
    for (const TriangleMesh& mesh : meshes_)
      solids_.push_back(std::make_unique<Solid>(device, mesh, SolidSurface{}, motion_,
                                                std::max(kDetail, 0.05f * length(mesh.bounds().size()))));
    for (int k = 0; k < layout.solids; ++k) add(layout.huge && k == 0 ? 4 : k % 4);
  }

  const std::vector<SolidView>& views() const { return views_; }
  const TriangleMesh& meshOf(std::size_t k) const { return meshes_[shape_[k]]; }

  /// Where particles start and where they come to: about half of them near a solid, as it stands at the end
  /// of the step or as it stood before.
  std::pair<std::vector<Vec3f>, std::vector<Vec3f>> ways(int count) {
    std::vector<Vec3f> starts, places;
    for (int i = 0; i < count; ++i) {
      const Vec3f way = inCube(i % 7 == 0 ? 1.0f : kWay / 2);
      Vec3f at = layout_.middle + inCube(1.1f * layout_.half);
      bool endsThere = true;
      if (i % 2 == 0 && !views_.empty()) {
        const SolidView& solid = views_[random_() % views_.size()];
        const Aabb& box = solid.clearance.bounds;
        const Pose* const poses[] = {&solid.end, &solid.begin, &solid.predicted};
        endsThere = i % 3 == 0;
        at = poses[i % 3]->toWorld(0.5f * (box.lo + box.hi) + inCube(0.3f * length(box.size())));
      }
      places.push_back(endsThere ? at : at + way);
      starts.push_back(endsThere ? at + way : at);
    }
    return {starts, places};
  }

 private:
  Vec3f inCube(float half) {
    std::uniform_real_distribution<float> pick(-half, half);
    const float x = pick(random_), y = pick(random_), z = pick(random_);
    return {x, y, z};
  }
  Quatf turned(const Quatf& from, float most) {
    const Quatd to = normalized(rotationBy(doubleOf(inCube(most / std::sqrt(3.0f)))) *
                                Quatd{from.w, from.x, from.y, from.z});
    return {float(to.w), float(to.x), float(to.y), float(to.z)};
  }
  Pose aside(const Pose& of, float share) {
    return {turned(of.rotation, share * layout_.turn), of.translation + inCube(share * layout_.way)};
  }
  void add(int shape) {
    SolidView view = solids_[std::size_t(shape)]->view(0, 0.01);
    view.end = {turned({}, 3), layout_.middle + inCube(layout_.half)};
    if (shape == 4) view.end.translation = layout_.middle;
    const bool later = views_.size() % 2 == 0;  // whether it goes farther before it is where it was predicted
    view.begin = aside(view.end, later ? 0.1f : 1.0f);
    view.predicted = aside(view.end, later ? 1.0f : 0.1f);
    views_.push_back(view);
    shape_.push_back(std::size_t(shape));
  }

  std::mt19937 random_;
  Layout layout_;
  AtRest motion_;
  std::vector<TriangleMesh> meshes_;
  std::vector<std::unique_ptr<Solid>> solids_;
  std::vector<SolidView> views_;
  std::vector<std::size_t> shape_;
};

struct Asked {
  std::vector<Vec3f> starts, places;
  std::vector<int> answers;
};

Asked ask(Device& device, const Heap& heap, std::vector<Vec3f> starts, std::vector<Vec3f> places) {
  const Array<SolidView> solids(device, heap.views());
  const Array<Vec3f> from(device, starts), to(device, places);
  Array<int> answers(device, to.size() * solids.size());
  SolidGrid grid(device);
  grid.fit(heap.views(), kReach, kWay, kGap);
  dispatch(device, [&](auto& d) {
    askGrid(d, grid, {{}, kReach, kGap, solids.view(), from.view(), to.view()}, answers.view());
  });
  return {std::move(starts), std::move(places), answers.toHost()};
}

TEST_P(SolidGridTest, ListsWhateverASolidItselfDoesNotRuleOut) {
  for (const Layout& layout : kLayouts) {
    Heap heap(*device, layout);
    const auto [starts, places] = heap.ways(400);
    const Asked asked = ask(*device, heap, starts, places);
    int near = 0, listed = 0;
    for (std::size_t n = 0; n < asked.answers.size(); ++n) {
      const int said = asked.answers[n];
      ASSERT_EQ(said & kOutOfOrder, 0) << layout.name;
      ASSERT_TRUE((said & kListedThere) != 0 || (said & kInReach) == 0) << layout.name << ", " << n;
      ASSERT_TRUE((said & kListed) != 0 || (said & (kMetFromBegin | kMetFromPredicted)) == 0)
          << layout.name << ", " << n;
      near += (said & kInReach) != 0;
      listed += (said & kListedThere) != 0;
    }
    EXPECT_EQ(near > 0, layout.solids > 0) << layout.name;
    const double share = layout.selective ? 0.2 : 1;
    EXPECT_LE(listed, share * double(asked.answers.size())) << layout.name;
  }
}

/// By another way: distances in double precision, at the end and along the way.
TEST_P(SolidGridTest, ListsAllThatAreNear) {
  for (const Layout& layout : kLayouts) {
    if (layout.solids > 200) continue;  // every triangle is asked
    Heap heap(*device, layout);
    const auto [starts, places] = heap.ways(60);
    const Asked asked = ask(*device, heap, starts, places);
    const std::size_t solids = heap.views().size();
    for (std::size_t i = 0; i < places.size(); ++i)
      for (std::size_t k = 0; k < solids; ++k) {
        const int said = asked.answers[i * solids + k];
        const SolidView& solid = heap.views()[k];
        const Vec3f to = solid.end.toBody(places[i]);
        // A cell that the grid leaves out is farther off than any rounding.
        if ((said & kListedThere) == 0) {
          ASSERT_GT(slowDistance(heap.meshOf(k), to), kReach) << layout.name << ", " << i << ", " << k;
        }
        if ((said & kListed) != 0) continue;
        for (const Pose& pose : {solid.begin, solid.predicted}) {
          const Vec3f from = pose.toBody(starts[i]);
          for (const float share : {0.0f, 0.5f, 1.0f})
            ASSERT_GT(slowDistance(heap.meshOf(k), from + share * (to - from)), kGap)
                << layout.name << ", " << i << ", " << k;
        }
      }
  }
}

TEST_P(SolidGridTest, ListsAllSolidsForPlacesThatItDoesNotKnow) {
  const Layout layout{"", 40, 1, {}, 0.02f, 0.1f, false, false};
  Heap heap(*device, layout);
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(),
                  kInf = std::numeric_limits<float>::infinity();
  const std::vector<Vec3f> places{{kNaN, 0, 0}, {0, kInf, 0}, {0, 0, -1e30f}, {1, 1, 1}};
  std::vector<Vec3f> starts = places;
  starts.back() = {1, 1 + 2 * kWay, 1};  // farther than anybody who asks may go
  for (const int said : ask(*device, heap, starts, places).answers) EXPECT_NE(said & kListed, 0);
}

struct Pairs {
  std::vector<std::vector<int>> solidsOf;    // of each place
  std::map<int, std::vector<int>> placesOf;  // by solid
};

/// Lists by solids are known of many only.
Pairs pairsOf(Device& device, const Heap& heap, const std::vector<Vec3f>& places, bool withGrid) {
  const Array<SolidView> solids(device, heap.views());
  const Array<Vec3f> to(device, places);
  Array<int> answers(device, to.size() * solids.size());
  SolidGrid grid(device);
  if (withGrid) grid.fit(heap.views(), kReach, kWay, kGap);
  SolidPairs pairs(device);
  const GridQuestion question{{}, kReach, kGap, solids.view(), to.view(), to.view()};
  dispatch(device, [&](auto& d) {
    askGrid(d, grid, question, answers.view());
    GridQuestion sorted = question;
    sorted.grid = grid.view();
    findPairs(d, pairs, sorted);
  });
  const auto read = [&](ArrayView<const int> of) {
    std::vector<int> values(std::size_t(of.size));
    if (of.size > 0) device.download(values.data(), of.data, values.size() * sizeof(int));
    return values;
  };
  Pairs found;
  const std::vector<int> first = read(pairs.view().first), count = read(pairs.view().count),
                         solid = read(pairs.view().solid), near = read(pairs.near());
  for (std::size_t i = 0; i < places.size(); ++i)
    found.solidsOf.emplace_back(solid.begin() + first[i], solid.begin() + first[i] + count[i]);
  const std::vector<int> begin = read(pairs.bySolid().first), item = read(pairs.bySolid().item);
  for (std::size_t k = 0; k + 1 < begin.size(); ++k)
    for (int n = begin[k]; n < begin[k + 1]; ++n)
      found.placesOf[int(k)].push_back(near[std::size_t(item[std::size_t(n)])]);
  return found;
}

TEST_P(SolidGridTest, PairsAreThoseOfAllSolidsAndListedByEach) {
  for (const Layout& layout : kLayouts) {
    Heap heap(*device, layout);
    const auto [starts, places] = heap.ways(500);
    const Pairs found = pairsOf(*device, heap, places, true), all = pairsOf(*device, heap, places, false);
    EXPECT_EQ(found.solidsOf, all.solidsOf) << layout.name;
    std::map<int, std::vector<int>> expected;
    for (std::size_t i = 0; i < places.size(); ++i)
      for (const int k : all.solidsOf[i]) expected[k].push_back(int(i));
    if (layout.solids <= 15) expected.clear();  // of few solids there are no lists
    EXPECT_EQ(found.placesOf, expected) << layout.name;
  }
}

TEST(SolidGrid, HasTheSameBitsForAnyNumberOfThreads) {
  const auto one = openDevice("cpu", 1), four = openDevice("cpu", 4);
  for (const Layout& layout : kLayouts) {
    Heap a(*one, layout), b(*four, layout);
    const auto [starts, places] = a.ways(300);
    EXPECT_EQ(ask(*one, a, starts, places).answers, ask(*four, b, starts, places).answers) << layout.name;
  }
}

}  // namespace
}  // namespace weir::test
