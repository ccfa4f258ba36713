// The renderer for a simulation's pictures.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/compute/device.h"
#include "plugins/rendering/gl/renderer.h"

namespace weir::rendering {

/// With a device of its own, of the same hardware. That draws alone what its kernels can draw, unless OpenGL
/// runs on a GPU and the device is a CPU. Throws an io Error without OpenGL.
std::unique_ptr<gl::Renderer> makeRenderer(const Device& device);

/// share/weir/fonts of the build or installation that this library is in: <prefix>/lib/weir/plugins.
std::filesystem::path fontFolder();

}  // namespace weir::rendering
