// Steps of particles that stand in other files, such as those of the ranks of a run, as virtual data sets.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/vtkhdf_layout.h"

namespace weir {

/// A step whose points are rows of other files, one behind the other.
struct VirtualStep {
  struct Rows {
    int file = 0;
    std::int64_t first = 0, count = 0;
  };
  double time = 0;             ///< s
  std::vector<double> fields;  ///< of the layout
  std::vector<Rows> rows;

  std::int64_t points() const;
};

/// Names of files are relative to the folder of the file that names them.
struct VirtualSteps {
  std::vector<std::string> files;  ///< of the same layout
  /// Has the numbers 0, 1, 2, … of which cells consist, at least one more than a step has points.
  std::string counting;
  std::span<const VirtualStep> steps;
};

hdf5::NumberType numberType(VtkHdfType type);

/// Adds the data sets whose rows stand elsewhere to an empty file: points, their attributes, and vertices.
void makeVirtualSets(hdf5::File& file, const VtkHdfLayout& layout, const VirtualSteps& from);
/// Files of these have a multiple of so many numbers.
inline constexpr std::int64_t kCountingChunk = 1 << 17;
/// Adds the numbers below `end`, and what is behind in its chunk, to an empty file.
void makeCountingSet(hdf5::File& file, std::int64_t end);

}  // namespace weir
