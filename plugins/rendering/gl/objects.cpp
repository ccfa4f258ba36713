#include "plugins/rendering/gl/objects.h"

#include "framework/base/check.h"
#include "framework/base/error.h"

namespace weir::rendering {

namespace {

Handle compile(const Functions& gl, std::string_view name, GLenum kind, std::string_view source) {
  Handle shader(gl, gl.CreateShader(kind), [](const Functions& g, GLuint id) { g.DeleteShader(id); });
  const auto* text = reinterpret_cast<const GLchar*>(source.data());
  const auto length = static_cast<GLint>(source.size());
  gl.ShaderSource(shader.id(), 1, &text, &length);
  gl.CompileShader(shader.id());
  GLint good = GL_FALSE;
  gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &good);
  if (good == GL_TRUE) return shader;
  std::string log(2000, '\0');
  GLsizei size = 0;
  gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &size, log.data());
  throw simulationError("the shader '" + std::string(name) +
                        "' does not compile: " + log.substr(0, static_cast<std::size_t>(size)));
}

Handle link(const Functions& gl, std::string_view name, std::string_view vertex, std::string_view fragment) {
  const Handle v = compile(gl, name, GL_VERTEX_SHADER, vertex);
  const Handle f = compile(gl, name, GL_FRAGMENT_SHADER, fragment);
  Handle program(gl, gl.CreateProgram(), [](const Functions& g, GLuint id) { g.DeleteProgram(id); });
  gl.AttachShader(program.id(), v.id());
  gl.AttachShader(program.id(), f.id());
  gl.LinkProgram(program.id());
  GLint good = GL_FALSE;
  gl.GetProgramiv(program.id(), GL_LINK_STATUS, &good);
  if (good != GL_TRUE) throw simulationError("the shader '" + std::string(name) + "' does not link");
  return program;
}

template <class Generate>
GLuint generated(Generate generate) {
  GLuint id = 0;
  generate(1, &id);
  return id;
}

}  // namespace

Shader::Shader(const Functions& gl, std::string_view name, std::string_view vertex, std::string_view fragment)
    : program_(link(gl, name, vertex, fragment)) {}

void Shader::set(const char* name, int value) const {
  program_.gl().Uniform1i(location(name), value);
}
void Shader::set(const char* name, float value) const {
  program_.gl().Uniform1f(location(name), value);
}
void Shader::set(const char* name, float x, float y) const {
  program_.gl().Uniform2f(location(name), x, y);
}
void Shader::set(const char* name, const Vec3f& value) const {
  program_.gl().Uniform3f(location(name), value.x, value.y, value.z);
}
void Shader::set(const char* name, const Vec4f& value) const {
  program_.gl().Uniform4f(location(name), value.x, value.y, value.z, value.w);
}
void Shader::set(const char* name, const Eigen::Matrix4f& value) const {
  program_.gl().UniformMatrix4fv(location(name), 1, GL_FALSE, value.data());
}
void Shader::setTexture(const char* name, int unit, GLuint texture) const {
  program_.gl().ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  program_.gl().BindTexture(GL_TEXTURE_2D, texture);
  set(name, unit);
}

Texture::Texture(const Functions& gl, GLenum internalFormat, int width, int height, GLenum filter)
    : texture_(gl, generated(gl.GenTextures),
               [](const Functions& g, GLuint id) { g.DeleteTextures(1, &id); }),
      width_(width),
      height_(height) {
  const bool depth = internalFormat == GL_DEPTH_COMPONENT32F;
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.TexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(internalFormat), width, height, 0,
                depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
  for (const GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    gl.TexParameteri(GL_TEXTURE_2D, which, static_cast<GLint>(filter));
  for (const GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
    gl.TexParameteri(GL_TEXTURE_2D, which, GL_CLAMP_TO_EDGE);
}

void Texture::upload(int width, int height, const std::vector<std::uint8_t>& rgb) {
  WEIR_CHECK(rgb.size() ==
             std::size_t(3) * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const Functions& gl = texture_.gl();
  gl.BindTexture(GL_TEXTURE_2D, texture_.id());
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
  width_ = width, height_ = height;
}

Framebuffer::Framebuffer(const Functions& gl, const std::vector<const Texture*>& colors, const Texture* depth)
    : framebuffer_(gl, generated(gl.GenFramebuffers),
                   [](const Functions& g, GLuint id) { g.DeleteFramebuffers(1, &id); }) {
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  std::vector<GLenum> buffers;
  for (const Texture* color : colors) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size()));
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, buffers.back(), GL_TEXTURE_2D, color->id(), 0);
    width_ = color->width(), height_ = color->height();
  }
  if (depth != nullptr) {
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->id(), 0);
    width_ = depth->width(), height_ = depth->height();
  }
  if (buffers.empty()) buffers.push_back(GL_NONE);
  gl.DrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  gl.ReadBuffer(buffers.front());
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    throw simulationError("a picture of " + std::to_string(width_) + " x " + std::to_string(height_) +
                              " pixels cannot be made on this OpenGL",
                          {}, "use a smaller render.width and render.height");
}

void Framebuffer::bind() const {
  framebuffer_.gl().BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.id());
  framebuffer_.gl().Viewport(0, 0, width_, height_);
}

VertexArray::VertexArray(const Functions& gl)
    : array_(gl, generated(gl.GenVertexArrays),
             [](const Functions& g, GLuint id) { g.DeleteVertexArrays(1, &id); }),
      buffer_(gl, generated(gl.GenBuffers), [](const Functions& g, GLuint id) { g.DeleteBuffers(1, &id); }) {}

void VertexArray::upload(const std::vector<float>& data, std::initializer_list<int> sizes, bool perInstance) {
  const Functions& gl = array_.gl();
  int stride = 0;
  for (const int size : sizes) stride += size;
  count_ = static_cast<int>(data.size()) / stride;
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer_.id());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * sizeof(float)), data.data(),
                GL_STREAM_DRAW);
  GLuint location = 0;
  std::size_t offset = 0;
  for (const int size : sizes) {
    gl.EnableVertexAttribArray(location);
    gl.VertexAttribPointer(location, size, GL_FLOAT, GL_FALSE, stride * static_cast<int>(sizeof(float)),
                           reinterpret_cast<const void*>(offset * sizeof(float)));
    gl.VertexAttribDivisor(location, perInstance ? 1 : 0);
    ++location;
    offset += static_cast<std::size_t>(size);
  }
}

void VertexArray::drawTriangles() const {
  if (empty()) return;
  array_.gl().BindVertexArray(array_.id());
  array_.gl().DrawArrays(GL_TRIANGLES, 0, count_);
}

void VertexArray::drawQuads() const {
  if (empty()) return;
  array_.gl().BindVertexArray(array_.id());
  array_.gl().DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
}

}  // namespace weir::rendering
