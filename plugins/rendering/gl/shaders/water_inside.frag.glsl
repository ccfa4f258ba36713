uniform float uDepthRange;  // m; 0 for a camera
in vec3 vNormal;
in vec3 vPosition;
layout(location = 0) out vec2 oThickness;

void main() {
  float along = uDepthRange > 0.0 ? uDepthRange * gl_FragCoord.z : length(vPosition);
  oThickness = vec2(gl_FrontFacing ? -along : along, 0.0);
}
