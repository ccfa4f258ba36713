// Runs that were recorded, such as exports: the particles of all fluids at each frame. `weir render` shows
// them. Plugins add what opens them:
//
//   registry.addService<RecordingReader>("vtkhdf", [] { return std::make_unique<VtkHdfRecordingReader>(); });
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// A quantity of the particles: particles × components numbers, particle by particle.
struct RecordedArray {
  std::string name;
  int components = 1;
  std::variant<std::vector<float>, std::vector<std::int64_t>> values;
};

/// The particles of one fluid at one time.
struct RecordedFluid {
  std::vector<Vec3f> positions;  ///< m, finite
  std::vector<RecordedArray> arrays;
};

class Recording {
 public:
  virtual ~Recording() = default;
  /// Of each frame, in s, increasing.
  virtual const std::vector<double>& times() const = 0;
  /// The names of the fluids' nodes; empty if the file does not say, which then has one fluid.
  virtual const std::vector<std::string>& fluids() const = 0;
  /// A frame's fluids, in the order of fluids(). Throws an io Error.
  virtual std::vector<RecordedFluid> read(std::size_t frame) const = 0;
};

class RecordingReader {
 public:
  static constexpr std::string_view kInterface = "RecordingReader";
  virtual ~RecordingReader() = default;
  /// The endings of files that it opens, lower case with the dot.
  virtual std::vector<std::string> extensions() const = 0;
  /// Throws an io Error that names the file.
  virtual std::unique_ptr<Recording> open(const std::filesystem::path& file) const = 0;
};

}  // namespace weir
