// Draws pictures on a compute device alone: no OpenGL, and on a GPU all of its processors, of which OpenGL
// may have few. It draws particles, ground and lines; surfaces are OpenGL's.
#pragma once

#include "plugins/rendering/compute/occlusion_kernels.h"
#include "plugins/rendering/compute/shade_kernels.h"
#include "plugins/rendering/compute/sphere_set.h"
#include "plugins/rendering/gl/frame.h"
#include "plugins/video/picture.h"
#include "plugins/views/device_output.h"

namespace weir::rendering {

class ComputeRenderer {
 public:
  /// No other thread may use the device while a picture is drawn.
  explicit ComputeRenderer(Device& device);

  /// Whether the view holds nothing else than what is drawn here.
  static bool canDraw(const View& view);
  /// The picture that gl::Renderer gives of the same view, but for rounding.
  Picture draw(const View& view);

 private:
  void setLines(const gl::Frame& frame);
  ShadedPicture shadedPicture(const gl::Frame& frame);

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
};

}  // namespace weir::rendering
