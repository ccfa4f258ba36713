// Blender, or a Python that has it as the module bpy: found at run time, and started once for all frames.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/error.h"
#include "plugins/video/piped_program.h"

namespace weir::rendering {

/// How Blender is called.
struct BlenderCall {
  std::string program;                 ///< a name on the PATH, or a path
  std::vector<std::string> arguments;  ///< that have it run the script which they end with
};

/// What the environment variable WEIR_BLENDER names, a Blender or a Python with bpy; without it the program
/// blender on the PATH, or else python3 if that has bpy. `script` is what it is to run. Throws an io Error
/// that says what was looked for and how it is installed.
BlenderCall findBlender(const std::filesystem::path& script);

/// share/weir/blender of the build or installation that this library is in.
std::filesystem::path blenderFolder();

class BlenderProgram {
 public:
  /// Starts it. Throws an io Error if there is none.
  BlenderProgram();
  /// Lets it end by itself, so that it leaves nothing behind.
  ~BlenderProgram();

  /// Renders a frame of a Handover into a PNG file. False if the run was interrupted meanwhile: the program
  /// is ended then, and there is no file. Throws an io Error with the words of Blender if it failed.
  bool render(const std::filesystem::path& frame, const std::filesystem::path& picture);
  /// The same, as a .blend file of the whole scene.
  bool save(const std::filesystem::path& frame, const std::filesystem::path& blend);

 private:
  bool ask(const std::filesystem::path& frame, const std::string& what, const std::filesystem::path& file);
  Error failure();

  BlenderCall call_;
  std::unique_ptr<PipedProgram> program_;
};

}  // namespace weir::rendering
