// Owners of OpenGL objects. They live no longer than the context they were made in.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"
#include "plugins/rendering/gl/functions.h"

namespace weir::rendering {

/// A number of OpenGL that is deleted with its owner.
class Handle {
 public:
  using Deleter = void (*)(const Functions&, GLuint);
  Handle(const Functions& gl, GLuint id, Deleter deleter) : gl_(&gl), id_(id), deleter_(deleter) {}
  ~Handle() {
    if (id_ != 0) deleter_(*gl_, id_);
  }
  Handle(Handle&& other) noexcept : gl_(other.gl_), id_(other.id_), deleter_(other.deleter_) {
    other.id_ = 0;
  }
  Handle& operator=(Handle&& other) noexcept {
    std::swap(gl_, other.gl_), std::swap(id_, other.id_), std::swap(deleter_, other.deleter_);
    return *this;
  }
  GLuint id() const { return id_; }
  const Functions& gl() const { return *gl_; }

 private:
  const Functions* gl_;
  GLuint id_;
  Deleter deleter_;
};

/// A program of a vertex and a fragment shader.
class Shader {
 public:
  /// Throws a simulation Error with the compiler's text; `name` says which one it is.
  Shader(const Functions& gl, std::string_view name, std::string_view vertex, std::string_view fragment);

  void use() const { program_.gl().UseProgram(program_.id()); }
  // Uniforms of the program, which must be in use. Names that the compiler dropped are ignored.
  void set(const char* name, int value) const;
  void set(const char* name, float value) const;
  void set(const char* name, float x, float y) const;
  void set(const char* name, const Vec3f& value) const;
  void set(const char* name, const Vec4f& value) const;
  void set(const char* name, const Eigen::Matrix4f& value) const;
  /// Binds a 2D texture to a unit and the sampler to it.
  void setTexture(const char* name, int unit, GLuint texture) const;

 private:
  GLint location(const char* name) const { return program_.gl().GetUniformLocation(program_.id(), name); }
  Handle program_;
};

class Texture {
 public:
  /// Without contents; `filter` is GL_NEAREST or GL_LINEAR.
  Texture(const Functions& gl, GLenum internalFormat, int width, int height, GLenum filter = GL_NEAREST);
  /// RGB bytes.
  void upload(int width, int height, const std::vector<std::uint8_t>& rgb);
  GLuint id() const { return texture_.id(); }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  Handle texture_;
  int width_, height_;
};

class Framebuffer {
 public:
  /// Draws into the color textures in their order, and the depth texture if it is not null.
  Framebuffer(const Functions& gl, const std::vector<const Texture*>& colors, const Texture* depth);
  /// Binds it and sets the viewport to the size of its textures.
  void bind() const;

 private:
  Handle framebuffer_;
  int width_ = 0, height_ = 0;
};

/// Vertices or instances with float attributes.
class VertexArray {
 public:
  explicit VertexArray(const Functions& gl);
  /// Attributes of `sizes[k]` floats each at location k, interleaved; `perInstance` for instanced drawing.
  void upload(const std::vector<float>& data, std::initializer_list<int> sizes, bool perInstance);
  void drawTriangles() const;
  /// Four corners for each instance, as a strip; the corner is gl_VertexID.
  void drawQuads() const;
  bool empty() const { return count_ == 0; }

 private:
  Handle array_, buffer_;
  int count_ = 0;
};

}  // namespace weir::rendering
