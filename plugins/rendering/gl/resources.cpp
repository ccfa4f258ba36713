#include "plugins/rendering/gl/resources.h"

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

GLuint compile(const Functions& gl, GLenum stage, const std::string& name, const std::string& source) {
  const GLuint shader = gl.createShader(stage);
  const char* text = source.c_str();
  gl.shaderSource(shader, 1, &text, nullptr);
  gl.compileShader(shader);
  GLint ok = GL_FALSE;
  gl.getShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  std::string messages(4096, '\0');
  GLsizei size = 0;
  gl.getShaderInfoLog(shader, GLsizei(messages.size()), &size, messages.data());
  messages.resize(std::size_t(size));
  gl.deleteShader(shader);
  throw InternalError("the shader " + name + " does not compile: " + messages);
}

}  // namespace

Buffer makeBuffer(const Functions& gl) {
  GLuint name = 0;
  gl.genBuffers(1, &name);
  return {gl, name};
}

VertexArray makeVertexArray(const Functions& gl) {
  GLuint name = 0;
  gl.genVertexArrays(1, &name);
  return {gl, name};
}

void upload(const Buffer& buffer, GLenum target, std::span<const std::byte> bytes, GLenum usage) {
  buffer.gl().bindBuffer(target, buffer.name());
  buffer.gl().bufferData(target, GLsizeiptr(bytes.size()), bytes.data(), usage);
}

Texture makeTexture(const Functions& gl, int width, int height, const TextureFormat& format, GLint filter,
                    const void* pixels) {
  GLuint name = 0;
  gl.genTextures(1, &name);
  Texture texture(gl, name);
  gl.bindTexture(GL_TEXTURE_2D, name);
  gl.texImage2D(GL_TEXTURE_2D, 0, GLint(format.internalFormat), width, height, 0, format.format, format.type,
                pixels);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.texParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

Framebuffer makeFramebuffer(const Functions& gl, const std::vector<const Texture*>& colors,
                            const Texture* depth) {
  GLuint name = 0;
  gl.genFramebuffers(1, &name);
  Framebuffer framebuffer(gl, name);
  gl.bindFramebuffer(GL_FRAMEBUFFER, name);
  std::vector<GLenum> attachments;
  for (const Texture* color : colors) {
    attachments.push_back(GLenum(GL_COLOR_ATTACHMENT0 + attachments.size()));
    gl.framebufferTexture2D(GL_FRAMEBUFFER, attachments.back(), GL_TEXTURE_2D, color->name(), 0);
  }
  if (depth) gl.framebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->name(), 0);
  if (attachments.empty()) attachments.push_back(GL_NONE);
  gl.drawBuffers(GLsizei(attachments.size()), attachments.data());
  gl.readBuffer(attachments.front());
  const GLenum status = gl.checkFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw ioError("the OpenGL driver cannot draw into a picture of this size and format (status " +
                  std::to_string(status) + ")");
  return framebuffer;
}

Program::Program(const Functions& gl, const std::string& vertex, const std::string& fragment,
                 const std::string& defines)
    : program_(gl, gl.createProgram()) {
  const GLuint id = program_.name();
  for (const auto& [stage, name] :
       {std::pair{GL_VERTEX_SHADER, &vertex}, std::pair{GL_FRAGMENT_SHADER, &fragment}}) {
    const GLuint shader = compile(gl, GLenum(stage), *name, shaderSource(*name, defines));
    gl.attachShader(id, shader);
    gl.deleteShader(shader);  // goes when the program goes
  }
  gl.linkProgram(id);
  GLint ok = GL_FALSE;
  gl.getProgramiv(id, GL_LINK_STATUS, &ok);
  if (ok) return;
  std::string messages(4096, '\0');
  GLsizei size = 0;
  gl.getProgramInfoLog(id, GLsizei(messages.size()), &size, messages.data());
  messages.resize(std::size_t(size));
  throw InternalError("the shaders " + vertex + " and " + fragment + " do not link: " + messages);
}

FullScreenProgram::FullScreenProgram(const Functions& gl, const std::string& fragment,
                                     const std::string& defines)
    : Program(gl, "full_screen.vert", fragment, defines), array_(makeVertexArray(gl)) {}

void FullScreenProgram::draw() const {
  array_.gl().bindVertexArray(array_.name());
  array_.gl().drawArrays(GL_TRIANGLES, 0, 3);
}

GLint Program::location(const char* uniform) const {
  const auto known = locations_.find(std::string_view(uniform));
  if (known != locations_.end()) return known->second;
  return locations_[uniform] = program_.gl().getUniformLocation(program_.name(), uniform);
}

void Program::set(const char* uniform, int value) const {
  program_.gl().uniform1i(location(uniform), value);
}
void Program::set(const char* uniform, float value) const {
  program_.gl().uniform1f(location(uniform), value);
}
void Program::set(const char* uniform, const Vec2f& value) const {
  program_.gl().uniform2f(location(uniform), value.x, value.y);
}
void Program::set(const char* uniform, const Vec2i& value) const {
  program_.gl().uniform2i(location(uniform), value.x, value.y);
}
void Program::set(const char* uniform, const Vec3f& value) const {
  program_.gl().uniform3f(location(uniform), value.x, value.y, value.z);
}
void Program::set(const char* uniform, const Vec4f& value) const {
  program_.gl().uniform4f(location(uniform), value.x, value.y, value.z, value.w);
}
void Program::setMatrix3(const char* uniform, const float* columns) const {
  program_.gl().uniformMatrix3fv(location(uniform), 1, GL_FALSE, columns);
}
void Program::setMatrix4(const char* uniform, const float* columns) const {
  program_.gl().uniformMatrix4fv(location(uniform), 1, GL_FALSE, columns);
}
void Program::setTexture(const char* uniform, int unit, const Texture& texture, GLenum target) const {
  const Functions& gl = program_.gl();
  gl.activeTexture(GLenum(GL_TEXTURE0 + unit));
  gl.bindTexture(target, texture.name());
  set(uniform, unit);
}

}  // namespace weir::rendering::gl
