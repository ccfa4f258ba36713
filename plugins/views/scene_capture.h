// Copies what a picture needs of a simulation: once what stays as it is, and at each frame what moved.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/communication/communicator.h"
#include "framework/geometry/dynamic_mesh_copy.h"
#include "framework/geometry/shapes.h"
#include "framework/particles/particle_set.h"
#include "framework/particles/particles.h"
#include "framework/run/observer.h"
#include "framework/solids/motion_of.h"
#include "nodes/fluid_surface/fluid_mesher.h"
#include "plugins/views/frame_elements.h"
#include "plugins/views/render_settings.h"
#include "plugins/views/view.h"

namespace weir::rendering {

/// What does not change during a run.
struct StillScene {
  /// A mesh in the frame of its node; where that is at a frame, the snapshot's poses say.
  struct Surface {
    std::string node;  ///< its name (movedMeshes())
    std::string from;  ///< the node that puts the mesh out
    TriangleMesh mesh;
    SurfaceLook look = SurfaceLook::kMatt;
    Color color;
    std::optional<WaterView> water;  ///< of the look kWater
  };
  std::vector<Surface> surfaces;
  std::vector<Vec3f> lines;    ///< two points a line
  Aabb bounds;                 ///< of surfaces at time 0, lines and emitters; m
  std::optional<float> floor;  ///< height of the plane that is the ground, m
};

/// The particles of one fluid, for the device that draws. Of the attributes' types that may colour them, or
/// whiten them, one is used at most.
struct FluidSnapshot {
  /// `lent`: see FrameElements.
  explicit FluidSnapshot(Device& device, bool lent = false)
      : positions(device, lent),
        velocities(device, lent),
        byType(AttributeTypes::makeTuple<FrameElements>(device, lent)) {}

  template <class T>
  FrameElements<T>& numbers() {
    return std::get<FrameElements<T>>(byType);
  }

  std::string node;                     ///< that puts the fluid out
  float spacing = 0;                    ///< m
  const FluidSettings* look = nullptr;  ///< null: spheres
  bool white = false;  ///< white water, whose numbers are radii, with its kinds if they are known
  bool kinds = false;  ///< whether numbers<int>() are those (WhiteKind)
  /// Of the numbers that colour the particles, or are radii; none if they have one colour and radius.
  std::optional<AttributeType> colorType;
  FrameElements<Vec3f> positions;
  FrameElements<Vec3f> velocities;  ///< if there are arrows
  AttributeTypes::TupleOf<FrameElements> byType;
};

/// Whether the particles of a node are drawn as white spheres.
bool isWhite(const RenderSettings& settings, const Node& node);
inline constexpr Color kWhite{0.95f, 0.97f, 0.98f, 1};

/// The surface of a fluid, on its way to the host.
struct FluidSurfaceSnapshot {
  explicit FluidSurfaceSnapshot(Device& device) : mesh(device), fluid(device) {}

  std::string node;  ///< that puts it out, or whose particles it is made of
  DynamicMeshCopy mesh;
  /// The particles of that fluid, for who needs to know how the surface moves or which colours it has; else
  /// none.
  FluidSnapshot fluid;
  SurfaceLook look = SurfaceLook::kMatt;
  Color color;
  std::optional<WaterView> water;  ///< of the look "water"
  float foamReach = 0;             ///< m: how far foam covers it; 0: foam is particles of its own alone
};

/// One frame.
class SceneSnapshot final : public Snapshot {
 public:
  std::int64_t frame = 0;
  double time = 0;  ///< s
  std::int64_t particles = 0;
  std::string colorUnit;
  std::vector<FluidSnapshot> fluids;
  std::vector<double> plotted;  ///< the numbers that plots show
  std::vector<FluidSurfaceSnapshot> fluidSurfaces;
  std::vector<Pose> poses;        ///< of each surface of the still scene
  std::vector<Pose> posesBefore;  ///< one frame ago, or at time 0
  /// In the first snapshot of a run alone.
  std::shared_ptr<const StillScene> still;
};

/// What those who draw need beside what there is to see.
struct CaptureNeeds {
  bool velocities = false;  ///< of particles and of surfaces of fluids
  /// Fluids of the look "water" as surfaces, in place of their particles, and what of them is spray as white
  /// water.
  bool closedWater = false;
  /// Of several ranks: each captures what it owns, of nodes that are OwnedParticles, with the number of all.
  /// It is lent, as ranks look at it together before the simulation goes on.
  Communicator* ranks = nullptr;
};

class SceneCapture {
 public:
  explicit SceneCapture(const RenderSettings& settings, const CaptureNeeds& needs = {})
      : settings_(settings), needs_(needs) {}

  /// The present frame; the device still copies it when this returns. `used` may be an earlier
  /// snapshot of this scene. Throws a scene Error if the settings name what the scene does not have.
  std::unique_ptr<SceneSnapshot> at(Simulation& simulation, std::unique_ptr<SceneSnapshot> used);

 private:
  std::shared_ptr<const StillScene> collectStill(const Simulation& simulation);
  void addShape(const Shape& shape, const std::string& node, StillScene& still);
  void addSurface(const TriangleMesh& mesh, const std::string& node, const MovedMesh& moved,
                  StillScene& still);
  void captureFluids(const Simulation& simulation, SceneSnapshot& snapshot) const;
  ParticleSet& particlesOf(Output<Particles>& output) const;
  void captureSpray(const std::string& node, const Particles& fluid, FluidSnapshot& to) const;
  void captureFluidSurfaces(const Simulation& simulation, SceneSnapshot& snapshot);
  void captureClosedWater(const Simulation& simulation, SceneSnapshot& snapshot, std::size_t first);
  void captureMesh(const DynamicMesh& mesh, const Particles* fluid, FluidSurfaceSnapshot& to) const;
  void captureColors(SceneSnapshot& snapshot, const Particles* fluid, FluidSnapshot& to) const;
  const DynamicMesh& meshOf(const std::string& node, const Particles& fluid,
                            const FluidMeshSettings& settings);
  bool isClosedWater(const std::string& node) const;
  bool showsParticles(const OutputPort& fluid) const;
  /// Which of the fluids' settings are those of a node; their number if there are none.
  std::size_t placeOfFluid(const std::string& node) const;
  const SurfaceSettings* settingsOf(const std::string& node) const;
  void checkNames(const Simulation& simulation) const;
  static void checkFollowed(const Simulation& simulation, const std::string& followed,
                            const std::string& pointer);
  static void checkName(const Simulation& simulation, const std::string& name, const std::string& pointer);

  /// Makes the surface of a fluid that nobody has made: of a replay, or of one that is to be closed.
  struct OwnSurface {
    FluidMesher mesher;
    DynamicMesh mesh;
  };

  const RenderSettings& settings_;
  CaptureNeeds needs_;
  std::map<std::string, OwnSurface> ownSurfaces_;  // by node
  bool collected_ = false;
  std::vector<const RigidMotion*> motions_;  // of each surface, null for those at rest
};

}  // namespace weir::rendering
