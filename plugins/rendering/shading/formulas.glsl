// The formulas of pictures, each once: shaders include this file by its name, kernels for the CPU and for CUDA by
// formulas.h. So it is written in what GLSL and C++ have in common, and in the words that formulas.h and
// words.glsl give a meaning. A `real` is what differs from sample to sample: a float in shaders and on CUDA, eight
// floats side by side on the CPU. real2 and real3 are vectors of them.

// What surfaces are made of, in the alpha channel of their colour.
CONSTANT float kMatt = 0.2f, kParticle = 0.4f, kWhite = 0.6f, kMetal = 0.8f, kGround = 1.0f;

// ---- The camera. `projection` are P00, P11, P22 and P23 of its matrix.

// Between depths, from 0 to 1, and distances along the camera's axis.
FORMULA real depthOf(real distance, vec4 projection) {
  return 0.5f + 0.5f * (projection.w / distance - projection.z);
}
FORMULA real distanceOf(real depth, vec4 projection) {
  return projection.w / (2.0f * depth - 1.0f + projection.z);
}

// The ray through a place of the window, of length 1 along the camera's axis. `pixel` is 2 / size of the window.
FORMULA real3 rayThrough(real x, real y, vec2 pixel, vec2 tangent) {
  return triple((x * pixel.x - 1.0f) * tangent.x, (y * pixel.y - 1.0f) * tangent.y, real(-1.0f));
}

// The texel of a map of `size` that holds the middle of texel `place` of a map of size `own`. By integers, because
// middles of texels often lie on edges of the other map's, where rounding would choose one. Products stay below
// 2^31 for sizes up to 32768.
PLAIN int texelUnder(int place, int own, int size) { return (2 * place + 1) * size / (2 * own); }

// ---- Spheres

// Where a ray meets a sphere: the distance along the camera's axis. `rest` is by how much the square of the radius
// exceeds that of the ray's distance from the centre: negative for a miss. From the point of the ray that is nearest
// to the centre, which is exact also for small spheres far away.
FORMULA real distanceOfSphere(real3 ray, real3 center, real radius, OUT(real) rest) {
  real scale = 1.0f / dot(ray, ray);
  real middle = dot(ray, center) * scale;
  real3 aside = ray * middle - center;
  rest = radius * radius - dot(aside, aside);
  return middle - sqrtf(positivePart(rest) * scale);
}

// Where the two lines through the eye touch a sphere's circle in the plane of an axis and the viewing axis (M. Mara,
// M. McGuire 2013): the exact bounds of the sphere's picture along that axis, at a distance of 1.
FORMULA real2 touchingLines(real across, real along, real radius) {
  real touch = sqrtf(across * across + along * along - radius * radius);
  return couple((across * touch - along * radius) / (along * touch + across * radius),
                (across * touch + along * radius) / (along * touch - across * radius));
}

// The depth of a sphere's side towards the sun. `rest` is 1 less the square of the distance from its middle in radii;
// middle and radius are in clip space.
FORMULA real depthFromSun(real rest, real middle, real radius) {
  return 0.5f + 0.5f * (middle - radius * sqrtf(rest));
}

// The way through a sphere that a particle's volume is spread over. `chord` is that through its middle, and `spread`
// the part of what is drawn that the sphere itself would cover, along each axis.
FORMULA real wayThrough(real rest, real chord, real spread) { return chord * spread * spread * sqrtf(rest); }

// The part of foam that is seen at a distance, behind the front of a liquid.
FORMULA real foamSeen(real distance, real front, real depthOfFoam) {
  return clamped(1.0f - (distance - front) / depthOfFoam, 0.0f, 1.0f);
}

// ---- Normals in two numbers from 0 to 1: places on the octahedron |x| + |y| + |z| = 1, whose far half is folded
// outwards (Q. Meyer et al. 2010). With 16 bits each they are exact to 3e-5, in the memory of three times 10 bits.

FORMULA real folded(real across, real beyond) {
  return (1.0f - absolute(across)) * select(beyond < 0.0f, real(-1.0f), real(1.0f));
}
FORMULA real2 storedNormal(real3 n) {
  real scale = 1.0f / (absolute(n.x) + absolute(n.y) + absolute(n.z));
  real x = n.x * scale, y = n.y * scale;
  return couple(0.5f + 0.5f * select(n.z < 0.0f, folded(y, x), x),
                0.5f + 0.5f * select(n.z < 0.0f, folded(x, y), y));
}

// ---- Light

// From all sides: bright above, the ground's colour below.
FORMULA real3 skyLightOf(real3 normal, real3 up, real3 below, real3 above) {
  real height = 0.5f + 0.5f * dot(normal, up);
  return mix(below, above, height * (2.0f - height));
}

// C. Schlick's approximation (1994) of the reflected part.
FORMULA real fresnel(real cosine, float straight) {
  real slant = 1.0f - clamped(cosine, 0.0f, 1.0f);
  real square = slant * slant;
  return straight + (1.0f - straight) * square * square * slant;
}

// The light that meets a surface. Occlusion takes a little from the sun's light, too.
FORMULA real3 diffuseLight(real3 sky, real open, real3 sunColor, real sun, real facing) {
  return sky * open + sunColor * (sun * facing * (1.0f + (open - 1.0f) * 0.35f));
}

// The light out of white water: drops and bubbles that are too small to be seen one by one, and lie in crowds in which
// light goes from one to the next until it leaves on all sides alike. So each gets from below, from its neighbours, what
// the sky gives from above; of the sun's light it shows half, which is what white paper shows on the mean of all
// directions in which it is lit.
FORMULA real3 frothLight(real3 skyFromAbove, real3 sunColor, real sun) {
  return skyFromAbove + sunColor * (0.5f * sun);
}

// What particles reflect besides: the sun, as a normalised Blinn-Phong highlight (J. Blinn 1977) with F. Giesen's factor
// (n + 8) / 8 and an exponent of 40, and the sky at their rims. `cosine` is that between the normal and what is half
// way from the eye to the sun, `facing` that between the normal and the eye.
FORMULA real3 withShine(real3 light, real3 color, real3 skyColor, real open, real3 sunColor, real sun, real cosine,
                        real facing) {
  real c2 = cosine * cosine;
  real c4 = c2 * c2;
  real c8 = c4 * c4;
  real c16 = c8 * c8;
  real highlight = 6.0f * c16 * c16 * c8;
  return light + sunColor * (0.025f * sun * highlight) +
         times(skyColor, color) * (0.25f * fresnel(facing, 0.04f) * open);
}

// How much of the background shows at a distance from the middle of the ground.
FORMULA real fadeOfGround(real distance, float radius) { return smoothstep(0.12f, 0.9f, distance / radius); }

// From the lower edge of the picture, 0, to the upper one, 1.
FORMULA real3 backgroundOf(real height, real3 bottom, real3 top) {
  return mix(bottom, top, height * height * (3.0f - 2.0f * height));
}

// ---- Shadows

// A place of a pattern, turned by an angle of this cosine and sine.
FORMULA real2 turned(vec2 place, real cosine, real sine) {
  return couple(place.x * cosine - place.y * sine, place.x * sine + place.y * cosine);
}

// By how many texels of the shadow map points are moved off their surface, lest it shades itself.
CONSTANT float kShadowOffset = 2.0f;

// ---- Ambient occlusion

// How far it looks around in the picture. `inView` is 1 m at a distance of 1 m.
FORMULA real reachOfOcclusion(real distance, float radius, float inView, float largest) {
  return atMost(radius * inView / distance, real(largest));
}

// What is seen at one place hides of the sky, by where that lies from the point.
FORMULA real occlusionBy(real3 towards, real3 normal, float radius) {
  real way = dot(towards, towards);
  real within = positivePart(radius * radius - way);
  real over = positivePart(dot(towards, normal) - 0.02f * radius);
  return within * within * within * over / (way + 1e-3f * (radius * radius));
}

// The open part of the sky, by the sum of occlusionBy() over places.
FORMULA real openSky(real sum, int places, float radius) {
  float square = radius * radius;
  return positivePart(1.0f - sum * (5.0f / (square * square * radius * float(places))));
}

// What a neighbour counts that is `step` pixels away and `behind` farther from the camera. Five of which the outer two
// count half: as wide as the pattern, and in the middle.
FORMULA real weightOfOpenSky(real behind, int step, float radius) {
  real away = behind * (2.0f / radius);
  return (step == -2 || step == 2 ? 0.5f : 1.0f) * positivePart(1.0f - away * away);
}

// ---- From light to colours

CONSTANT float kKnee = 0.8f;

// Leaves light below the knee alone, and bends what is above it towards 1.
FORMULA real shoulder(real light) {
  real over = clamped((light - kKnee) * (1.0f / (1.0f - kKnee)), 0.0f, 80.0f);
  return select(light > kKnee, 1.0f - (1.0f - kKnee) * exponential(-over), light);
}

// As sRGB.
FORMULA real encoded(real light) {
  real bent = 1.055f * power(atLeast(light, real(0.0031308f)), 1.0f / 2.4f) - 0.055f;
  return select(light < 0.0031308f, 12.92f * light, bent);
}
