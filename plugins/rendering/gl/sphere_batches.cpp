#include "plugins/rendering/gl/sphere_batches.h"

#include <algorithm>
#include <cstdint>

namespace weir::rendering::gl {

namespace {

/// Two triangles for each four corners.
std::vector<std::uint32_t> cornerIndices(std::size_t particles) {
  std::vector<std::uint32_t> indices;
  indices.reserve(6 * particles);
  for (std::uint32_t first = 0; first < 4 * particles; first += 4)
    for (const std::uint32_t k : {0u, 1u, 2u, 2u, 1u, 3u}) indices.push_back(first + k);
  return indices;
}

}  // namespace

SphereBatches::SphereBatches(const Functions& gl)
    : gl_(gl), array_(makeVertexArray(gl)), indices_(makeBuffer(gl)) {
  GLint texels = 0;
  gl.getIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
  constexpr std::size_t kBatch = 1 << 17;  // 3 MB of indices
  largest_ = std::min(kBatch, std::size_t(texels));
  gl.bindVertexArray(array_.name());
  const std::vector<std::uint32_t> indices = cornerIndices(largest_);
  upload(indices_, GL_ELEMENT_ARRAY_BUFFER, std::as_bytes(std::span(indices)), GL_STATIC_DRAW);
  GLuint name = 0;
  gl.genTextures(1, &name);
  centers_ = {gl, name};
}

void SphereBatches::send(std::size_t owner) {
  for (std::size_t first = 0; first < packed_.size(); first += largest_) {
    const auto part = std::span(packed_).subspan(first).first(std::min(packed_.size() - first, largest_));
    batches_.push_back({makeBuffer(gl_), GLsizei(part.size()), owner});
    upload(batches_.back().centers, GL_TEXTURE_BUFFER, std::as_bytes(part), GL_STREAM_DRAW);
  }
}

void SphereBatches::draw(const Program& program, const Batch& batch) const {
  gl_.bindVertexArray(array_.name());
  program.setTexture("uCenters", centers_, GL_TEXTURE_BUFFER);
  gl_.texBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, batch.centers.name());
  gl_.drawElements(GL_TRIANGLES, 6 * batch.particles, GL_UNSIGNED_INT, nullptr);
}

}  // namespace weir::rendering::gl
