// Slabs of whole layers: the fullest one has as few particles as any cuts can give it, every layer belongs to
// one slab, and both sides agree on who touches whom.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "framework/communication/slabs.h"
#include "framework/neighbors/cell_grid.h"

namespace weir::test {
namespace {

using Layers = std::vector<std::int64_t>;

/// The least that the fullest of `slabs` slabs can have, by trying all cuts.
std::int64_t leastWorst(const Layers& layers, std::size_t from, int slabs) {
  if (slabs == 1)
    return std::accumulate(layers.begin() + std::ptrdiff_t(from), layers.end(), std::int64_t{0});
  std::int64_t best = std::numeric_limits<std::int64_t>::max(), first = 0;
  for (std::size_t end = from; end <= layers.size(); ++end) {
    best = std::min(best, std::max(first, leastWorst(layers, end, slabs - 1)));
    if (end < layers.size()) first += layers[end];
  }
  return best;
}

Layers inSlabs(const Layers& layers, int firstLayer, const Slabs& slabs) {
  Layers counts(std::size_t(slabs.count()), 0);
  for (std::size_t k = 0; k < layers.size(); ++k)
    counts[std::size_t(slabs.view().slabOfLayer(firstLayer + int(k)))] += layers[k];
  return counts;
}

TEST(Slabs, TheFullestHasAsFewParticlesAsAnyCutsCanGiveIt) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> layerCount(1, 9), inLayer(0, 40), slabCount(1, 5);
  for (int round = 0; round < 300; ++round) {
    Layers layers(std::size_t(layerCount(random)));
    for (auto& count : layers) count = inLayer(random);
    const int slabs = slabCount(random);
    const Slabs cut{.cuts = cutLayers(-4, layers, slabs)};
    ASSERT_EQ(cut.count(), slabs);
    ASSERT_TRUE(std::is_sorted(cut.cuts.begin(), cut.cuts.end()));
    const Layers counts = inSlabs(layers, -4, cut);
    ASSERT_EQ(*std::max_element(counts.begin(), counts.end()), leastWorst(layers, 0, slabs));
  }
}

TEST(Slabs, ThereMayBeMoreOfThemThanLayersOrNoParticles) {
  const Slabs many{.cuts = cutLayers(10, Layers{5, 5}, 6)};
  EXPECT_EQ(inSlabs({5, 5}, 10, many), (Layers{5, 5, 0, 0, 0, 0}));
  EXPECT_EQ(cutLayers(0, Layers{}, 3).size(), 2u);
  EXPECT_EQ(cutLayers(0, Layers{0, 0, 0}, 3).size(), 2u);
  EXPECT_TRUE(cutLayers(0, Layers{1, 2}, 1).empty());
}

TEST(Slabs, EveryLayerBesideASlabIsThatOfANeighborAndNeighborsAgree) {
  for (const std::vector<int>& cuts :
       {std::vector<int>{0, 3, 7}, {2, 2, 5}, {4, 4, 4}, {-1, 0, 1}, {5, 6, 6}}) {
    const Slabs slabs{.cuts = cuts};
    for (int layer = -5; layer < 12; ++layer) {
      const int own = slabs.view().slabOfLayer(layer);
      for (const int beside : {layer - 1, layer + 1}) {
        const int other = slabs.view().slabOfLayer(beside);
        if (other == own) continue;
        const std::vector<int> ofOwn = slabs.neighborsOf(own), ofOther = slabs.neighborsOf(other);
        EXPECT_EQ(std::count(ofOwn.begin(), ofOwn.end(), other), 1);
        EXPECT_EQ(std::count(ofOther.begin(), ofOther.end(), own), 1);
      }
    }
    for (int k = 0; k < slabs.count(); ++k)
      for (const int other : slabs.neighborsOf(k)) {
        const std::vector<int> back = slabs.neighborsOf(other);
        EXPECT_EQ(std::count(back.begin(), back.end(), k), 1) << k << " and " << other;
      }
  }
}

TEST(Slabs, LayersAreThoseOfTheCellsOfTheSearch) {
  // In a grid that does not wrap there, layers and cells have the same numbers.
  CellGrid grid{.inverseCellSize = 1 / 0.03f, .cells = {1000, 1000, 1000}};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 29);
  for (int round = 0; round < 2000; ++round) {
    const Vec3f p{place(random), place(random), place(random)};
    const Vec3i cell = grid.cellOf(p);
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ((CellLayers{axis, grid.inverseCellSize}.layerOf(p)), cell[axis]);
  }
  EXPECT_EQ((CellLayers{1, 10}.layerOf({0, -0.01f, 0})), -1);
  EXPECT_EQ((CellLayers{2, 10}.layerOf({0, 0, 1e30f})), int(CellLayers::kFarthest));
  EXPECT_EQ((CellLayers{0, 10}.layerOf({-1e30f, 0, 0})), -int(CellLayers::kFarthest));
}

TEST(Slabs, APlaceTouchesTheSlabsBesideItsLayerOnly) {
  const std::vector<int> cuts{3, 4};  // the slab between them is one layer thick
  const SlabsView slabs{{.axis = 0, .inverseCellSize = 1}, cuts.data(), 3};
  const auto touched = [&](float x) {
    return std::vector<bool>{slabs.touches(0, {x, 0, 0}), slabs.touches(1, {x, 0, 0}),
                             slabs.touches(2, {x, 0, 0})};
  };
  EXPECT_EQ(touched(1.5f), (std::vector<bool>{true, false, false}));  // its own
  EXPECT_EQ(touched(2.5f), (std::vector<bool>{true, true, false}));
  EXPECT_EQ(touched(3.5f), (std::vector<bool>{true, false, true}));
  EXPECT_EQ(touched(4.5f), (std::vector<bool>{false, true, true}));
  EXPECT_EQ(touched(5.5f), (std::vector<bool>{false, false, true}));
}

}  // namespace
}  // namespace weir::test
