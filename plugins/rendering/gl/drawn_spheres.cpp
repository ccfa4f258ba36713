#include "plugins/rendering/gl/drawn_spheres.h"

#include "framework/base/check.h"
#include "plugins/rendering/gl/particle_colors.h"

namespace weir::rendering::gl {

Aabb DrawnSpheres::load(std::span<const ParticleView> views) {
  batches_.clear();
  groups_.clear();
  Aabb box;
  for (const ParticleView& view : views) {
    const std::span<const float> values = view.water ? view.foam : view.values;
    if (!values.empty()) WEIR_CHECK(values.size() == view.positions.size());
    if (view.water && !liquids_) liquids_.emplace(gl_);
    Group group{view.water, view.white, view.radius, view.inset(), view.chord(), {}};
    if (!view.water)
      group.colors = Texture(gl_, ColorEntries::kCount, 1, kColor8, GL_LINEAR, particleColors(view).data());
    const ColorEntries entries{view.lowest, view.highest};
    // Parts of foam, or texture coordinates of places among the texels of the colours.
    box.extend(batches_.add(view, groups_.size(), [&](std::size_t i) {
      if (view.water) return values.empty() ? 0.0f : values[i];
      const float entry = values.empty() ? float(ColorEntries::kFixed) : entries.of(values[i]);
      return (entry + 0.5f) / float(ColorEntries::kCount);
    }));
    groups_.push_back(std::move(group));
  }
  return box;
}

template <class SetUniforms>
void DrawnSpheres::draw(const Program& program, Liquid liquid, const SetUniforms& setUniforms,
                        bool white) const {
  batches_.draw(program, [&](std::size_t owner) {
    const Group& group = groups_[owner];
    if (group.liquid != liquid || (group.white && !white)) return false;
    program.set("uRadius", group.radius);
    setUniforms(group);
    return true;
  });
}

/// Of the programs that draw spheres as the camera sees them.
static void useForCamera(const Program& program, const Frame& frame) {
  program.use();
  setCameraUniforms(program, frame.camera, frame.width, frame.height);
  program.setMatrix4("uView", frame.camera.view.data());
  program.set("uNear", frame.camera.near);
}

void DrawnSpheres::drawGeometry(const Frame& frame, const Targets&) {
  useForCamera(geometry_, frame);
  draw(geometry_, {}, [&](const Group& group) { geometry_.setTexture("uColors", group.colors); });
}

void DrawnSpheres::drawSunDepth(const SunView& sun, Liquid liquid, const Texture&) {
  sunDepth_.use();
  sunDepth_.setMatrix4("uToClip", sun.toClip().eval().data());
  const auto setRadius = [&](const Group& group) {
    sunDepth_.set("uRadiusInClip", group.radius / sun.halfSize);
    sunDepth_.set("uRadiusInDepth", 2 * group.radius / (sun.zNearest - sun.zFarthest));
  };
  constexpr bool kWhite = false;  // light gets through
  draw(sunDepth_, liquid, setRadius, kWhite);
}

void DrawnSpheres::drawDepth(const Frame& frame, std::size_t liquid, const Texture&) {
  if (!liquids_) return;
  useForCamera(liquids_->depth, frame);
  draw(liquids_->depth, liquid, [&](const Group& group) { liquids_->depth.set("uInset", group.inset); });
}

void DrawnSpheres::addThickness(std::size_t liquid, const Texture& map, float foamDepth) const {
  const Program& program = liquids_->thickness;
  program.set("uSize", Vec2f{float(map.width), float(map.height)});
  setState(gl_, {.source = GL_ONE, .destination = GL_ONE});
  draw(program, liquid, [&](const Group& group) {
    program.set("uChord", group.chord);
    program.set("uFoamDepth", foamDepth * group.radius);
  });
}

void DrawnSpheres::drawThickness(const Frame& frame, std::size_t liquid, const Texture& front,
                                 const Canvas& background, const Texture& map) {
  if (!liquids_) return;
  const Program& program = liquids_->thickness;
  program.use();
  setCameraUniforms(program, frame.camera, map.width, map.height);
  program.setMatrix4("uToClip", (frame.camera.projection() * frame.camera.view).eval().data());
  program.set("uTexels", 0.5f * float(map.height) / frame.camera.tangent.y);
  program.set("uNear", frame.camera.near);
  program.setTexture("uFront", front);
  program.setTexture("uBackground", background.texture);
  addThickness(liquid, map, kFoamDepth);
}

void DrawnSpheres::drawSunThickness(const SunView& sun, std::size_t liquid, const Texture& map) {
  if (!liquids_) return;
  const Program& program = liquids_->thickness;
  program.use();
  program.setMatrix4("uToClip", sun.toClip().eval().data());
  program.set("uTexels", 0.5f * float(map.height) / sun.halfSize);
  program.set("uNear", 0.0f);
  program.setTexture("uFront", nothing_);
  program.setTexture("uBackground", nothing_);
  addThickness(liquid, map, 0);
}

}  // namespace weir::rendering::gl
