// Draws pictures on a compute device alone: no OpenGL, and on a GPU all of its processors, of which OpenGL
// may have few. It draws particles, ground and lines; surfaces are OpenGL's.
#pragma once

#include "framework/communication/communicator.h"
#include "plugins/rendering/compute/occlusion_kernels.h"
#include "plugins/rendering/compute/seen_spheres.h"
#include "plugins/rendering/compute/shade_kernels.h"
#include "plugins/rendering/compute/sphere_set.h"
#include "plugins/video/picture.h"
#include "plugins/views/device_output.h"
#include "plugins/views/picture_maker.h"

namespace weir::rendering {

namespace gl {
struct Frame;
}

class ComputeRenderer final : public PictureMaker {
 public:
  /// No other thread may use the device while a picture is drawn.
  explicit ComputeRenderer(Device& device);

  /// Whether the view holds nothing else than what is drawn here.
  static bool canDraw(const View& view);
  /// The picture that gl::Renderer gives of the same view, but for rounding.
  Picture draw(const View& view) override;

  // Of the particles of several ranks: all find what is seen, and one draws it.
  /// What is seen of them, on rank 0; on others of their own. All take part, with views that are alike but
  /// for their particles.
  SeenOfRanks seenOf(const View& view, Communicator& ranks);
  /// The picture that draw() gives of a view with the particles of all ranks, one rank behind the other.
  Picture draw(const View& view, const SeenOfRanks& seen);

  MeshId addMesh(const TriangleMesh&) override;
  void replaceMesh(MeshId, const ShownMesh&) override;
  Device* device() const override { return &device_; }
  bool readsDevice(const View& view) const override { return canDraw(view); }

 private:
  void clearToGround(const gl::Frame& frame);
  void splat(const gl::Frame& frame);
  std::vector<SeenSphere> listed(std::int64_t first, std::int64_t count);
  void setLines(const gl::Frame& frame);
  ShadedPicture shadedPicture(const gl::Frame& frame, ArrayView<const SplatSphere> spheres);
  Picture shaded(const gl::Frame& frame, const Aabb& casters, ArrayView<const SplatSphere> spheres);

  Device& device_;
  SphereSet spheres_{device_};
  Array<std::uint64_t> nearest_{device_};
  Array<std::uint32_t> shadow_{device_};
  const Array<float> linear_;  // of bytes
  Array<float> open_{device_}, scratch_{device_}, distances_{device_};
  Array<Vec2f> tiles_{device_}, tileScratch_{device_};  // of the shadow map
  Array<std::uint8_t> rgb_{device_};
  Array<ShadedLine> lines_{device_};
  DeviceOutput<std::uint8_t> picture_{device_};
  // Of several ranks.
  Array<int> samples_{device_}, found_{device_, 1};
  Array<std::int64_t> ends_{device_};
  Array<SeenSphere> listed_{device_};
  DeviceInput<SeenSphere> seen_{device_};
  Array<SplatSphere> placed_{device_};
};

}  // namespace weir::rendering
