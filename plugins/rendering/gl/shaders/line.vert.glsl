layout(location = 0) in vec4 iCorner;
void main() { gl_Position = iCorner; }
