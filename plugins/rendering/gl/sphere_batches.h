// Particles in OpenGL's memory, which it draws as a rectangle each (shaders/corner.glsl).
#pragma once

#include <span>
#include <vector>

#include "plugins/rendering/gl/resources.h"
#include "plugins/rendering/view.h"

namespace weir::rendering::gl {

class SphereBatches {
 public:
  struct Batch {
    Buffer centers;
    GLsizei particles;
    float radius;       ///< m
    std::size_t owner;  ///< as add() was told
  };

  explicit SphereBatches(const Functions& gl);

  void clear() { batches_.clear(); }
  /// Sends the particles at finite places, each with numberOf(its index), and returns the box around their
  /// spheres.
  template <class NumberOf>
  Aabb add(const ParticleView& particles, std::size_t owner, const NumberOf& numberOf);

  /// Draws the batches for which prepare(batch) is true. It may set uniforms of the program, which is in use.
  template <class Prepare>
  void draw(const Program& program, const Prepare& prepare) const;

 private:
  void send(const ParticleView& particles, std::size_t owner);
  void draw(const Batch& batch) const;

  const Functions& gl_;
  VertexArray array_;
  Buffer indices_;
  Texture centers_;
  std::size_t largest_;
  std::vector<Batch> batches_;
  std::vector<Vec4f> packed_;
};

template <class NumberOf>
Aabb SphereBatches::add(const ParticleView& particles, std::size_t owner, const NumberOf& numberOf) {
  packed_.clear();
  packed_.reserve(particles.positions.size());
  Aabb box;
  for (std::size_t i = 0; i < particles.positions.size(); ++i) {
    const Vec3f& p = particles.positions[i];
    if (!isFinite(p)) continue;
    box.extend(p);
    packed_.push_back({p.x, p.y, p.z, numberOf(i)});
  }
  if (packed_.empty()) return box;
  send(particles, owner);
  const Vec3f around{particles.radius, particles.radius, particles.radius};
  return {box.lo - around, box.hi + around};
}

template <class Prepare>
void SphereBatches::draw(const Program& program, const Prepare& prepare) const {
  if (batches_.empty()) return;
  program.use();
  gl_.bindVertexArray(array_.name());
  program.setTexture("uCenters", 0, centers_, GL_TEXTURE_BUFFER);
  for (const Batch& batch : batches_)
    if (prepare(batch)) draw(batch);
}

}  // namespace weir::rendering::gl
