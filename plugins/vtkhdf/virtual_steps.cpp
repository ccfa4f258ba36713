#include "plugins/vtkhdf/virtual_steps.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace weir {

namespace {

using hdf5::NumberType;
using hdf5::RowsElsewhere;

constexpr const char* kCounting = "counting";

/// The rows of all steps in the data sets of that name.
std::vector<RowsElsewhere> rowsOf(const VirtualSteps& from, const std::string& dataset) {
  std::vector<RowsElsewhere> all;
  for (const VirtualStep& step : from.steps)
    for (const VirtualStep::Rows& rows : step.rows)
      all.push_back({.file = from.files.at(static_cast<std::size_t>(rows.file)),
                     .dataset = dataset,
                     .first = rows.first,
                     .count = rows.count});
  return all;
}

/// Where the cells of each part begin: 0, 1, 2, … up to its number of points. Steps in a row with as many
/// points share a part.
std::vector<RowsElsewhere> cellOffsetsOf(const VirtualSteps& from) {
  std::vector<RowsElsewhere> all;
  std::int64_t last = -1;
  for (const VirtualStep& step : from.steps) {
    const std::int64_t points = step.points();
    if (points == std::exchange(last, points)) continue;
    all.push_back({.file = from.counting, .dataset = kCounting, .first = 0, .count = points + 1});
  }
  return all;
}

}  // namespace

std::int64_t VirtualStep::points() const {
  std::int64_t all = 0;
  for (const Rows& some : rows) all += some.count;
  return all;
}

NumberType numberType(VtkHdfType type) {
  switch (type) {
    case VtkHdfType::kFloat32:
      return NumberType::kFloat32;
    case VtkHdfType::kInt32:
      return NumberType::kInt32;
    case VtkHdfType::kInt64:
      return NumberType::kInt64;
    case VtkHdfType::kUint32:
      return NumberType::kUint32;
  }
  return NumberType::kFloat32;
}

void makeVirtualSets(hdf5::File& file, const VtkHdfLayout& layout, const VirtualSteps& from) {
  hdf5::Group root = file.root().createGroup("VTKHDF");
  const std::string above = root.path() + "/";
  root.createVirtual("Points", NumberType::kFloat32, 3, rowsOf(from, above + "Points"));
  hdf5::Group data = root.createGroup("PointData");
  for (const VtkHdfAttribute& attribute : layout.attributes)
    data.createVirtual(attribute.name, numberType(attribute.type), attribute.components,
                       rowsOf(from, above + "PointData/" + attribute.name));
  std::int64_t most = 0;
  for (const VirtualStep& step : from.steps) most = std::max(most, step.points());
  const RowsElsewhere ids{.file = from.counting, .dataset = kCounting, .first = 0, .count = most};
  hdf5::Group vertices = root.createGroup("Vertices");
  vertices.createVirtual("Connectivity", NumberType::kInt64, 1, std::span(&ids, 1));
  vertices.createVirtual("Offsets", NumberType::kInt64, 1, cellOffsetsOf(from));
}

void makeCountingSet(hdf5::File& file, std::int64_t end) {
  // Chunks are written whole and once, so they may be compressed: to less than a hundredth.
  hdf5::Dataset set = file.root().createGrowing(
      kCounting, {.type = NumberType::kInt64, .chunkRows = kCountingChunk, .deflate = true});
  std::vector<std::int64_t> block(kCountingChunk);
  for (std::int64_t first = 0; first < end; first += kCountingChunk) {
    std::iota(block.begin(), block.end(), first);
    set.append(std::span<const std::int64_t>(block));
  }
}

}  // namespace weir
