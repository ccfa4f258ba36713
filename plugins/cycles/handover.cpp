#include "plugins/cycles/handover.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/scene/scene_file.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr const char* kFormat = "weir-view";
constexpr int kVersion = 1;
constexpr const char* kEnvironmentFile = "environment.npz";

Value listOf(std::initializer_list<float> numbers) {
  Value list = Value::array();
  for (const float number : numbers) list.push(number);
  return list;
}
Value listOf(const Vec3f& v) {
  return listOf({v.x, v.y, v.z});
}
Value listOf(const Color& c) {
  return listOf({c.r, c.g, c.b});
}
Value listOf(const Quatf& q) {
  return listOf({q.w, q.x, q.y, q.z});
}

/// What it is called in scene files.
template <class E>
std::string nameOfEnum(E value) {
  return std::string(EnumNames<E>::kNames.at(static_cast<std::size_t>(value)).first);
}

Value cameraOf(const CameraPose& camera) {
  Value item = Value::object();
  item["eye"] = listOf(camera.eye);
  item["target"] = listOf(camera.target);
  item["up"] = listOf(camera.up);
  item["fov"] = camera.fovDegrees;
  return item;
}

Value pictureOf(const View& view) {
  Value item = Value::object();
  item["width"] = view.width;
  item["height"] = view.height;
  item["transparent"] = view.transparent;
  item["tone"] = nameOfEnum(view.lighting.tone);
  item["exposure"] = view.lighting.exposure;
  return item;
}

Value groundOf(const GroundView& ground) {
  if (!ground.visible) return {};
  Value item = Value::object();
  item["height"] = ground.height;
  item["center"] = listOf(ground.center);
  item["radius"] = ground.radius;
  item["color"] = listOf(ground.color);
  item["tiles"] = ground.tiles;
  return item;
}

Value waterOf(const WaterView& water) {
  Value item = Value::object();
  item["absorption"] = listOf(water.absorption);
  item["scattering"] = water.scattering;
  item["scattered"] = listOf(water.scattered);
  item["refractive_index"] = water.refractiveIndex;
  return item;
}

Value cyclesOf(const CyclesSettings& settings) {
  Value item = Value::object();
  item["samples"] = settings.samples.get();
  item["noise"] = settings.noise.get();
  item["denoise"] = settings.denoise.get();
  item["device"] = nameOfEnum(settings.device.get());
  item["caustics"] = settings.caustics.get();
  item["shutter"] = settings.shutter.get();
  item["aperture"] = settings.aperture.get();
  item["focus"] = settings.focus.get() ? Value(*settings.focus.get()) : Value();
  return item;
}

void makeFolder(const fs::path& folder) {
  std::error_code error;
  const auto refuse = [&](const std::string& reason) {
    return ioError("the folder cannot be used for Blender: " + reason).at({.file = folder.string()});
  };
  if (!fs::is_directory(folder, error)) {
    if (fs::exists(folder, error)) throw refuse("it is not a folder");
    fs::create_directory(folder, error);
    if (error) throw refuse(error.message());
  }
  // Fails here rather than after hours of simulation.
  checkWritable(folder / "probe.npz");
}

}  // namespace

Handover::Handover(fs::path folder, const CyclesSettings& settings, double frameRate)
    : folder_(std::move(folder)), settings_(settings), frameRate_(frameRate) {
  makeFolder(folder_);
}

MeshId Handover::addMesh(const TriangleMesh& mesh) {
  const auto id = static_cast<MeshId>(meshes_.size());
  Mesh& added = meshes_.emplace_back();
  if (mesh.triangles.empty()) return id;
  added.file = fmt::format("mesh_{:05}.npz", id);
  NpzFile arrays;
  arrays.add("vertices", std::span<const Vec3f>(mesh.vertices));
  arrays.add("triangles", std::span<const Vec3i>(mesh.triangles));
  writeFileAtomically(folder_ / added.file, std::move(arrays).finish());
  return id;
}

void Handover::replaceMesh(MeshId id, const ShownMesh& mesh) {
  meshes_.at(id) = {.file = "", .span = mesh};
}

fs::path Handover::write(const View& view) {
  NpzFile arrays;
  Value scene = sceneOf(view);
  scene["particles"] = Value::array();
  for (std::size_t i = 0; i < view.particles.size(); ++i)
    scene["particles"].push(particlesOf(view.particles[i], i, arrays));
  scene["surfaces"] = Value::array();
  for (std::size_t i = 0; i < view.surfaces.size(); ++i)
    scene["surfaces"].push(surfaceOf(view.surfaces[i], i, arrays));
  arrays.add("scene", writeJson(scene));
  fs::path file = folder_ / fmt::format("frame_{:05}.npz", view.frame);
  writeFileAtomically(file, std::move(arrays).finish());
  return file;
}

Value Handover::sceneOf(const View& view) {
  Value scene = Value::object();
  scene["format"] = kFormat;
  scene["version"] = kVersion;
  scene["frame"] = view.frame;
  scene["time"] = view.time;
  scene["frame_rate"] = frameRate_;
  scene["picture"] = pictureOf(view);
  scene["camera"] = cameraOf(view.camera);
  scene["cycles"] = cyclesOf(settings_);
  scene["environment"] = environmentOf(view);
  scene["ground"] = groundOf(view.ground);
  scene["waters"] = Value::array();
  for (const WaterView& water : view.waters) scene["waters"].push(waterOf(water));
  return scene;
}

Value Handover::environmentOf(const View& view) {
  Value item = Value::object();
  item["look"] = nameOfEnum(view.environment);
  item["towards_sun"] = listOf(normalized(view.lighting.towardsSun));
  item["sun_strength"] = view.lighting.sunStrength;
  item["background"] = view.environmentBehind;
  item["top"] = listOf(view.backgroundTop);
  item["bottom"] = listOf(view.backgroundBottom);
  item["image"] = Value();
  if (!view.environmentImage) return item;
  item["image"] = kEnvironmentFile;
  if (image_ == view.environmentImage) return item;
  image_ = view.environmentImage;
  NpzFile arrays;
  arrays.add("light", std::span<const Vec3f>(image_->light), image_->height, image_->width);
  writeFileAtomically(folder_ / kEnvironmentFile, std::move(arrays).finish());
  return item;
}

Value Handover::particlesOf(const ParticleView& particles, std::size_t index, NpzFile& arrays) const {
  WEIR_CHECK(!particles.onDevice);
  constexpr int kColors = 64;
  Value item = Value::object();
  item["name"] = particles.node + " particles";
  item["radius"] = particles.radius;
  item["color"] = listOf(particles.fixed);
  const std::string name = fmt::format("particles{}_", index);
  arrays.add(name + "positions", particles.positions);
  if (!particles.velocities.empty()) arrays.add(name + "velocities", particles.velocities);
  item["white"] = particles.white;
  if (!particles.radii.empty()) arrays.add(name + "radii", particles.radii);
  if (particles.values.empty()) return item;
  arrays.add(name + "values", particles.values);
  item["range"] = listOf({particles.lowest, particles.highest});
  item["colors"] = Value::array();
  for (int i = 0; i < kColors; ++i)
    item["colors"].push(listOf(particles.map.at(static_cast<float>(i) / (kColors - 1))));
  return item;
}

Value Handover::surfaceOf(const SurfaceView& surface, std::size_t index, NpzFile& arrays) const {
  const Mesh& mesh = meshes_.at(surface.mesh);
  Value item = Value::object();
  item["name"] = surface.node;
  item["look"] = nameOfEnum(surface.look);
  item["color"] = listOf(surface.color);
  item["water"] = static_cast<std::int64_t>(surface.water);
  item["position"] = listOf(surface.position);
  item["rotation"] = listOf(surface.rotation);
  if (surface.before) {
    item["position_before"] = listOf(surface.before->position);
    item["rotation_before"] = listOf(surface.before->rotation);
  }
  item["mesh"] = mesh.file.empty() ? Value() : Value(mesh.file);
  if (!mesh.file.empty()) return item;
  const std::string name = fmt::format("surface{}_", index);
  arrays.add(name + "vertices", mesh.span.vertices);
  arrays.add(name + "triangles", mesh.span.triangles);
  if (!surface.velocities.empty()) arrays.add(name + "velocities", surface.velocities);
  if (!surface.foam.empty()) {
    arrays.add(name + "foam", surface.foam);
    item["foam_reach"] = surface.foamReach;
  }
  if (!mesh.span.colors.empty()) arrays.add(name + "colors", mesh.span.colors);
  return item;
}

}  // namespace weir::rendering
