// The functions of OpenGL 3.3 that the renderer calls, loaded from a context. Loader libraries assume a
// window system or abort where there is none, so this small table takes their place.
#pragma once

#include <GL/glcorearb.h>

#include "plugins/rendering/gl/context.h"

namespace weir::rendering {

// A macro, because each line declares a member and names the function to load. (type part, function name)
#define WEIR_GL_FUNCTIONS(X)                                                                                 \
  X(ACTIVETEXTURE, ActiveTexture)                                                                            \
  X(ATTACHSHADER, AttachShader) X(BINDBUFFER, BindBuffer) X(BINDFRAMEBUFFER, BindFramebuffer)                \
      X(BINDTEXTURE, BindTexture) X(BINDVERTEXARRAY, BindVertexArray) X(BLENDFUNC, BlendFunc)                \
          X(BUFFERDATA, BufferData) X(CHECKFRAMEBUFFERSTATUS, CheckFramebufferStatus) X(CLEAR, Clear)        \
              X(CLEARCOLOR, ClearColor) X(COMPILESHADER, CompileShader) X(CREATEPROGRAM, CreateProgram) X(   \
                  CREATESHADER, CreateShader) X(CULLFACE, CullFace) X(DELETEBUFFERS, DeleteBuffers)          \
                  X(DELETEFRAMEBUFFERS, DeleteFramebuffers) X(DELETEPROGRAM, DeleteProgram) X(               \
                      DELETESHADER, DeleteShader) X(DELETETEXTURES, DeleteTextures)                          \
                      X(DELETEVERTEXARRAYS, DeleteVertexArrays) X(DEPTHMASK, DepthMask) X(DISABLE, Disable)  \
                          X(DRAWARRAYS, DrawArrays) X(DRAWARRAYSINSTANCED, DrawArraysInstanced) X(           \
                              DRAWBUFFERS, DrawBuffers) X(ENABLE, Enable) X(ENABLEVERTEXATTRIBARRAY,         \
                                                                            EnableVertexAttribArray)         \
                              X(FRAMEBUFFERTEXTURE2D, FramebufferTexture2D) X(GENBUFFERS, GenBuffers) X(     \
                                  GENFRAMEBUFFERS, GenFramebuffers) X(GENTEXTURES, GenTextures)              \
                                  X(GENVERTEXARRAYS, GenVertexArrays) X(GETERROR, GetError) X(               \
                                      GETINTEGERV, GetIntegerv) X(GETPROGRAMINFOLOG, GetProgramInfoLog)      \
                                      X(GETPROGRAMIV, GetProgramiv) X(GETSHADERINFOLOG, GetShaderInfoLog) X( \
                                          GETSHADERIV, GetShaderiv) X(GETSTRING, GetString)                  \
                                          X(GETUNIFORMLOCATION, GetUniformLocation) X(                       \
                                              LINKPROGRAM, LinkProgram) X(PIXELSTOREI, PixelStorei)          \
                                              X(READBUFFER, ReadBuffer) X(READPIXELS, ReadPixels)            \
                                                  X(SHADERSOURCE, ShaderSource) X(TEXIMAGE2D, TexImage2D) X( \
                                                      TEXPARAMETERI, TexParameteri) X(UNIFORM1F, Uniform1f)  \
                                                      X(UNIFORM1I, Uniform1i) X(UNIFORM2F, Uniform2f) X(     \
                                                          UNIFORM3F, Uniform3f) X(UNIFORM4F, Uniform4f)      \
                                                          X(UNIFORMMATRIX4FV, UniformMatrix4fv) X(           \
                                                              USEPROGRAM, UseProgram)                        \
                                                              X(VERTEXATTRIBDIVISOR, VertexAttribDivisor) X( \
                                                                  VERTEXATTRIBPOINTER, VertexAttribPointer)  \
                                                                  X(VIEWPORT, Viewport)

struct Functions {
#define WEIR_GL_DECLARE(type, name) PFNGL##type##PROC name = nullptr;
  WEIR_GL_FUNCTIONS(WEIR_GL_DECLARE)
#undef WEIR_GL_DECLARE

  /// Throws an io Error if a function is missing.
  explicit Functions(const Context& context);
};

}  // namespace weir::rendering
