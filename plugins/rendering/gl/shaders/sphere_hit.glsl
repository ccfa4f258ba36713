#include "camera.glsl"

uniform float uRadius, uNear;
flat in vec3 vCenter;

// Where the ray of a sample meets the sphere, along the camera's axis; leaves samples that miss it.
float distanceOfHit(vec3 ray) {
  float rest;
  float distance = distanceOfSphere(ray, vCenter, uRadius, rest);
  if (rest < 0.0 || distance < uNear) discard;
  return distance;
}
