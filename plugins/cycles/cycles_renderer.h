// Pictures by Cycles, the path tracer of Blender.
#pragma once

#include <filesystem>
#include <memory>

#include "plugins/cycles/blender_program.h"
#include "plugins/cycles/handover.h"
#include "plugins/views/picture_maker.h"

namespace weir::rendering {

/// A folder of this process alone, gone with it.
class OwnFolder {
 public:
  /// Below the system's folder for such files. Throws an io Error.
  OwnFolder();
  ~OwnFolder();
  OwnFolder(const OwnFolder&) = delete;
  OwnFolder& operator=(const OwnFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

class CyclesRenderer final : public PictureMaker {
 public:
  /// Views are prepared on the device. Throws an io Error if there is no Blender.
  CyclesRenderer(std::unique_ptr<Device> device, const CyclesSettings& settings, double frameRate);

  MeshId addMesh(const TriangleMesh& mesh) override { return handover_.addMesh(mesh); }
  void replaceMesh(MeshId id, const ShownMesh& mesh) override { handover_.replaceMesh(id, mesh); }
  /// Minutes may pass.
  Picture draw(const View& view) override;
  Device* device() const override { return device_.get(); }
  bool readsDevice(const View&) const override { return false; }

 private:
  std::unique_ptr<Device> device_;
  OwnFolder folder_;
  Handover handover_;
  BlenderProgram blender_;
  bool interrupted_ = false;
};

}  // namespace weir::rendering
