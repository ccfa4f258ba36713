#include "plugins/rendering/gl/renderer.h"

#include <algorithm>
#include <cmath>

#include "plugins/rendering/gl/camera_math.h"
#include "plugins/rendering/gl/shaders.h"

namespace weir::rendering {

namespace {

void append(std::vector<float>& data, const Vec3f& v) {
  for (int k = 0; k < 3; ++k) data.push_back(v[k]);
}

constexpr int kSamples = 2;  // along each side of a pixel
constexpr int kShadowSize = 2048;
constexpr float kMattKind = 1.0f, kMetalKind = 0.5f, kGroundKind = 0.25f;
constexpr Vec3f kSunDirection{0.45f, 1.0f, 0.35f};
constexpr Vec3f kGroundColor{0.71f, 0.72f, 0.74f};
constexpr float kGlassOpacity = 0.03f;

bool isTransparent(const Surface& surface) {
  return surface.look == SurfaceLook::kGlass || surface.color.a < 1;
}

float opacityOf(const Surface& surface) {
  return surface.color.a < 1 ? surface.color.a : kGlassOpacity;
}

Vec3f rgb(const Color& c) {
  return {c.r, c.g, c.b};
}

Vec3f rotated(const Eigen::Matrix4f& m, const Vec3f& v) {
  const Eigen::Vector3f r = m.block<3, 3>(0, 0) * toEigen(v);
  return {r.x(), r.y(), r.z()};
}

Vec3f moved(const Eigen::Matrix4f& m, const Vec3f& v) {
  const Eigen::Vector3f r = m.block<3, 3>(0, 0) * toEigen(v) + m.block<3, 1>(0, 3);
  return {r.x(), r.y(), r.z()};
}

}  // namespace

struct Renderer::Shaders {
  explicit Shaders(const Functions& gl)
      : sphere(gl, "sphere", shaders::kSphereVertex, shaders::kSphereFragment),
        sphereShadow(gl, "sphere shadow", shaders::kSphereVertex, shaders::kSphereShadowFragment),
        mesh(gl, "mesh", shaders::kMeshVertex, shaders::kMeshFragment),
        meshShadow(gl, "mesh shadow", shaders::kMeshVertex, shaders::kShadowMeshFragment),
        occlusion(gl, "occlusion", shaders::kFullScreenVertex, shaders::kOcclusionFragment),
        blur(gl, "blur", shaders::kFullScreenVertex, shaders::kBlurFragment),
        shade(gl, "shade", shaders::kFullScreenVertex, shaders::kShadeFragment),
        glass(gl, "glass", shaders::kMeshVertex, shaders::kGlassFragment),
        line(gl, "line", shaders::kLineVertex, shaders::kLineFragment),
        resolve(gl, "resolve", shaders::kFullScreenVertex, shaders::kResolveFragment) {}
  Shader sphere, sphereShadow, mesh, meshShadow, occlusion, blur, shade, glass, line, resolve;
};

/// Textures to draw into, for one size of picture.
struct Renderer::Targets {
  Targets(const Functions& gl, int pictureWidth, int pictureHeight)
      : width(pictureWidth),
        height(pictureHeight),
        albedo(gl, GL_RGBA8, kSamples * width, kSamples * height),
        normal(gl, GL_RGBA16F, kSamples * width, kSamples * height),
        depth(gl, GL_DEPTH_COMPONENT32F, kSamples * width, kSamples * height),
        light(gl, GL_RGBA16F, kSamples * width, kSamples * height),
        rawOcclusion(gl, GL_R8, width, height),
        occlusion(gl, GL_R8, width, height, GL_LINEAR),
        result(gl, GL_RGBA8, width, height),
        shadow(gl, GL_DEPTH_COMPONENT32F, kShadowSize, kShadowSize),
        toGeometry(gl, {&albedo, &normal}, &depth),
        toRawOcclusion(gl, {&rawOcclusion}, nullptr),
        toOcclusion(gl, {&occlusion}, nullptr),
        toLight(gl, {&light}, nullptr),
        toGlass(gl, {&light}, &depth),
        toResult(gl, {&result}, nullptr),
        toShadow(gl, {}, &shadow) {}
  int width, height;
  Texture albedo, normal, depth, light, rawOcclusion, occlusion, result, shadow;
  Framebuffer toGeometry, toRawOcclusion, toOcclusion, toLight, toGlass, toResult, toShadow;
};

/// Matrices and lengths of one view.
struct Renderer::Frame {
  explicit Frame(const View& v) {
    center = v.bounds.center();
    radius = std::max(0.5f * length(v.bounds.size()), 1e-4f);
    groundReach = 9 * radius;
    const float distance = length(v.camera.eye - center);
    const float near = std::max(1e-3f * radius, 0.2f * (distance - 3 * radius));
    const float far = distance + 2 * groundReach;
    view = lookAt(v.camera.eye, v.camera.target, v.camera.up);
    projection = perspective(v.camera.fov, float(v.width) / float(v.height), near, far);
    const Vec3f sun = normalized(kSunDirection);
    // A little larger than the scene, for the shadow that it throws beside itself.
    constexpr float kMargin = 1.1f;
    const float reach = kMargin * radius;
    lightView = lookAt(center + 3 * reach * sun, center, {0, 0, 1});
    lightProjection = orthographic(reach, 6 * reach);
    toLight = lightProjection * lightView * view.inverse();
    sunInView = rotated(view, sun);
    upInView = rotated(view, {0, 1, 0});
    focusInView = moved(view, center);
    // Effects of contact are as large as a few particles, or else a share of the scene.
    constexpr float kOcclusionShare = 0.05f, kOcclusionParticles = 5;
    float particle = 0;
    for (const Spheres& s : v.spheres) particle = std::max(particle, s.radius);
    occlusionReach =
        particle > 0 ? std::max(kOcclusionParticles * particle, 0.02f * radius) : kOcclusionShare * radius;
    shadowBias = 4 * reach / kShadowSize;
  }
  Vec3f center, sunInView, upInView, focusInView;
  float radius, groundReach, occlusionReach, shadowBias;
  Eigen::Matrix4f view, projection, lightView, lightProjection, toLight;
};

Renderer::Renderer(std::unique_ptr<Context> context)
    : context_(std::move(context)),
      gl_(*context_),
      shaders_(std::make_unique<Shaders>(gl_)),
      screen_(gl_),
      ground_(gl_),
      lines_(gl_),
      colors_(gl_, GL_RGB8, 1, 1, GL_LINEAR) {
  screen_.upload(std::vector<float>(3), {1}, false);  // three vertices, of which the number alone is used
}

Renderer::~Renderer() {
  try {
    context_->makeCurrent();
  } catch (const Error&) {
    // Then its objects are gone already.
  }
}

Picture Renderer::draw(const View& view) {
  context_->makeCurrent();
  if (!targets_ || targets_->width != view.width || targets_->height != view.height) {
    targets_.reset();
    targets_ = std::make_unique<Targets>(gl_, view.width, view.height);
  }
  const Frame frame(view);
  prepare(view);
  drawShadows(view, frame);
  drawGeometry(view, frame);
  drawOcclusion(frame);
  shade(view, frame);
  drawLines(view, frame);
  drawGlass(view, frame);
  return resolve();
}

void Renderer::prepare(const View& view) {
  spheres_.clear();
  for (const Spheres& s : view.spheres) {
    std::vector<float> data;
    data.reserve(4 * s.positions.size());
    for (std::size_t i = 0; i < s.positions.size(); ++i)
      append(data, s.positions[i]), data.push_back(s.shade[i]);
    spheres_.emplace_back(gl_).upload(data, {3, 1}, true);
  }
  std::vector<float> lines;
  for (const Line& l : view.lines) append(lines, l.from), append(lines, l.to);
  lines_.upload(lines, {3, 3}, true);
  if (!view.colors.empty()) colors_.upload(static_cast<int>(view.colors.size() / 3), 1, view.colors);

  const Frame frame(view);
  std::vector<float> ground;
  if (view.ground) {
    const float r = frame.groundReach, y = view.groundHeight;
    const auto corner = [&](float x, float z) {
      append(ground, {frame.center.x + x * r, y, frame.center.z + z * r}), append(ground, {0, 1, 0});
    };
    corner(-1, -1), corner(-1, 1), corner(1, 1), corner(-1, -1), corner(1, 1), corner(1, -1);
  }
  ground_.upload(ground, {3, 3}, false);
  // Those that are shown no more would pile up where surfaces change from frame to frame.
  std::erase_if(meshes_, [&](const auto& entry) {
    return std::none_of(view.surfaces.begin(), view.surfaces.end(),
                        [&](const Surface& s) { return s.mesh == entry.first; });
  });
}

const VertexArray& Renderer::verticesOf(const std::shared_ptr<const TriangleMesh>& mesh) {
  const auto found = meshes_.find(mesh);
  if (found != meshes_.end()) return found->second;
  VertexArray& vertices = meshes_.emplace(mesh, VertexArray(gl_)).first->second;
  vertices.upload(meshVertices(*mesh), {3, 3}, false);
  return vertices;
}

void Renderer::drawShadows(const View& view, const Frame& frame) {
  targets_->toShadow.bind();
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_CULL_FACE);
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  for (const Shader* shader : {&shaders_->sphereShadow, &shaders_->meshShadow}) {
    shader->use();
    shader->set("viewMatrix", frame.lightView);
    shader->set("projection", frame.lightProjection);
  }
  for (const Surface& surface : view.surfaces)
    if (!isTransparent(surface)) verticesOf(surface.mesh).drawTriangles();
  shaders_->sphereShadow.use();
  shaders_->sphereShadow.set("orthographic", 1);
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    shaders_->sphereShadow.set("radius", view.spheres[i].radius);
    spheres_[i].drawQuads();
  }
}

void Renderer::drawGeometry(const View& view, const Frame& frame) {
  targets_->toGeometry.bind();
  gl_.ClearColor(0, 0, 0, 0);
  gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Shader& sphere = shaders_->sphere;
  sphere.use();
  sphere.set("viewMatrix", frame.view);
  sphere.set("projection", frame.projection);
  sphere.set("orthographic", 0);
  sphere.setTexture("colors", 0, colors_.id());
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    sphere.set("radius", view.spheres[i].radius);
    spheres_[i].drawQuads();
  }
  const Shader& mesh = shaders_->mesh;
  mesh.use();
  mesh.set("viewMatrix", frame.view);
  mesh.set("projection", frame.projection);
  for (const Surface& surface : view.surfaces) {
    if (isTransparent(surface)) continue;
    mesh.set("color", rgb(surface.color));
    mesh.set("kind", surface.look == SurfaceLook::kMetal ? kMetalKind : kMattKind);
    verticesOf(surface.mesh).drawTriangles();
  }
  mesh.set("color", kGroundColor);
  mesh.set("kind", kGroundKind);
  ground_.drawTriangles();
  gl_.Disable(GL_DEPTH_TEST);
}

void Renderer::drawFullScreen() {
  screen_.drawTriangles();
}

void Renderer::drawOcclusion(const Frame& frame) {
  targets_->toRawOcclusion.bind();
  const Shader& occlusion = shaders_->occlusion;
  occlusion.use();
  occlusion.setTexture("depth", 0, targets_->depth.id());
  occlusion.setTexture("normals", 1, targets_->normal.id());
  occlusion.set("projection", frame.projection);
  occlusion.set("reach", frame.occlusionReach);
  drawFullScreen();
  targets_->toOcclusion.bind();
  const Shader& blur = shaders_->blur;
  blur.use();
  blur.setTexture("occlusion", 0, targets_->rawOcclusion.id());
  blur.setTexture("depth", 1, targets_->depth.id());
  blur.set("projection", frame.projection);
  blur.set("pixel", 1.0f / float(targets_->width), 1.0f / float(targets_->height));
  blur.set("reach", frame.occlusionReach);
  drawFullScreen();
}

void Renderer::setLighting(const Shader& shader, const View& view, const Frame& frame) const {
  shader.set("backgroundTop", rgb(view.backgroundTop));
  shader.set("backgroundBottom", rgb(view.backgroundBottom));
  shader.set("sunDirection", frame.sunInView);
  shader.set("upDirection", frame.upInView);
}

void Renderer::shade(const View& view, const Frame& frame) {
  targets_->toLight.bind();
  const Shader& shader = shaders_->shade;
  shader.use();
  setLighting(shader, view, frame);
  shader.setTexture("albedos", 0, targets_->albedo.id());
  shader.setTexture("normals", 1, targets_->normal.id());
  shader.setTexture("depth", 2, targets_->depth.id());
  shader.setTexture("occlusion", 3, targets_->occlusion.id());
  shader.setTexture("shadow", 4, targets_->shadow.id());
  shader.set("projection", frame.projection);
  shader.set("toLight", frame.toLight);
  shader.set("texel", 1.0f / float(kShadowSize));
  shader.set("bias", frame.shadowBias);
  shader.set("groundReach", frame.groundReach);
  shader.set("focus", frame.focusInView);
  drawFullScreen();
}

void Renderer::drawGlass(const View& view, const Frame& frame) {
  std::vector<const Surface*> transparent;
  for (const Surface& surface : view.surfaces)
    if (isTransparent(surface)) transparent.push_back(&surface);
  const auto distance = [&](const Surface* s) {
    return length(s->mesh->bounds().center() - view.camera.eye);
  };
  std::sort(transparent.begin(), transparent.end(),
            [&](const Surface* a, const Surface* b) { return distance(a) > distance(b); });

  targets_->toGlass.bind();
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_FALSE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.Enable(GL_CULL_FACE);
  const Shader& glass = shaders_->glass;
  glass.use();
  setLighting(glass, view, frame);
  glass.set("viewMatrix", frame.view);
  glass.set("projection", frame.projection);
  for (const Surface* surface : transparent) {
    glass.set("color", rgb(surface->color));
    glass.set("opacity", opacityOf(*surface));
    for (const GLenum hidden : {GL_FRONT, GL_BACK}) {  // far sides first
      gl_.CullFace(hidden);
      verticesOf(surface->mesh).drawTriangles();
    }
  }
  gl_.Disable(GL_CULL_FACE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
}

void Renderer::drawLines(const View& view, const Frame& frame) {
  if (view.lines.empty()) return;
  targets_->toGlass.bind();
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_FALSE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  const Shader& line = shaders_->line;
  line.use();
  line.set("viewMatrix", frame.view);
  line.set("projection", frame.projection);
  line.set("size", float(kSamples * view.width), float(kSamples * view.height));
  constexpr float kLinesPerHeight = 1.0f / 500;  // width of a line, in heights of the picture
  line.set("width", std::max(kSamples * 0.75f, kLinesPerHeight * float(kSamples * view.height)));
  constexpr float kAlpha = 0.4f, kInk = 0.06f;
  line.set("color", Vec4f{kInk * kAlpha, kInk * kAlpha, kInk * kAlpha, kAlpha});
  lines_.drawQuads();
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_TRUE);
}

Picture Renderer::resolve() {
  targets_->toResult.bind();
  const Shader& shader = shaders_->resolve;
  shader.use();
  shader.setTexture("light", 0, targets_->light.id());
  shader.set("pixel", 1.0f / float(targets_->light.width()), 1.0f / float(targets_->light.height()));
  drawFullScreen();
  const int width = targets_->width, height = targets_->height;
  std::vector<std::uint8_t> rgba(std::size_t(4) * static_cast<std::size_t>(width) *
                                 static_cast<std::size_t>(height));
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
  if (const GLenum error = gl_.GetError(); error != GL_NO_ERROR)
    throw simulationError("OpenGL failed with error " + std::to_string(error) + " while a picture was drawn");
  Picture picture{width, height, {}};
  picture.rgb.resize(picture.byteCount());
  std::uint8_t* to = picture.rgb.data();
  for (int y = height - 1; y >= 0; --y) {  // OpenGL's first row is the lowest
    const std::uint8_t* from = &rgba[4 * static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    for (int x = 0; x < width; ++x, from += 4, to += 3) std::copy(from, from + 3, to);
  }
  return picture;
}

std::vector<float> meshVertices(const TriangleMesh& mesh, float crease) {
  const float leastCosine = std::cos(crease * std::numbers::pi_v<float> / 180);
  std::vector<Vec3f> faceNormals;
  std::vector<std::vector<int>> facesAt(mesh.vertices.size());
  for (const Vec3i& t : mesh.triangles) {
    const auto corner = [&](int k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    for (int k = 0; k < 3; ++k)
      facesAt[static_cast<std::size_t>(t[k])].push_back(static_cast<int>(faceNormals.size()));
    faceNormals.push_back(cross(corner(1) - corner(0), corner(2) - corner(0)));  // as long as twice the area
  }
  std::vector<float> data;
  data.reserve(18 * mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Vec3f own = normalized(faceNormals[f]);
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(mesh.triangles[f][k]);
      Vec3f sum;
      for (const int other : facesAt[v]) {
        const Vec3f n = faceNormals[static_cast<std::size_t>(other)];
        if (dot(normalized(n), own) >= leastCosine) sum += n;
      }
      const Vec3f normal = length(sum) > 0 ? normalized(sum) : own;
      append(data, mesh.vertices[v]), append(data, normal);
    }
  }
  return data;
}

}  // namespace weir::rendering
