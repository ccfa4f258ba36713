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
       {std::vector<int>{0, 3, 7}, {2, 2, 5}, {4, 4, 4}, {-1, 0, 1}, {5, 6, 6}, {12, 12, 12}, {-5, -5, 0}}) {
    const Slabs slabs{.layers = {.first = -5, .count = 17}, .cuts = cuts};
    int layers = 0;
    for (int k = 0; k < slabs.count(); ++k) {
      const CellLayers own = slabs.layersOf(k);
      layers += own.count;
      for (int layer = own.first; layer < own.first + own.count; ++layer)
        EXPECT_EQ(slabs.view().slabOfLayer(layer), k);
      if (own.count == 0) {
        EXPECT_FALSE(slabs.below(k) || slabs.above(k));
        continue;
      }
      const auto above = slabs.above(k);
      ASSERT_EQ(above.has_value(), own.first + own.count < 12);
      if (!above) continue;
      EXPECT_EQ(*above, slabs.view().slabOfLayer(own.first + own.count));
      EXPECT_EQ(slabs.below(*above), k);
    }
    EXPECT_EQ(layers, 17);
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
    for (int axis = 0; axis < 3; ++axis) {
      const CellLayers layers{.axis = axis, .inverseCellSize = grid.inverseCellSize, .count = 1000};
      ASSERT_EQ(layers.layerOf(p), cell[axis]);
      // In the grid of a slab the axis is the slowest.
      CellGrid slab{.inverseCellSize = grid.inverseCellSize, .cells = {1000, 1000, 102}};
      slab.slowestAxis = axis, slab.firstLayer = 300, slab.slabLayers = 100;
      EXPECT_EQ(slab.cellOf(p).z, std::clamp(cell[axis] - 300, 0, 99));
      EXPECT_EQ(slab.cellOf(p).x, cell[axis == 0 ? 2 : 0]);
      EXPECT_EQ(slab.cellOf(p).y, cell[axis == 1 ? 2 : 1]);
    }
  }
}

TEST(Slabs, WhatIsBeyondTheLayersCountsToTheOutermostOnes) {
  const CellLayers layers{.axis = 1, .inverseCellSize = 10, .first = -2, .count = 5};
  EXPECT_EQ(layers.layerOf({0, -0.01f, 0}), -1);
  EXPECT_EQ(layers.layerOf({0, -0.31f, 0}), -2);
  EXPECT_EQ(layers.layerOf({0, 0.31f, 0}), 2);
  EXPECT_EQ(layers.layerOf({0, 1e30f, 0}), 2);
  EXPECT_EQ(layers.layerOf({0, -1e30f, 0}), -2);
}

TEST(Slabs, LayersLieAcrossTheLongestAxisAndReachBeyondTheBox) {
  const Aabb box{{-1, 0, 2}, {3, 1, 5}};
  const CellLayers layers = layersAcross(box, 0.1f);
  EXPECT_EQ(layers.axis, 0);
  EXPECT_LT(layers.first, layers.countedLayerOf(box.lo) - 3);
  EXPECT_GT(layers.first + layers.count, layers.countedLayerOf(box.hi) + 4);
  EXPECT_EQ(layersAcross({{0, 0, 0}, {1, 2, 1}}, 0.1f).axis, 1);
  EXPECT_EQ(layersAcross({{0, 0, 0}, {1, 1, 1}}, 0.1f).axis, 2);
  const CellLayers endless = layersAcross({{-1e30f, 0, 0}, {1e30f, 1, 1}}, 0.1f);
  EXPECT_GT(endless.count, 0);
  EXPECT_EQ(endless.layerOf({1e30f, 0, 0}), endless.first + endless.count - 1);
}

}  // namespace
}  // namespace weir::test
