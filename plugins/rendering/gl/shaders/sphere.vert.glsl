// The rectangle around a sphere's picture.
#include "words.glsl"
#include "formulas.glsl"
#include "corner.glsl"

uniform mat4 uView;
uniform vec2 uTangent;
uniform float uRadius, uNear;
uniform sampler2D uColors;
flat out vec3 vCenter;  // in camera space
flat out vec4 vColor;

void main() {
  vec4 data = particle();
  vCenter = (uView * vec4(data.xyz, 1.0)).xyz;
  vColor = textureLod(uColors, vec2(data.w, 0.5), 0.0);
  float along = -vCenter.z;
  if (along + uRadius < uNear) {  // behind the camera
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec2 low = vec2(-1.0), high = vec2(1.0);
  if (along - uRadius > uNear) {  // otherwise it may fill the picture
    vec2 x = touchingLines(vCenter.x, along, uRadius) / uTangent.x;
    vec2 y = touchingLines(vCenter.y, along, uRadius) / uTangent.y;
    low = vec2(x.x, y.x);
    high = vec2(x.y, y.y);
  }
  gl_Position = vec4(mix(low, high, corner()), 0.0, 1.0);
}
