// Draws pictures of particles, surfaces, lines and a ground.
#pragma once

#include <memory>
#include <string>

#include "framework/compute/device.h"
#include "framework/geometry/dynamic_mesh_copy.h"
#include "framework/geometry/triangle_mesh.h"
#include "plugins/views/picture_maker.h"
#include "plugins/views/view.h"

namespace weir::rendering {

class ComputeRenderer;

namespace gl {

class Context;

/// What a compute device does of a picture.
enum class ComputeShare {
  kNothing,    ///< it is there for those who make views
  kParticles,  ///< it finds the particles that are seen
  kWhatCanBe,  ///< it draws all pictures that ComputeRenderer can
};

/// How a picture is made: the nearest surface at each sample (colour, normal, depth) is found first, then lit
/// in linear light by a sun with a soft shadow and by the sky with ambient occlusion; lines and glass come on
/// top; the samples of each pixel are averaged. It may be used from any thread, but from one at a time.
class Renderer final : public PictureMaker {
 public:
  /// Which particles are seen is found by OpenGL, or on a device, which is much faster where OpenGL is
  /// software; the pictures are the same. With `device` and kWhatCanBe, the device alone draws views without
  /// surfaces, and finds particles only where OpenGL is software. Throws an io Error if the driver cannot do
  /// it.
  explicit Renderer(std::unique_ptr<Context> context, std::unique_ptr<Device> device = nullptr,
                    ComputeShare share = ComputeShare::kParticles);
  ~Renderer() override;

  /// Surfaces stay with the renderer, so that one that keeps its shape is sent to the GPU once.
  MeshId addMesh(const TriangleMesh& mesh) override;
  void replaceMesh(MeshId id, const ShownMesh& mesh) override;

  /// Throws an io Error if the picture is larger than the driver allows, and a scene Error for a camera that
  /// looks nowhere. Where `samplesPerAxis` would need textures larger than the driver allows, it is lowered.
  Picture draw(const View& view) override;

  /// Which prepares views and draws what it shares in; null without one.
  Device* device() const override { return device_.get(); }
  /// Whether the particles of this view may be in the device's memory (ParticleView::onDevice).
  bool readsDevice(const View& view) const override;

  /// The renderer and version of the driver.
  const std::string& description() const;

 private:
  class Passes;

  std::unique_ptr<Context> context_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<ComputeRenderer> compute_;  // null: OpenGL draws all pictures
  std::unique_ptr<Passes> passes_;
};

}  // namespace gl
}  // namespace weir::rendering
