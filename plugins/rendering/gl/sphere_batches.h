// Particles in OpenGL's memory, which it draws as a rectangle each (shaders/corner.glsl).
#pragma once

#include <span>
#include <vector>

#include "plugins/rendering/gl/resources.h"
#include "plugins/views/view.h"

namespace weir::rendering::gl {

class SphereBatches {
 public:
  explicit SphereBatches(const Functions& gl);

  void clear() { batches_.clear(); }
  /// Sends the particles at finite places, each with numberOf(its index), and returns the box around their
  /// spheres.
  template <class NumberOf>
  Aabb add(const ParticleView& particles, std::size_t owner, const NumberOf& numberOf);

  /// Draws the batches for which prepare(owner) is true. It may set uniforms of the program, which is in use.
  template <class Prepare>
  void draw(const Program& program, const Prepare& prepare) const;

 private:
  struct Batch {
    Buffer centers;
    GLsizei particles;
    std::size_t owner;  // as add() was told
  };
  void send(std::size_t owner);
  void draw(const Program& program, const Batch& batch) const;

  const Functions& gl_;
  VertexArray array_;
  Buffer indices_;
  TextureName centers_;
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
  send(owner);
  return box.empty() ? box : widened(box, particles.radius);
}

template <class Prepare>
void SphereBatches::draw(const Program& program, const Prepare& prepare) const {
  for (const Batch& batch : batches_)
    if (prepare(batch.owner)) draw(program, batch);
}

}  // namespace weir::rendering::gl
