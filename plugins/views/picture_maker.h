// Makes pictures of views, whichever program draws them.
#pragma once

#include <memory>

#include "framework/compute/device.h"
#include "framework/geometry/triangle_mesh.h"
#include "plugins/views/shown_mesh.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// Another device on the same machine, for another thread.
std::unique_ptr<Device> siblingOf(const Device& device);

class PictureMaker {
 public:
  PictureMaker() = default;
  virtual ~PictureMaker() = default;
  PictureMaker(const PictureMaker&) = delete;
  PictureMaker& operator=(const PictureMaker&) = delete;

  /// Surfaces stay with it, so that one that keeps its shape is handed over once.
  virtual MeshId addMesh(const TriangleMesh& mesh) = 0;
  virtual void replaceMesh(MeshId id, const ShownMesh& mesh) = 0;

  /// A picture without pixels if the run was interrupted meanwhile and there will be none. Throws an io Error
  /// if it cannot be made, and a scene Error for a camera that looks nowhere.
  virtual Picture draw(const View& view) = 0;

  /// Which prepares views; null without one.
  virtual Device* device() const = 0;
  /// Whether the particles of this view may be in the device's memory (ParticleView::onDevice).
  virtual bool readsDevice(const View& view) const = 0;
};

}  // namespace weir::rendering
