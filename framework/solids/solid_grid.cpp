#include "framework/solids/solid_grid.h"

#include <algorithm>

#include "framework/graph/memory_estimate.h"

namespace weir {

int SolidGrid::wordsFor(std::int64_t solids) {
  return static_cast<int>((solids - 1) / NearSolids::kBits) + 2;
}

void SolidGrid::fit(const std::vector<SolidView>& solids, float reach, float way, float gap) {
  constexpr float kEdge = 0.5f;  // of the median radius: finer cells hold fewer solids that are not near
  view_ = {};
  const auto count = static_cast<std::int64_t>(solids.size());
  if (count < kFew) return;
  std::vector<float> radii;
  for (const SolidView& solid : solids) radii.push_back(0.5f * length(solid.clearance.bounds.size()) + reach);
  const auto median = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
  std::nth_element(radii.begin(), median, radii.end());
  const float edge = kEdge * *median;
  if (!(edge > 0)) return;
  const int words = wordsFor(count);
  bits_.resizeDiscarding(std::int64_t{kAlong} * kAlong * kAlong * words);
  reach_ = reach;
  gap_ = gap;
  view_ = {.words = words, .along = kAlong, .inverseEdge = 1 / edge, .way = way, .bits = bits_.view()};
}

double SolidGrid::memoryFor(std::int64_t solids) {
  if (solids < kFew) return 0;
  return bytesOfArray(double(kAlong) * kAlong * kAlong * wordsFor(solids), sizeof(std::uint32_t));
}

}  // namespace weir
