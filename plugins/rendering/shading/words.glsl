// What the words of formulas.glsl mean in shaders.
#define FORMULA
#define PLAIN
#define CONSTANT const
#define OUT(type) out type
#define real float
#define real2 vec2
#define real3 vec3
#define couple vec2
#define triple vec3
#define absolute abs
#define atLeast max
#define atMost min
#define clamped clamp
#define exponential exp
#define power pow
#define sqrtf sqrt
float positivePart(float x) { return max(x, 0.0); }
float select(bool condition, float a, float b) { return condition ? a : b; }
vec3 times(vec3 a, vec3 b) { return a * b; }
