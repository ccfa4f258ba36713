// What a run can put out, and the options of the command line that ask for it. Plugins bring these:
//
//   registry.addService<OutputKind>("pictures", [] { return std::make_unique<PictureOutput>(); });
//
// One kind may have several options and makes one observer for all of them, so that a video and single images
// share one renderer.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/api.h"
#include "framework/run/observer.h"

namespace WEIR_API weir {

/// An option that takes the path of a file or folder to be written.
struct OutputOption {
  std::string name;                     ///< "video": the option is --video
  std::string argument;                 ///< "FILE.mp4", for the help
  std::vector<std::string> extensions;  ///< what a file must end in, ".mp4"; empty: the path is a folder
  std::string doc;

  bool isFolder() const { return extensions.empty(); }
};

/// The paths that were given, by the name of the option.
using OutputPaths = std::map<std::string, std::filesystem::path>;

class OutputKind {
 public:
  static constexpr std::string_view kInterface = "OutputKind";
  virtual ~OutputKind() = default;

  virtual std::vector<OutputOption> options() const = 0;
  /// Whether its observers can look at a replay, too (`weir render`): of the fluids they read the particles
  /// and the attributes that were recorded, of solids where they are.
  virtual bool showsReplays() const { return false; }
  /// `paths` holds those of options() that were given, at least one. Whoever asks has checked that file names
  /// end as they must and that the folder above exists. The file is opened by the observer's begin().
  virtual std::unique_ptr<Observer> create(const OutputPaths& paths) const = 0;
};

}  // namespace weir
