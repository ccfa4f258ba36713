// The other files that a file of virtual data sets consists of, such as those of the ranks of a run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plugins/vtkhdf/hdf5.h"

namespace weir {

struct FileElsewhere {
  std::string name;     ///< from the folder of the file that names it
  std::string problem;  ///< "is missing"; empty: it is whole, as far as it is named
};

/// Those that data sets of a file take rows from, in the order of their names. HDF5 itself says
/// nothing of what is not there. A file of another run than this one is a problem, too, where both say of
/// which they are (kRunText).
std::vector<FileElsewhere> filesElsewhere(const hdf5::File& whole, const std::filesystem::path& file);

/// Throws an io Error that names all that are not whole.
void checkWhole(const std::vector<FileElsewhere>& files);

/// Bytes of a file and of the folder of ranks beside it, if there is one.
double bytesOfSet(const std::filesystem::path& file);

}  // namespace weir
