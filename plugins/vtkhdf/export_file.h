// The file of an export: made with the first frame, saved with a checkpoint, gone on with after a resume.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/graph/state.h"
#include "framework/run/simulation.h"
#include "plugins/vtkhdf/vtkhdf_writer.h"

namespace weir {

/// Until it is opened, a file that stands there is left as it is.
class ExportFile {
 public:
  explicit ExportFile(std::filesystem::path path) : path_(std::move(path)) {}

  const std::filesystem::path& path() const { return path_; }

  /// Keeps the scene's text for the file. Throws an io Error if the file cannot be written.
  void begin(const Simulation& simulation);

  bool isOpen() const { return writer_ != nullptr; }
  /// The version of Weir, the scene's text and, as the text `listName`, `names` in the order of their
  /// numbers.
  ExportTexts texts(const char* listName, const std::vector<std::string>& names) const;
  /// Makes the file, or goes on behind the frames that it had when the checkpoint was saved. A new one keeps
  /// these texts.
  void open(VtkHdfLayout layout, const ExportTexts& texts);
  /// Of an open file.
  VtkHdfWriter& writer() { return *writer_; }
  void close();

  /// The frames that are on the disk. The file must be open.
  void save(const StateWriter& to);
  void resume(const StateReader& from);

 private:
  std::filesystem::path path_;
  std::string sceneText_;
  std::optional<std::int64_t> earlier_;  // frames that are there, where a run is resumed
  std::unique_ptr<VtkHdfWriter> writer_;
};

}  // namespace weir
