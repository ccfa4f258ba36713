#include "plugins/rendering/gl/resources.h"

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering::gl {
namespace {

template <class GetLog>
std::string messagesOf(GLuint object, GetLog getLog) {
  std::string messages(4096, '\0');
  GLsizei size = 0;
  getLog(object, GLsizei(messages.size()), &size, messages.data());
  messages.resize(std::size_t(size));
  return messages;
}

GLuint compile(const Functions& gl, GLenum stage, const std::string& name, const std::string& source) {
  const GLuint shader = gl.createShader(stage);
  const char* text = source.c_str();
  gl.shaderSource(shader, 1, &text, nullptr);
  gl.compileShader(shader);
  GLint ok = GL_FALSE;
  gl.getShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  const std::string messages = messagesOf(shader, gl.getShaderInfoLog);
  gl.deleteShader(shader);
  throw InternalError("the shader " + name + " does not compile: " + messages);
}

/// By one of the functions glGen….
template <class Generate>
GLuint newName(Generate generate) {
  GLuint name = 0;
  generate(1, &name);
  return name;
}

}  // namespace

Buffer makeBuffer(const Functions& gl) {
  return {gl, newName(gl.genBuffers)};
}

VertexArray makeVertexArray(const Functions& gl) {
  return {gl, newName(gl.genVertexArrays)};
}

void upload(const Buffer& buffer, GLenum target, std::span<const std::byte> bytes, GLenum usage) {
  buffer.gl().bindBuffer(target, buffer.name());
  buffer.gl().bufferData(target, GLsizeiptr(bytes.size()), bytes.data(), usage);
}

Texture::Texture(const Functions& gl, int itsWidth, int itsHeight, const TextureFormat& itsFormat,
                 GLint filter, const void* texels)
    : TextureName(gl, newName(gl.genTextures)), width(itsWidth), height(itsHeight), format(itsFormat) {
  gl.bindTexture(GL_TEXTURE_2D, name());
  gl.texImage2D(GL_TEXTURE_2D, 0, GLint(format.internalFormat), width, height, 0, format.format, format.type,
                texels);
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) set(side, GL_CLAMP_TO_EDGE);
  for (const GLenum scaling : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) set(scaling, filter);
}

void Texture::replace(const void* texels) const {
  gl().bindTexture(GL_TEXTURE_2D, name());
  gl().texSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format.format, format.type, texels);
}

void Texture::set(GLenum parameter, GLint value) const {
  gl().bindTexture(GL_TEXTURE_2D, name());
  gl().texParameteri(GL_TEXTURE_2D, parameter, value);
}

Texture makeShadowMap(const Functions& gl, int resolution) {
  Texture map(gl, resolution, resolution, kDepth32F, GL_LINEAR);
  map.set(GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  map.set(GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  return map;
}

Framebuffer::Framebuffer(const Functions& gl, const std::vector<const Texture*>& colors, const Texture* depth)
    : FramebufferName(gl, newName(gl.genFramebuffers)) {
  gl.bindFramebuffer(GL_FRAMEBUFFER, name());
  const auto attach = [&](GLenum place, const Texture& texture) {
    gl.framebufferTexture2D(GL_FRAMEBUFFER, place, GL_TEXTURE_2D, texture.name(), 0);
    width = texture.width, height = texture.height;
  };
  std::vector<GLenum> attachments;
  for (const Texture* color : colors) {
    attachments.push_back(GLenum(GL_COLOR_ATTACHMENT0 + attachments.size()));
    attach(attachments.back(), *color);
  }
  if (depth) attach(GL_DEPTH_ATTACHMENT, *depth);
  if (attachments.empty()) attachments.push_back(GL_NONE);
  gl.drawBuffers(GLsizei(attachments.size()), attachments.data());
  gl.readBuffer(attachments.front());
  const GLenum status = gl.checkFramebufferStatus(GL_FRAMEBUFFER);
  if (status != GL_FRAMEBUFFER_COMPLETE)
    throw ioError(
        "the OpenGL driver cannot draw into a picture of this size "
        "and format (status " +
        std::to_string(status) + ")");
}

void Framebuffer::bind() const {
  gl().bindFramebuffer(GL_FRAMEBUFFER, name());
  gl().viewport(0, 0, width, height);
}

void Framebuffer::clearColor(int target, const std::array<float, 4>& color) const {
  bind();
  gl().clearBufferfv(GL_COLOR, target, color.data());
}

void Framebuffer::clearDepth() const {
  constexpr float kFarthest = 1;
  bind();
  gl().depthMask(GL_TRUE);
  gl().clearBufferfv(GL_DEPTH, 0, &kFarthest);
}

void setState(const Functions& gl, const DrawState& state) {
  const auto turn = [&](GLenum what, bool on) { (on ? gl.enable : gl.disable)(what); };
  turn(GL_DEPTH_TEST, state.depthTest != GL_NONE);
  if (state.depthTest != GL_NONE) gl.depthFunc(state.depthTest);
  gl.depthMask(GLboolean(state.writesDepth));
  turn(GL_BLEND, state.destination != GL_ZERO || state.source != GL_ONE);
  // Always: Mesa 22 refuses to draw into two targets while two sources are set, even if they are not in use.
  gl.blendFunc(state.source, state.destination);
  turn(GL_CULL_FACE, state.culled != GL_NONE);
  if (state.culled != GL_NONE) gl.cullFace(state.culled);
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
  throw InternalError("the shaders " + vertex + " and " + fragment +
                      " do not link: " + messagesOf(id, gl.getProgramInfoLog));
}

FullScreenProgram::FullScreenProgram(const Functions& gl, const std::string& fragment,
                                     const std::string& defines)
    : Program(gl, "full_screen.vert", fragment, defines), array_(makeVertexArray(gl)) {}

void FullScreenProgram::draw(const Framebuffer& target, const DrawState& state) const {
  target.bind();
  setState(array_.gl(), state);
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
void Program::setTexture(const char* uniform, const TextureName& texture, GLenum target) const {
  const Functions& gl = program_.gl();
  const GLint unit = units_.try_emplace(uniform, GLint(units_.size())).first->second;
  gl.activeTexture(GLenum(GL_TEXTURE0 + unit));
  gl.bindTexture(target, texture.name());
  set(uniform, unit);
}

}  // namespace weir::rendering::gl
