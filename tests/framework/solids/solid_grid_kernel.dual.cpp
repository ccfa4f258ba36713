#include "tests/framework/solids/solid_grid_kernel.h"

#include "framework/geometry/sweep.h"

namespace weir::test {
namespace {

struct Ask {
  GridQuestion of;
  ArrayView<int> answers;

  WEIR_HD void operator()(std::int64_t i) const {
    const std::int64_t count = of.solids.size;
    const Vec3f start = of.starts[i], place = of.places[i];
    int* const mine = answers.data + i * count;
    for (std::int64_t k = 0; k < count; ++k) mine[k] = said(of.solids[k], start, place);
    mark(of.grid.near(place, length(place - start), count), kListed, mine);
    mark(of.grid.near(place, 0, count), kListedThere, mine);
  }

 private:
  WEIR_HD int said(const SolidView& solid, const Vec3f& start, const Vec3f& place) const {
    const Vec3f to = solid.end.toBody(place);
    const auto mayMeet = [&](const Pose& from) {
      return !isClear(solid.tree, solid.clearance, from.toBody(start), to, of.gap);
    };
    return (solid.clearance.at(to) > of.reach ? 0 : kInReach) | (mayMeet(solid.begin) ? kMetFromBegin : 0) |
           (mayMeet(solid.predicted) ? kMetFromPredicted : 0);
  }

  WEIR_HD void mark(const NearSolids& near, int as, int* mine) const {
    int before = -1;
    for (int k = near.from(0); k < near.count; k = near.from(k + 1)) {
      mine[k] |= as | (k > before ? 0 : kOutOfOrder);
      before = k;
    }
  }
};

}  // namespace

template <class Backend>
void askGrid(Backend& device, SolidGrid& grid, GridQuestion question, ArrayView<int> answers) {
  grid.sort(device, question.solids);
  question.grid = grid.view();
  parallelFor(device, "askGrid", question.places.size, Ask{question, answers});
}

template <class Backend>
void findPairs(Backend& device, SolidPairs& pairs, const GridQuestion& question) {
  pairs.find(device, question.places.size, question.solids, question.grid, question.places, question.reach);
}

template void askGrid(ThisBackend&, SolidGrid&, GridQuestion, ArrayView<int>);
template void findPairs(ThisBackend&, SolidPairs&, const GridQuestion&);

}  // namespace weir::test
