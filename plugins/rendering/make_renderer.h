// The renderer for a simulation's pictures.
#pragma once

#include <filesystem>
#include <memory>

#include "framework/compute/device.h"
#include "plugins/rendering/gl/renderer.h"

namespace weir::rendering {

/// A GPU that computes draws most pictures alone, because OpenGL may have few of its processors. Where OpenGL
/// is software, a sibling of the device, with as many threads, helps it. Throws an io Error without OpenGL.
std::unique_ptr<gl::Renderer> makeRenderer(const Device& device);

/// share/weir/fonts of the build or installation that this library is in: <prefix>/lib/weir/plugins.
std::filesystem::path fontFolder();

}  // namespace weir::rendering
