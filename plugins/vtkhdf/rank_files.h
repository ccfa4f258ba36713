// Names of the files of an export that every rank writes a part of: beside run.vtkhdf the folder run_ranks.
#pragma once

#include <filesystem>
#include <string>

namespace weir {

/// "run_ranks" of run.vtkhdf.
inline std::string folderOfRanks(const std::filesystem::path& file) {
  return file.stem().string() + "_ranks";
}

inline std::string fileOfRank(int rank) {
  return "rank_" + std::to_string(rank) + ".vtkhdf";
}

/// A text in all files of an export: a digest of what it is of.
inline constexpr const char* kRunText = "run";

/// Of the numbers that cells consist of.
inline constexpr const char* kCountingFile = "cells.hdf5";

}  // namespace weir
