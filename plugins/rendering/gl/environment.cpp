#include "plugins/rendering/gl/environment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "framework/base/error.h"

namespace weir::rendering::gl {
namespace {

constexpr int kWidth = 1024, kHeight = 512;

}  // namespace

/// From the world to a space in which y is up.
static Eigen::Matrix3f upright(const View& view) {
  return Eigen::Quaternionf::FromTwoVectors(toEigen(normalized(view.worldUp)), Eigen::Vector3f::UnitY())
      .toRotationMatrix();
}

Eigen::Matrix3f toSurroundings(const Frame& frame) {
  return upright(frame.view) * frame.camera.rotation().transpose();
}

Environment::Environment(const Functions& gl) : gl_(gl), surroundings_(gl, 1, 1, kColor8, GL_NEAREST) {}

void Environment::load(const View& view) {
  if (view.waters.empty() && !hasSurroundings(view)) return;
  if (loaded_ && *loaded_ == view.environment && loadedSun_ == view.lighting.towardsSun &&
      loadedImage_ == view.environmentImage)
    return;
  loaded_ = view.environment;
  loadedSun_ = view.lighting.towardsSun;
  loadedImage_ = view.environmentImage;
  if (view.environment == EnvironmentLook::kImage) {
    upload(*view.environmentImage);
  } else {
    surroundings_ = Texture(gl_, kWidth, kHeight, kColor16F, GL_LINEAR);
    paint(view);
  }
  surroundings_.set(GL_TEXTURE_WRAP_S, GL_REPEAT);
}

void Environment::upload(const EnvironmentImage& image) {
  constexpr TextureFormat kLight{GL_RGB16F, GL_RGB, GL_FLOAT};
  constexpr float kBrightest = 60000;  // of half precision
  GLint largest = 0;
  gl_.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (image.width > largest)
    throw ioError("surroundings of " + std::to_string(image.width) +
                      " pixels are wider than the OpenGL driver can take",
                  "at most " + std::to_string(largest));
  std::vector<Vec3f> light = image.light;
  for (Vec3f& texel : light)
    for (int c = 0; c < 3; ++c) texel[c] = std::min(texel[c], kBrightest);
  surroundings_ = Texture(gl_, image.width, image.height, kLight, GL_LINEAR, light.data());
}

void Environment::paint(const View& view) {
  if (!paint_) paint_.emplace(gl_, "surroundings.frag");
  paint_->use();
  const Eigen::Vector3f sun = upright(view) * toEigen(normalized(view.lighting.towardsSun));
  paint_->set("uTowardsSun", fromEigen(sun));
  paint_->set("uSky", int(view.environment == EnvironmentLook::kSky));
  paint_->draw(Framebuffer(gl_, {&surroundings_}, nullptr));
}

void Environment::setUniforms(const Program& program, const Frame& frame) const {
  program.setMatrix3("uToSurroundings", toSurroundings(frame).data());
  program.set("uAllAround",
              int(frame.view.environment == EnvironmentLook::kImage && !frame.view.ground.visible));
  program.setTexture("uSurroundings", surroundings_);
}

}  // namespace weir::rendering::gl
