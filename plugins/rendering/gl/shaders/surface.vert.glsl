// Triangles with normals, opaque or of glass.
#include "grid.glsl"

layout(location = 0) in vec3 iPosition;
layout(location = 1) in vec3 iNormal;
layout(location = 2) in vec3 iColor;
uniform mat4 uToView;
uniform mat3 uNormalToView;
uniform mat4 uToClip;
out vec3 vNormal;
out vec3 vPosition;
out vec3 vColor;

void main() {
  vec4 position = uToView * vec4(iPosition, 1.0);
  vPosition = position.xyz;
  vNormal = uNormalToView * iNormal;
  vColor = iColor;
  gl_Position = onGrid(uToClip * position);
}
