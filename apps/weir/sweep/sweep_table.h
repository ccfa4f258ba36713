// The tables that a sweep makes of the statistics of its points.
#pragma once

#include <filesystem>
#include <vector>

#include "apps/weir/sweep/points.h"

namespace weir::app {

/// Writes two files into the sweep's folder, each with a line for each point: its number, folder and
/// parameters, and its state, "done", "failed" or "open".
///
///   table.csv   the error of a point that failed, and the numbers of --stats of one that is done; it is the
///               same however often and where the sweep was run
///   times.csv   the numbers that are of the machine: times and memory
///
/// Columns are the paths of numbers as in numbersOf(), in the order in which points have them. Where several
/// processes do so, the last one to write has seen all that the others have done. Throws an io Error.
void writeTables(const std::filesystem::path& folder, const PointList& points);

/// The points alone: number, folder, and parameters.
std::string pointTable(const PointList& points);

}  // namespace weir::app
