#include "plugins/rendering/gl/renderer.h"

#include <algorithm>
#include <optional>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "plugins/rendering/compute/compute_renderer.h"
#include "plugins/rendering/gl/context.h"
#include "plugins/rendering/gl/drawn_spheres.h"
#include "plugins/rendering/gl/glass_pass.h"
#include "plugins/rendering/gl/lighting_pass.h"
#include "plugins/rendering/gl/line_pass.h"
#include "plugins/rendering/gl/mesh_store.h"
#include "plugins/rendering/gl/occlusion_pass.h"
#include "plugins/rendering/gl/shadow_pass.h"
#include "plugins/rendering/gl/splatted_spheres.h"
#include "plugins/rendering/gl/surface_pass.h"
#include "plugins/rendering/gl/water_pass.h"
#include "plugins/rendering/gl/water_shadow.h"

namespace weir::rendering::gl {
namespace {

constexpr float kNearest = 0;

std::unique_ptr<SphereDrawer> makeSphereDrawer(const Functions& gl, Device* splatDevice) {
  if (splatDevice == nullptr) return std::make_unique<DrawnSpheres>(gl);
  return std::make_unique<SplattedSpheres>(*splatDevice);
}

struct Liquids {
  explicit Liquids(const Functions& gl) : surfaces(gl), shadows(gl), pass(gl) {}

  WaterSurfacePass surfaces;
  WaterShadow shadows;
  WaterPass pass;
};

}  // namespace

class Renderer::Passes {
 public:
  Passes(const Functions& functions, Device* splatDevice)
      : gl(functions), particles_(makeSphereDrawer(gl, splatDevice)) {
    gl.getIntegerv(GL_MAX_TEXTURE_SIZE, &largest_);
  }

  Picture draw(const View& view);

  const Functions& gl;
  MeshStore meshes{gl};

 private:
  int samplesFor(const View& view) const;
  Aabb load(const View& view);
  void drawGeometry(const Frame& frame);
  void drawClear(const Frame& frame);
  Picture read(bool transparent) const;

  std::unique_ptr<SphereDrawer> particles_;
  SurfacePass surfaces_{gl};
  ShadowPass shadows_{gl};
  OcclusionPass occlusion_{gl};
  Environment environment_{gl};
  LightingPass lighting_{gl};
  LinePass lines_{gl};
  GlassPass glass_{gl};
  std::optional<Liquids> liquids_;  // once there are any: their programs take time to build
  Texture nothingBefore_{gl, 1, 1, kFloat1, GL_NEAREST, &kNearest};  // with the depth of the eye
  std::optional<Targets> targets_;
  GLint largest_ = 0;
};

int Renderer::Passes::samplesFor(const View& view) const {
  const int larger = std::max(view.width, view.height);
  if (larger > largest_)
    throw ioError("a picture of " + std::to_string(view.width) + " x " + std::to_string(view.height) +
                      " pixels is larger than the OpenGL driver can draw",
                  "at most " + std::to_string(largest_) + " pixels wide and high");
  return std::min({view.samplesPerAxis, kMaxSamples, largest_ / larger});
}

/// Sends what has changed to the GPU; returns the box around all that casts shadows.
Aabb Renderer::Passes::load(const View& view) {
  Aabb casters = particles_->load(view.particles);
  if (!view.waters.empty() && !liquids_) liquids_.emplace(gl);
  for (const SurfaceView& surface : view.surfaces)
    casters.extend(placedBounds(meshes.bounds(surface.mesh), surface));
  return casters;
}

void Renderer::Passes::drawGeometry(const Frame& frame) {
  const bool particlesFirst = particles_->replacesAll();
  if (!particlesFirst) {
    targets_->geometry.clearColor(0, {0, 0, 0, 0});
    targets_->geometry.clearColor(1, {0.5f, 0.5f, 0, 0});  // towards the eye
    targets_->geometry.clearDepth();
  }
  targets_->geometry.bind();
  if (particlesFirst) particles_->drawGeometry(frame, *targets_);
  surfaces_.draw(frame, meshes, particlesFirst);
  setState(gl, {.depthTest = GL_LEQUAL});
  if (!particlesFirst) particles_->drawGeometry(frame, *targets_);
}

/// Liquids, glass and lines over the lit scene.
void Renderer::Passes::drawClear(const Frame& frame) {
  const auto drawBehind = [&](const Texture& before) {
    lines_.draw(frame, *targets_, before);
    glass_.draw(frame, *targets_, meshes, before, environment_);
  };
  if (!frame.view.waters.empty())
    liquids_->pass.draw(frame, *targets_,
                        {meshes, *particles_, shadows_, liquids_->shadows, liquids_->surfaces, environment_},
                        drawBehind);
  drawBehind(nothingBefore_);
}

Picture Renderer::Passes::read(bool transparent) const {
  Picture picture{targets_->pictureWidth, targets_->pictureHeight, {}};
  picture.rgb.resize(3 * std::size_t(picture.width) * std::size_t(picture.height));
  gl.pixelStorei(GL_PACK_ALIGNMENT, 1);
  targets_->picture.target.bind();
  gl.readPixels(0, 0, picture.width, picture.height, GL_RGB, GL_UNSIGNED_BYTE, picture.rgb.data());
  if (!transparent) return picture;
  picture.alpha.resize(picture.rgb.size() / 3);
  gl.readPixels(0, 0, picture.width, picture.height, GL_ALPHA, GL_UNSIGNED_BYTE, picture.alpha.data());
  return picture;
}

Picture Renderer::Passes::draw(const View& view) {
  WEIR_CHECK(view.width > 0);
  WEIR_CHECK(view.height > 0);
  WEIR_CHECK(view.samplesPerAxis > 0);
  const int samples = samplesFor(view);
  const Aabb casters = load(view);
  const Frame frame = makeFrame(view, samples, casters);
  if (!targets_ || targets_->pictureWidth != view.width || targets_->pictureHeight != view.height ||
      targets_->samples != samples) {
    targets_.reset();  // the old ones go before the new ones come: pictures can be large
    targets_.emplace(gl, view.width, view.height, samples);
  }
  if (frame.hasShadows) {
    shadows_.draw(frame, meshes, *particles_);
    if (!view.waters.empty()) liquids_->shadows.draw(frame, meshes, *particles_, liquids_->surfaces);
  }
  drawGeometry(frame);
  if (view.lighting.occlusion && !view.lighting.unlit) {
    occlusion_.draw(frame, *targets_, occlusionOf(frame, casters));
  } else {
    occlusion_.clear(*targets_);
  }
  environment_.load(view);
  lighting_.draw(frame, *targets_, shadows_, liquids_ ? &liquids_->shadows : nullptr, environment_);
  drawClear(frame);
  lighting_.resolve(frame, *targets_);
  Picture picture = read(view.transparent);
  if (const GLenum error = gl.getError(); error != GL_NO_ERROR)
    throw ioError(error == GL_OUT_OF_MEMORY ? "the OpenGL driver has too little memory for this picture"
                                            : "OpenGL error " + std::to_string(error) + " in a picture");
  return picture;
}

Renderer::Renderer(std::unique_ptr<Context> context, std::unique_ptr<Device> device, ComputeShare share)
    : context_(std::move(context)), device_(std::move(device)) {
  const bool drawsAlone = device_ != nullptr && share == ComputeShare::kWhatCanBe;
  if (drawsAlone) compute_ = std::make_unique<ComputeRenderer>(*device_);
  const CurrentContext current(*context_);
  // What the device does not draw alone is left to OpenGL if that is a GPU's: textures would have to go
  // there.
  const bool splats =
      device_ != nullptr && share != ComputeShare::kNothing && (!drawsAlone || context_->isSoftware());
  passes_ = std::make_unique<Passes>(context_->functions(), splats ? device_.get() : nullptr);
}

Renderer::~Renderer() {
  const CurrentContext current(*context_);
  passes_.reset();
}

MeshId Renderer::addMesh(const TriangleMesh& mesh) {
  const CurrentContext current(*context_);
  return passes_->meshes.add(mesh);
}

void Renderer::replaceMesh(MeshId id, const ShownMesh& mesh) {
  const CurrentContext current(*context_);
  passes_->meshes.replace(id, mesh);
}

bool Renderer::readsDevice(const View& view) const {
  return compute_ && ComputeRenderer::canDraw(view);
}

Picture Renderer::draw(const View& view) {
  if (readsDevice(view)) return compute_->draw(view);
  for (const ParticleView& particles : view.particles) WEIR_CHECK(!particles.onDevice);
  const CurrentContext current(*context_);
  return passes_->draw(view);
}

const std::string& Renderer::description() const {
  return context_->description();
}

}  // namespace weir::rendering::gl
