// Vertex 4i + k is corner k of particle i; the indices make two triangles of the four corners.
uniform samplerBuffer uCenters;
vec4 particle() { return texelFetch(uCenters, gl_VertexID >> 2); }
vec2 corner() { return vec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1); }
