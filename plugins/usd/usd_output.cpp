#include "plugins/usd/usd_output.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/compute/host_copy.h"
#include "framework/graph/outputs_of.h"
#include "plugins/usd/crate_file.h"
#include "plugins/usd/usd_stage.h"
#include "plugins/views/picture_maker.h"
#include "plugins/views/scene_capture.h"
#include "plugins/views/scene_view.h"

namespace weir::rendering {

namespace fs = std::filesystem;

namespace {

constexpr const char* kOption = "usd";

/// One attribute of particles on its way to the host.
class AttributeCopy {
 public:
  AttributeCopy(const ParticleSet& particles, const AttributeInfo& info, std::int64_t count)
      : name_(info.name), copy_(withAttributeType(info.type, [&]<class T>(std::type_identity<T>) -> Copy {
          HostCopy<T> copy(particles.device());
          copy.resize(count);
          copy.start(0, particles.get<T>(info.name).read().data(), count);
          return copy;
        })) {}

  /// Adds it to the present prim, and says what was added: `attributes` grows by what is new in it.
  void addTo(CrateFile& file, std::vector<UsdAttribute>& attributes) {
    std::visit([&]<class T>(HostCopy<T>& copy) { add(copy.wait(), file, attributes); }, copy_);
  }

 private:
  using Copy = AttributeTypes::VariantOf<HostCopy>;

  void add(std::span<const Vec3f> values, CrateFile& file, std::vector<UsdAttribute>& attributes) const {
    if (name_ == "position") {
      Aabb box;
      for (const Vec3f& p : values) box.extend(p);
      const std::array<Vec3f, 2> extent{box.lo, box.hi};
      if (!box.empty()) put({"float3[]", "extent"}, std::span<const Vec3f>(extent), file, attributes);
      return put({"point3f[]", "points"}, values, file, attributes);
    }
    if (name_ == "velocity") return put({"vector3f[]", "velocities"}, values, file, attributes);
    put({"vector3f[]", "primvars:" + name_, true}, values, file, attributes);
  }
  void add(std::span<const float> values, CrateFile& file, std::vector<UsdAttribute>& attributes) const {
    put({"float[]", "primvars:" + name_, true}, values, file, attributes);
  }
  void add(std::span<const int> values, CrateFile& file, std::vector<UsdAttribute>& attributes) const {
    put({"int[]", "primvars:" + name_, true}, values, file, attributes);
  }
  void add(std::span<const std::int64_t> values, CrateFile& file,
           std::vector<UsdAttribute>& attributes) const {
    if (name_ == "id") return put({"int64[]", "ids"}, values, file, attributes);
    put({"int64[]", "primvars:" + name_, true}, values, file, attributes);
  }
  /// USD has no arrays of such matrices of single precision.
  void add(std::span<const Mat3f>, CrateFile&, std::vector<UsdAttribute>&) const {}

  template <class T>
  static void put(const UsdAttribute& attribute, std::span<const T> values, CrateFile& file,
                  std::vector<UsdAttribute>& attributes) {
    file.add(attribute.name, attribute.type, values);
    const bool isKnown = std::any_of(attributes.begin(), attributes.end(),
                                     [&](const UsdAttribute& known) { return known.name == attribute.name; });
    if (!isKnown) attributes.push_back(attribute);
  }

  std::string name_;
  Copy copy_;
};

struct ParticleColumns {
  std::vector<AttributeCopy> attributes;  // none where there are no particles yet
  float spacing = 0;                      // m
};

class UsdSnapshot final : public Snapshot {
 public:
  std::unique_ptr<SceneSnapshot> scene;
  std::vector<ParticleColumns> particles;  // in the order of the scene's outputs
};

/// Keeps the meshes that views speak of, and draws nothing.
class MeshBook final : public PictureMaker {
 public:
  explicit MeshBook(std::unique_ptr<Device> device) : device_(std::move(device)) {}

  MeshId addMesh(const TriangleMesh& mesh) override {
    pages_.push_back(std::make_unique<Page>(Page{.still = mesh, .moving = {}}));
    return static_cast<MeshId>(pages_.size() - 1);
  }
  void replaceMesh(MeshId id, const ShownMesh& mesh) override { pages_.at(id)->moving = mesh; }
  Picture draw(const View&) override { return {}; }
  Device* device() const override { return device_.get(); }
  bool readsDevice(const View&) const override { return false; }

  /// Of one that keeps its shape; null for others. It stays where it is.
  const TriangleMesh* still(MeshId id) const {
    const Page& page = *pages_.at(id);
    return page.still.triangles.empty() ? nullptr : &page.still;
  }
  const ShownMesh& moving(MeshId id) const { return pages_.at(id)->moving; }

 private:
  struct Page {
    TriangleMesh still;
    ShownMesh moving;
  };

  std::unique_ptr<Device> device_;
  std::vector<std::unique_ptr<Page>> pages_;
};

class UsdObserver final : public Observer {
 public:
  explicit UsdObserver(fs::path file) : file_(std::move(file)) {}

  std::string name() const override { return "USD"; }
  std::string_view stateName() const override { return "usd"; }

  void begin(Simulation& simulation) override {
    const auto& settings = static_cast<const RenderSettings&>(*simulation.scene().sections.at("render"));
    checkWritable(file_);
    makeFolder();
    stage_ = {.frameRate = simulation.scene().world.frameRate,
              .aspect = double(settings.width) / double(settings.height),
              .aperture = settings.cycles->aperture,
              .focus = settings.cycles->focus.get(),
              .frames = folder().filename().string(),
              .things = {},
              .materials = {},
              .moments = {}};
    book_.emplace(siblingOf(simulation.device()));
    view_.emplace(settings, *settings.camera, *book_);
    capture_.emplace(settings, CaptureNeeds{.velocities = true, .closedWater = false});
    taken_ = {"camera", "Materials"};
    sources_.clear(), placeOf_.clear();
    for (const auto& [node, output] : outputsOf<Particles>(simulation.scene().graph)) {
      sources_.push_back({output, stage_.things.size()});
      stage_.things.push_back(
          {.prim = primNameOf(node, taken_),
           .color = isWhite(settings, output->node()) ? kWhite : settings.color->fixed.get()});
    }
  }

  void save(const StateWriter& to) override {
    writeRoot();
    std::vector<UsdCamera> cameras;
    std::vector<Placement> places;
    for (const UsdMoment& moment : stage_.moments) {
      cameras.push_back({moment.frame, moment.camera});
      places.insert(places.end(), moment.places.begin(), moment.places.end());
    }
    to.put("cameras", std::span<const UsdCamera>(cameras));
    to.put("places", std::span<const Placement>(places));
  }
  void resume(Simulation& simulation, const StateReader& from) override {
    begin(simulation);
    const auto cameras = from.getAll<UsdCamera>("cameras");
    const auto places = from.getAll<Placement>("places");
    const std::size_t each = cameras.empty() ? 0 : places.size() / cameras.size();
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const auto first = places.begin() + static_cast<std::ptrdiff_t>(i * each);
      stage_.moments.push_back({.frame = cameras[i].frame,
                                .camera = cameras[i].pose,
                                .places = {first, first + static_cast<std::ptrdiff_t>(each)}});
    }
  }

  std::unique_ptr<Snapshot> capture(Simulation& simulation, std::unique_ptr<Snapshot> used) override {
    // Attributes may come and go, so their copies are not used again.
    auto snapshot = used ? std::unique_ptr<UsdSnapshot>(static_cast<UsdSnapshot*>(used.release()))
                         : std::make_unique<UsdSnapshot>();
    snapshot->scene = capture_->at(simulation, std::move(snapshot->scene));
    snapshot->particles.clear();
    for (const Source& source : sources_) {
      ParticleColumns& columns = snapshot->particles.emplace_back();
      const Particles& output = **source.output;
      if (!output.exist()) continue;
      ParticleSet& particles = output.set();
      columns.spacing = output.material.spacing;
      const std::int64_t count = particles.refreshCount();
      for (const AttributeInfo& info : particles.attributes())
        columns.attributes.emplace_back(particles, info, count);
    }
    return snapshot;
  }

  void write(Snapshot& taken) override {
    auto& snapshot = static_cast<UsdSnapshot&>(taken);
    const View view = view_->of(*snapshot.scene, ParticlePlace::kHost);
    CrateFile file(static_cast<double>(view.frame));
    UsdMoment moment{.frame = view.frame, .camera = view.camera, .places = {}};
    file.beginPrim("World");
    for (std::size_t i = 0; i < sources_.size(); ++i)
      addParticles(snapshot.particles[i], stage_.things[sources_[i].thing], file);
    for (const SurfaceView& surface : view.surfaces) addSurface(surface, view, moment, file);
    file.endPrim();
    writeFileAtomically(folder() / usdFrameName(view.frame), std::move(file).finish());
    stage_.moments.push_back(std::move(moment));
    constexpr std::chrono::seconds kPause(5);
    if (std::chrono::steady_clock::now() - written_ > kPause) writeRoot();
  }

  void end(Simulation&, RunEnd) override {
    if (!stage_.moments.empty()) writeRoot();
  }

 private:
  struct Source {
    const Output<Particles>* output;
    std::size_t thing;
  };
  struct UsdCamera {
    std::int64_t frame;
    CameraPose pose;
  };

  fs::path folder() const { return file_.parent_path() / (file_.stem().string() + "_frames"); }

  void makeFolder() const {
    std::error_code error;
    fs::create_directory(folder(), error);
    if (error || !fs::is_directory(folder(), error))
      throw ioError("the folder cannot be used for the frames of USD: " +
                    (error ? error.message() : std::string("it is not a folder")))
          .at({.file = folder().string()});
    checkWritable(folder() / usdFrameName(0));
  }

  static void addParticles(ParticleColumns& columns, UsdThing& thing, CrateFile& file) {
    if (columns.attributes.empty()) return;
    thing.width = columns.spacing;
    file.beginPrim(thing.prim);
    for (AttributeCopy& attribute : columns.attributes) attribute.addTo(file, thing.attributes);
    file.endPrim();
  }

  void addSurface(const SurfaceView& surface, const View& view, UsdMoment& moment, CrateFile& file) {
    const TriangleMesh* still = book_->still(surface.mesh);
    UsdThing& thing = thingOf(surface, view, still);
    if (still != nullptr) {
      moment.places.push_back({surface.rotation, surface.position});
      return;
    }
    const ShownMesh& mesh = book_->moving(surface.mesh);
    const std::vector<std::int32_t> counts(mesh.triangles.size(), 3);
    const std::span<const std::int32_t> corners(reinterpret_cast<const std::int32_t*>(mesh.triangles.data()),
                                                3 * mesh.triangles.size());
    Aabb box;
    for (const Vec3f& p : mesh.vertices) box.extend(p);
    const std::array<Vec3f, 2> extent{box.lo, box.hi};
    file.beginPrim(thing.prim);
    file.add("points", "point3f[]", mesh.vertices);
    file.add("normals", "normal3f[]", mesh.normals);
    file.add("faceVertexCounts", "int[]", std::span<const std::int32_t>(counts));
    file.add("faceVertexIndices", "int[]", corners);
    if (!surface.velocities.empty()) file.add("velocities", "vector3f[]", surface.velocities);
    if (!mesh.colors.empty()) addColors(mesh.colors, thing, file);
    file.add("extent", "float3[]", std::span<const Vec3f>(extent));
    file.endPrim();
  }

  static void addColors(std::span<const Vec3f> srgb, UsdThing& thing, CrateFile& file) {
    std::vector<Vec3f> light(srgb.size());
    std::transform(srgb.begin(), srgb.end(), light.begin(), lightOf);
    file.add(kDisplayColor, "color3f[]", std::span<const Vec3f>(light));
    if (!thing.has(kDisplayColor)) thing.attributes.push_back({"color3f[]", kDisplayColor, true});
  }

  /// The thing of a surface, which is made with its material when it is first seen.
  UsdThing& thingOf(const SurfaceView& surface, const View& view, const TriangleMesh* still) {
    const auto known = placeOf_.find(surface.mesh);
    if (known != placeOf_.end()) return stage_.things[known->second];
    placeOf_[surface.mesh] = stage_.things.size();
    UsdThing& thing = stage_.things.emplace_back();
    thing.prim = thing.material = primNameOf(surface.node, taken_);
    thing.isMesh = true;
    thing.isAnimated = still == nullptr;
    thing.mesh = still;
    thing.color = surface.color;
    if (thing.isAnimated)
      thing.attributes = {{"point3f[]", "points"},       {"normal3f[]", "normals", true},
                          {"int[]", "faceVertexCounts"}, {"int[]", "faceVertexIndices"},
                          {"vector3f[]", "velocities"},  {"float3[]", "extent"}};
    UsdMaterial& material = stage_.materials[thing.material];
    material.look = surface.look;
    material.color = surface.color;
    if (surface.look == SurfaceLook::kWater) material.water = view.waters.at(surface.water);
    return thing;
  }

  void writeRoot() {
    writeFileAtomically(folder() / "manifest.usda", manifestOf(stage_));
    writeFileAtomically(file_, rootLayerOf(stage_));
    written_ = std::chrono::steady_clock::now();
  }

  fs::path file_;
  UsdStage stage_;
  std::optional<MeshBook> book_;
  std::optional<SceneView> view_;
  std::optional<SceneCapture> capture_;
  std::vector<Source> sources_;
  std::vector<std::string> taken_;         // names of prims
  std::map<MeshId, std::size_t> placeOf_;  // of the thing of each mesh
  std::chrono::steady_clock::time_point written_{};
};

}  // namespace

std::vector<OutputOption> UsdOutput::options() const {
  return {{kOption,
           "FILE.usda",
           {".usda"},
           "Write particles, surfaces, solids and the camera as USD, with a folder of frames"}};
}

std::unique_ptr<Observer> UsdOutput::create(const OutputPaths& paths) const {
  return std::make_unique<UsdObserver>(paths.at(kOption));
}

}  // namespace weir::rendering
