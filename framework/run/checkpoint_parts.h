// A checkpoint in parts: what each of several ranks owns stands in a file of its own. The file that the user
// named has all else, with the names and the digests of the parts, and is written last:
//
//   state.h5
//   state.parts/7.rank_0.h5, state.parts/7.rank_1.h5    of the seventh one
//
// No part is ever written anew, so what a file names is whole for as long as it is there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/checkpoint.h"

namespace WEIR_API weir {

/// Digest of arrays with their paths.
std::int64_t digestOf(const StateArrays& state);

/// The parts that a checkpoint names, in the order of their ranks; none if it stands in one file.
struct CheckpointParts {
  std::vector<std::string> names;     ///< from the folder of the file
  std::vector<std::int64_t> digests;  ///< of their states

  /// Throws an io Error for what this program would not have written.
  static CheckpointParts of(const Checkpoint& checkpoint);
  void save(StateArrays& to) const;

  /// What a part holds of `file`, which names it. Throws an io Error that names both if the part is missing,
  /// damaged or of another checkpoint.
  StateArrays read(const CheckpointStore& store, const std::filesystem::path& file, std::size_t part) const;
};

/// Which of so many ranks this one is.
struct RankShare {
  int rank = 0, ranks = 1;
};

/// Rows that belong to a rank, of a part that has so many: all ranks have as many parts of the whole, in the
/// order of parts, and each row belongs to one.
struct SharedRows {
  std::int64_t first = 0, count = 0;
  static SharedRows of(std::int64_t rows, std::size_t part, std::size_t parts, RankShare share);
};

/// Adds to a checkpoint, as it was read from `file`, what stands in its parts: of each array the rows of this
/// rank, behind each other; all without ranks. Holds one part at a time besides. Throws as
/// CheckpointParts::read.
void readParts(const CheckpointStore& store, const std::filesystem::path& file, Checkpoint& checkpoint,
               RankShare share = {});

/// Of which rank a file is a part, if it is one.
std::optional<int> rankOfPart(const Checkpoint& checkpoint);
/// In the state of a part.
void saveRankOfPart(StateArrays& to, int rank);

/// "state.parts", beside state.h5.
std::filesystem::path folderOfParts(const std::filesystem::path& file);
/// "state.parts/7.rank_0.h5"
std::string nameOfPart(const std::filesystem::path& file, std::int64_t number, int rank);
/// A number that no part beside the file has.
std::int64_t nextNumberOfParts(const std::filesystem::path& file);

using PartNames = std::set<std::string>;
/// The parts that will be those of the checkpoint before the last one, once another takes the place of what
/// is there. Nothing if that cannot be read.
std::optional<PartNames> partsInUse(const CheckpointStore& store, const std::filesystem::path& file);
/// Removes all other parts beside the file, and the folder once it is empty. What cannot be removed stays.
void removeOtherParts(const std::filesystem::path& file, const PartNames& kept);
/// The same for those that neither the file nor the one before it names, which are read if there are any
/// parts. Nothing if one of them cannot be.
void removeUnnamedParts(const CheckpointStore& store, const std::filesystem::path& file);

}  // namespace weir
