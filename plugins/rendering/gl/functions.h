// The functions of OpenGL 3.3 core that the renderer calls, found at run time through a context.
#pragma once

#include <GL/glcorearb.h>

#include <functional>

namespace weir::rendering::gl {

using GenericFunction = void (*)();

/// Finds functions by name; throws an io Error for one that the driver lacks.
class FunctionFinder {
 public:
  /// Converts to whatever function type it is assigned to.
  struct Found {
    GenericFunction address;
    template <class F>
    operator F*() const {
      return reinterpret_cast<F*>(address);
    }
  };
  using Lookup = std::function<GenericFunction(const char* name)>;

  explicit FunctionFinder(Lookup lookup) : lookup_(std::move(lookup)) {}
  Found operator()(const char* name) const;

 private:
  Lookup lookup_;
};

/// Every entry is callable while the context that it was found through, or one like it, is current.
struct Functions {
  explicit Functions(FunctionFinder finder) : find(std::move(finder)) {}

  FunctionFinder find;  // first: the members below are initialised with it

  // State and queries
  PFNGLGETSTRINGPROC getString = find("glGetString");
  PFNGLGETINTEGERVPROC getIntegerv = find("glGetIntegerv");
  PFNGLGETERRORPROC getError = find("glGetError");
  PFNGLENABLEPROC enable = find("glEnable");
  PFNGLDISABLEPROC disable = find("glDisable");
  PFNGLVIEWPORTPROC viewport = find("glViewport");
  PFNGLDEPTHFUNCPROC depthFunc = find("glDepthFunc");
  PFNGLDEPTHMASKPROC depthMask = find("glDepthMask");
  PFNGLCULLFACEPROC cullFace = find("glCullFace");
  PFNGLBLENDFUNCPROC blendFunc = find("glBlendFunc");
  PFNGLPOLYGONOFFSETPROC polygonOffset = find("glPolygonOffset");
  PFNGLPIXELSTOREIPROC pixelStorei = find("glPixelStorei");

  // Framebuffers
  PFNGLGENFRAMEBUFFERSPROC genFramebuffers = find("glGenFramebuffers");
  PFNGLDELETEFRAMEBUFFERSPROC deleteFramebuffers = find("glDeleteFramebuffers");
  PFNGLBINDFRAMEBUFFERPROC bindFramebuffer = find("glBindFramebuffer");
  PFNGLFRAMEBUFFERTEXTURE2DPROC framebufferTexture2D = find("glFramebufferTexture2D");
  PFNGLCHECKFRAMEBUFFERSTATUSPROC checkFramebufferStatus = find("glCheckFramebufferStatus");
  PFNGLDRAWBUFFERSPROC drawBuffers = find("glDrawBuffers");
  PFNGLREADBUFFERPROC readBuffer = find("glReadBuffer");
  PFNGLREADPIXELSPROC readPixels = find("glReadPixels");
  PFNGLCLEARBUFFERFVPROC clearBufferfv = find("glClearBufferfv");

  // Textures
  PFNGLGENTEXTURESPROC genTextures = find("glGenTextures");
  PFNGLDELETETEXTURESPROC deleteTextures = find("glDeleteTextures");
  PFNGLACTIVETEXTUREPROC activeTexture = find("glActiveTexture");
  PFNGLBINDTEXTUREPROC bindTexture = find("glBindTexture");
  PFNGLTEXIMAGE2DPROC texImage2D = find("glTexImage2D");
  PFNGLTEXSUBIMAGE2DPROC texSubImage2D = find("glTexSubImage2D");
  PFNGLTEXPARAMETERIPROC texParameteri = find("glTexParameteri");
  PFNGLTEXBUFFERPROC texBuffer = find("glTexBuffer");

  // Buffers and vertex arrays
  PFNGLGENBUFFERSPROC genBuffers = find("glGenBuffers");
  PFNGLDELETEBUFFERSPROC deleteBuffers = find("glDeleteBuffers");
  PFNGLBINDBUFFERPROC bindBuffer = find("glBindBuffer");
  PFNGLBUFFERDATAPROC bufferData = find("glBufferData");
  PFNGLGENVERTEXARRAYSPROC genVertexArrays = find("glGenVertexArrays");
  PFNGLDELETEVERTEXARRAYSPROC deleteVertexArrays = find("glDeleteVertexArrays");
  PFNGLBINDVERTEXARRAYPROC bindVertexArray = find("glBindVertexArray");
  PFNGLENABLEVERTEXATTRIBARRAYPROC enableVertexAttribArray = find("glEnableVertexAttribArray");
  PFNGLVERTEXATTRIBPOINTERPROC vertexAttribPointer = find("glVertexAttribPointer");
  PFNGLDRAWARRAYSPROC drawArrays = find("glDrawArrays");
  PFNGLDRAWELEMENTSPROC drawElements = find("glDrawElements");

  // Programs
  PFNGLCREATESHADERPROC createShader = find("glCreateShader");
  PFNGLDELETESHADERPROC deleteShader = find("glDeleteShader");
  PFNGLSHADERSOURCEPROC shaderSource = find("glShaderSource");
  PFNGLCOMPILESHADERPROC compileShader = find("glCompileShader");
  PFNGLGETSHADERIVPROC getShaderiv = find("glGetShaderiv");
  PFNGLGETSHADERINFOLOGPROC getShaderInfoLog = find("glGetShaderInfoLog");
  PFNGLCREATEPROGRAMPROC createProgram = find("glCreateProgram");
  PFNGLDELETEPROGRAMPROC deleteProgram = find("glDeleteProgram");
  PFNGLATTACHSHADERPROC attachShader = find("glAttachShader");
  PFNGLLINKPROGRAMPROC linkProgram = find("glLinkProgram");
  PFNGLGETPROGRAMIVPROC getProgramiv = find("glGetProgramiv");
  PFNGLGETPROGRAMINFOLOGPROC getProgramInfoLog = find("glGetProgramInfoLog");
  PFNGLUSEPROGRAMPROC useProgram = find("glUseProgram");
  PFNGLGETUNIFORMLOCATIONPROC getUniformLocation = find("glGetUniformLocation");
  PFNGLUNIFORM1IPROC uniform1i = find("glUniform1i");
  PFNGLUNIFORM1FPROC uniform1f = find("glUniform1f");
  PFNGLUNIFORM2FPROC uniform2f = find("glUniform2f");
  PFNGLUNIFORM2IPROC uniform2i = find("glUniform2i");
  PFNGLUNIFORM3FPROC uniform3f = find("glUniform3f");
  PFNGLUNIFORM4FPROC uniform4f = find("glUniform4f");
  PFNGLUNIFORMMATRIX3FVPROC uniformMatrix3fv = find("glUniformMatrix3fv");
  PFNGLUNIFORMMATRIX4FVPROC uniformMatrix4fv = find("glUniformMatrix4fv");
};

}  // namespace weir::rendering::gl
