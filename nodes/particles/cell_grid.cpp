#include "nodes/particles/cell_grid.h"

#include <algorithm>

namespace weir {

CellGrid chooseCellGrid(const Aabb& box, float cellSize, std::int64_t mostCells, std::int64_t fewestCells) {
  constexpr double kMostInOneDirection = 1 << 20;
  CellGrid grid;
  grid.inverseCellSize = 1.0f / cellSize;
  double cells[3];
  for (int k = 0; k < 3; ++k) {
    // Two cells more than the box, so that its two ends do not become neighbours.
    const double needed = box.empty() ? 0 : std::ceil(double(box.size()[k]) / cellSize) + 3;
    cells[k] = std::clamp(needed, double(CellGrid::kLeastCells), kMostInOneDirection);
  }
  while (cells[0] * cells[1] * cells[2] > double(std::max<std::int64_t>(mostCells, 27))) {
    double& longest = *std::max_element(cells, cells + 3);
    longest = std::max(double(CellGrid::kLeastCells), std::floor(longest / 2));
  }
  while (cells[0] * cells[1] * cells[2] < double(std::min(fewestCells, mostCells)) / 2)
    *std::min_element(cells, cells + 3) *= 2;
  grid.cells = {int(cells[0]), int(cells[1]), int(cells[2])};
  return grid;
}

}  // namespace weir
