#include "behind.glsl"

uniform vec4 uColor;
out vec4 oLight;
void main() {
  leaveUnlessBehind();
  oLight = vec4(uColor.rgb * uColor.a, uColor.a);
}
