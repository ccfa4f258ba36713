// Owners of OpenGL objects. A context that shares them must be current when they are made, used and
// destroyed.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "framework/base/vec.h"
#include "plugins/rendering/gl/functions.h"

namespace weir::rendering::gl {

/// The name of one GL object, which `Delete`, a member of Functions, deletes with it.
template <auto Delete>
class Object {
 public:
  Object() = default;
  Object(const Functions& gl, GLuint name) : gl_(&gl), name_(name) {}
  Object(Object&& other) noexcept
      : gl_(std::exchange(other.gl_, nullptr)), name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(gl_, other.gl_);
    std::swap(name_, other.name_);
    return *this;
  }
  ~Object() {
    if (!name_) return;
    if constexpr (std::is_same_v<decltype(Delete), PFNGLDELETEPROGRAMPROC Functions::*>)
      (gl_->*Delete)(name_);
    else
      (gl_->*Delete)(1, &name_);
  }
  GLuint name() const { return name_; }
  const Functions& gl() const { return *gl_; }

 private:
  const Functions* gl_ = nullptr;
  GLuint name_ = 0;
};

using Buffer = Object<&Functions::deleteBuffers>;
using VertexArray = Object<&Functions::deleteVertexArrays>;
using TextureName = Object<&Functions::deleteTextures>;
using FramebufferName = Object<&Functions::deleteFramebuffers>;
using ProgramName = Object<&Functions::deleteProgram>;

Buffer makeBuffer(const Functions& gl);
VertexArray makeVertexArray(const Functions& gl);

/// Replaces a buffer's content.
void upload(const Buffer& buffer, GLenum target, std::span<const std::byte> bytes, GLenum usage);

struct TextureFormat {
  GLenum internalFormat, format, type;
};
inline constexpr TextureFormat kColor8{GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE};
inline constexpr TextureFormat kSrgb8{GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
inline constexpr TextureFormat kNormal{GL_RG16, GL_RG,
                                       GL_UNSIGNED_SHORT};  ///< see storedNormal() of the formulas
inline constexpr TextureFormat kColor16{GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT};
inline constexpr TextureFormat kColor16F{GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT};
inline constexpr TextureFormat kGrey16{GL_R16, GL_RED, GL_UNSIGNED_SHORT};
inline constexpr TextureFormat kFloat1{GL_R32F, GL_RED, GL_FLOAT};
inline constexpr TextureFormat kFloat2{GL_RG32F, GL_RG, GL_FLOAT};
inline constexpr TextureFormat kDepth32F{GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT};

/// A 2D texture, clamped to its edge.
struct Texture : TextureName {
  Texture() = default;
  /// `filter` is GL_NEAREST or GL_LINEAR.
  Texture(const Functions& gl, int width, int height, const TextureFormat& format, GLint filter,
          const void* texels = nullptr);

  /// All of its texels, in its format.
  void replace(const void* texels) const;
  void set(GLenum parameter, GLint value) const;

  int width = 0, height = 0;
  TextureFormat format{};
};

/// A depth texture that is read as the part of the light that comes by: compared, and mixed of four texels.
Texture makeShadowMap(const Functions& gl, int resolution);

/// Draws into textures of one size.
struct Framebuffer : FramebufferName {
  Framebuffer() = default;
  /// `depth` may be null. Throws an io Error if the driver cannot.
  Framebuffer(const Functions& gl, const std::vector<const Texture*>& colors, const Texture* depth);

  /// What is drawn from now on goes to all of it.
  void bind() const;
  void clearColor(int target, const std::array<float, 4>& color) const;
  void clearDepth() const;  ///< to the farthest, 1

  int width = 0, height = 0;
};

/// A texture that is drawn into.
struct Canvas {
  Canvas() = default;
  Canvas(const Functions& gl, int width, int height, const TextureFormat& format, GLint filter)
      : texture(gl, width, height, format, filter), target(gl, {&texture}, nullptr) {}

  Texture texture;
  Framebuffer target;
};

/// How what is drawn meets what is there.
struct DrawState {
  GLenum depthTest = GL_NONE;  ///< GL_LESS, GL_LEQUAL, or none: depths are neither read nor written
  bool writesDepth = true;
  GLenum source = GL_ONE, destination = GL_ZERO;  ///< factors of blending
  GLenum culled = GL_NONE;                        ///< sides of triangles
};
void setState(const Functions& gl, const DrawState& state);

/// A vertex and a fragment shader, by the names that shaderSource() knows. Mistakes in their source throw an
/// InternalError with the driver's text.
class Program {
 public:
  Program(const Functions& gl, const std::string& vertex, const std::string& fragment,
          const std::string& defines = {});

  void use() const { program_.gl().useProgram(program_.name()); }

  // Uniforms of the program in use. One that the driver has optimised away is passed over.
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const Vec2f& value) const;
  void set(const char* uniform, const Vec2i& value) const;
  void set(const char* uniform, const Vec3f& value) const;
  void set(const char* uniform, const Vec4f& value) const;
  void setMatrix3(const char* uniform, const float* columns) const;
  void setMatrix4(const char* uniform, const float* columns) const;
  /// Binds a texture to a unit that each such uniform has of its own, and makes it the active one.
  void setTexture(const char* uniform, const TextureName& texture, GLenum target = GL_TEXTURE_2D) const;

 private:
  GLint location(const char* uniform) const;

  ProgramName program_;
  mutable std::map<std::string, GLint, std::less<>> locations_, units_;
};

/// A fragment shader that is run for all texels of what it draws into.
class FullScreenProgram : public Program {
 public:
  FullScreenProgram(const Functions& gl, const std::string& fragment, const std::string& defines = {});

  /// With the program in use.
  void draw(const Framebuffer& target, const DrawState& state = {}) const;

 private:
  VertexArray array_;  // without attributes
};

/// One such shader for each set of lines of #define: software drivers run both sides of a branch, so what is
/// not in a picture is left out.
class ProgramVariants {
 public:
  ProgramVariants(const Functions& gl, std::string fragment) : gl_(gl), fragment_(std::move(fragment)) {}

  const FullScreenProgram& with(const std::string& defines) {
    return known_.try_emplace(defines, gl_, fragment_, defines).first->second;
  }

 private:
  const Functions& gl_;
  std::string fragment_;
  std::map<std::string, FullScreenProgram> known_;
};

}  // namespace weir::rendering::gl
