// An export that every rank writes a part of: each has a file of its own, and the file that the user named
// has virtual data sets over all of them, in which particles stand rank by rank, as if one had written them.
//
// Rank 0 writes the named file anew now and then, and each time with the frames that all ranks have written.
// So a frame is whole or not there, whatever ends the run.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "framework/communication/communicator.h"
#include "framework/graph/state.h"
#include "plugins/vtkhdf/virtual_steps.h"

namespace weir {

/// How many particles each rank has in a frame.
struct FrameOfRanks {
  std::vector<std::int64_t> counts;  ///< of the first source by rank, then of the second one, and so on
  std::int64_t complete = 0;         ///< frames that all ranks had written before
};

class ExportOfRanks {
 public:
  ExportOfRanks(std::filesystem::path file, Communicator& ranks) : file_(std::move(file)), ranks_(ranks) {}

  const std::filesystem::path& file() const { return file_; }
  int rank() const { return ranks_.rank(); }
  int ranks() const { return ranks_.size(); }
  /// The file that this rank writes.
  std::filesystem::path ownFile() const;

  // All ranks make these calls together, on the thread of the simulation.
  /// Makes the folder. Throws an io Error if the named file cannot be written.
  void begin();
  /// Once, before a rank writes: where frames are there, the named file has them from now on, and otherwise
  /// it is gone, as it would name what is about to change.
  void prepare(const VtkHdfLayout& layout, const ExportTexts& texts);
  /// What all have in this frame, of which this rank has so many particles of each source.
  FrameOfRanks share(const std::vector<std::int64_t>& counts, std::int64_t written);
  /// The named file has all frames then, which all ranks must have written, and these texts, of rank 0.
  void complete(const ExportTexts& more = {});
  void save(const StateWriter& to);
  void resume(const StateReader& from);

  // On rank 0; does nothing on others.
  /// A frame that this rank has written; its first field is the number of particles.
  void add(const VtkHdfFrame& own, const FrameOfRanks& frame);
  /// The named file has the frames that are known to be complete. For a run that fails.
  void keepComplete();
  /// Nothing was written.
  void removeEmptyFolder() const;

  /// How many ranks wrote the frames of a saved export; 1 for one file of any number.
  static int savedRanks(const StateReader& from);

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path real() const;  ///< where links lead
  std::filesystem::path folder() const;
  void removeOthersFiles() const;
  void addStep(double time, const std::vector<double>& fields, const std::vector<std::int64_t>& counts);
  void writeFile(std::int64_t frames);
  /// Has at least so many numbers.
  void writeCounting(std::int64_t numbers);

  std::filesystem::path file_;
  Communicator& ranks_;
  VtkHdfLayout layout_;
  ExportTexts texts_;
  // Of rank 0.
  std::vector<VirtualStep> steps_;
  std::vector<std::int64_t> rowsOfRanks_;  // behind the last step
  std::int64_t complete_ = 0, inFile_ = -1, counting_ = 0;
  Clock::time_point writtenAt_;
  Clock::duration cost_{};  // of writing it
};

}  // namespace weir
