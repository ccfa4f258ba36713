// A run that is resumed goes on, bit by bit, as one that was not: with each node and module type that is
// registered, those of the examples and of the template for plugins included. A new type is tested by itself,
// or the test says that it needs parameters here.
#include <gtest/gtest.h>

#include <map>

#include "framework/geometry/dynamic_mesh.h"
#include "framework/graph/plugin.h"
#include "framework/run/resume_check.h"
#include "framework/scene/scene_file.h"
#include "nodes/body_contacts/body_contacts.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "nodes/register_nodes.h"
#include "nodes/semi_analytical_sfi/semi_analytical_sfi.h"
#include "nodes/static_boundary/boundary.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"
#include "tests/support/meshes.h"

namespace weir::test {
namespace {

using Differences = std::vector<std::string>;

/// Water in a room with a stirrer. The node that is tested, "it", is added and linked.
constexpr const char* kScene = R"({"weir": 1,
  "world": {"dt": 0.01, "frame_rate": 50, "duration": 0.16, "seed": 3, "cfl": 0.5},
  "nodes": {
    "block": {"type": "BoxSampler", "params": {"min": [0.12, 0, 0], "max": [0.3, 0.12, 0.3], "jitter": 0.1}},
    "room": {"type": "BoxMesh", "params": {"min": [0, 0, 0], "max": [0.3, 0.5, 0.3]}},
    "walls": {"type": "SemiAnalyticalSFI", "params": {"fill": "container"}},
    "blade": {"type": "BoxMesh", "params": {"min": [0.16, 0.02, 0.14], "max": [0.26, 0.12, 0.16]}},
    "stirrer": {"type": "SemiAnalyticalSFI", "params": {"angular_velocity": [0, 6, 0], "pivot": [0.21, 0, 0.15]}},
    "board": {"type": "BoxMesh", "params": {"min": [0.01, 0.02, 0.02], "max": [0.1, 0.2, 0.28]}},
    "water": {"type": "ParticleFluid", "params": {"spacing": 0.03, "rest_steps": 3}}},
  "links": ["block.particles -> water.initial", "room.surface -> walls.solids", "water.fluid -> walls.fluid",
            "blade.surface -> stirrer.solids", "water.fluid -> stirrer.fluid"]})";

/// Where an output of "it" goes to, by its type. Meshes in the room are stirred.
const std::map<std::string, std::string> kReaders{{"ParticleBatch", "water.initial"},
                                                  {"TriangleMesh", "stirrer.solids"},
                                                  {"Boundary", "water.boundaries"},
                                                  {"SinkRegion", "water.sinks"}};
/// Where an input of "it" gets its values from.
const std::map<std::string, std::string> kSources{{"ParticleBatch", "block.particles"},
                                                  {"TriangleMesh", "board.surface"},
                                                  {"Particles", "water.fluid"},
                                                  {"RigidBody", "float.body"}};

/// Parameters with which a type has something to do; those that are not named do with their defaults.
const std::map<std::string, const char*> kParameters{
    {"BoxMesh", R"({"min": [0.02, 0.2, 0.02], "max": [0.05, 0.3, 0.05]})"},
    {"BoxSampler", R"({"min": [0, 0.2, 0], "max": [0.1, 0.3, 0.1]})"},
    {"CircleEmitter", R"({"position": [0.1, 0.3, 0.15], "radius": 0.06, "jitter": 0.2,
                          "speed": {"keyframes": [[0, 0.5], [0.16, 2.5]]}})"},
    {"Gauge", R"({"shape": "plane", "position": [0.15, 0.03, 0.15], "normal": [1, 0, 0]})"},
    {"MeshEmitter", R"({"max_particles": 900, "jitter": 0.1})"},
    {"MeshFile", R"({"file": "mesh.tetrahedron"})"},
    {"ParticleFile", R"({"file": "particles.csv"})"},
    {"ParticleFluid", R"({"spacing": 0.03})"},
    {"RigidBody", R"({"density": 700, "position": [0.01, 0, 0], "velocity": [0.1, 0, 0], "fixed": "y",
                      "fixed_rotation": "xyz"})"},
    {"SemiAnalyticalSFI", R"({"velocity": [0.5, 0, 0]})"},
    {"Sink", R"({"min": [0.12, -1, 0], "max": [0.2, 0.05, 0.3]})"},
    {"SphereSampler", R"({"center": [0.05, 0.3, 0.15], "radius": 0.05})"},
    {"SquareEmitter", R"({"position": [0.1, 0.3, 0.15], "speed": 2})"},
    {"StaticBoundary", R"({"shape": "box", "min": [0.2, 0, 0.2], "max": [0.25, 0.1, 0.25]})"},
    {"Terrain", R"({"size": [0.3, 0.3], "cells": 8, "position": [0.15, -0.05, 0.15], "thickness": 0.02})"},
    {"TurningModel",
     R"({"profile": [[0, 0.2], [0.03, 0.2], [0.03, 0.25], [0, 0.25]], "position": [0.05, 0, 0.05]})"},
    {"VortexTracers", R"({"spacing": 0.03, "circulation": 0.5})"},
    {"WavePaddle", R"({"stroke": 0.2, "period": 0.5, "ramp": 0, "acceleration": 30})"},
    {"WhiteWater", R"({"trapped_air": 1e8, "air_limits": [0.001, 0.01], "speed_limits": [0.1, 0.5]})"},
    {"MyPluginProbe", R"({"min": [0, 0, 0], "max": [0.15, 0.05, 0.3]})"},
    {"SemiImplicitSolver", R"({"step_length": "global", "record_objective": true})"},
    {"AcceleratedSolver", R"({"tolerance": 0.01, "max_iterations": 3, "acceleration": "conjugate",
                              "record_objective": true})"},
    {"Pbf", R"({"record_objective": true})"},
    {"MyPluginPull", R"({"center": [0.1, 0.3, 0.1]})"},
    {"Xsph", R"({"form": "implicit"})"}};

/// Types whose particles are not asked for as those of a fluid are, and the sampler that they get.
const std::map<std::string, const char*> kOwnSamplers{
    {"VortexTracers",
     R"({"type": "BoxSampler", "params": {"min": [0.1, 0.2, 0.1], "max": [0.2, 0.3, 0.2]}})"}};

/// What types need beside the scene: a body that floats.
constexpr const char* kBody = R"({
  "nodes": {"float": {"type": "RigidBody", "params": {"density": 500, "position": [0, 0.1, 0], "fixed_rotation": "xyz"}}},
  "links": ["board.surface -> float.mesh", "water.fluid -> float.fluid"]})";
constexpr const char* kHeldBody = R"({
  "nodes": {"float": {"type": "RigidBody", "params": {"density": 500, "position": [0, 0.1, 0], "fixed_rotation": "xyz"}},
            "contacts": {"type": "BodyContacts"}},
  "links": ["board.surface -> float.mesh", "water.fluid -> float.fluid", "float.body -> contacts.bodies",
            "it.joint -> contacts.joints"]})";
const std::map<std::string, const char*> kMoreNodes{{"BodyContacts", kBody}, {"Joint", kHeldBody}};

/// Modules that take the place of another one; all others stand before "predict".
const std::map<std::string, std::string> kInPlaceOf{{"Pbf", "solver"},
                                                    {"TwoProjections", "solver"},
                                                    {"Dfsph", "solver"},
                                                    {"AcceleratedSolver", "solver"},
                                                    {"SemiImplicitSolver", "solver"}};

/// Reads a mesh without looking into the file.
class Tetrahedra final : public MeshReader {
 public:
  std::vector<std::string> extensions() const override { return {".tetrahedron"}; }
  TriangleMesh read(const std::filesystem::path&) const override {
    TriangleMesh mesh;
    mesh.vertices = {{0.02f, 0.2f, 0.02f}, {0.06f, 0.2f, 0.02f}, {0.02f, 0.26f, 0.02f}, {0.02f, 0.2f, 0.06f}};
    mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    return mesh;
  }
};

/// Holds bodies back, whatever they touch.
class Brake final : public BodyDynamics {
 public:
  Overlap set(std::vector<HeldBody>, std::vector<HeldSolid>, std::vector<HeldJoint>) override { return {}; }
  void step(std::vector<Motion>& motions, const std::vector<SolidMotion>&, const std::vector<JointDrive>&,
            double dt, double, std::vector<KnownContact>&, CpuThreads&) override {
    for (Motion& motion : motions) {
      const Vec3d lost = 0.5 * (motion.after.velocity - motion.before.velocity);
      motion.held = true;
      motion.after.velocity += -1.0 * lost;
      motion.after.center += -dt * lost;
    }
  }
};

/// What a node puts out, where states do not hold it already. Returns false for a type that is not known
/// here.
bool putOutput(const OutputPort& port, const StateWriter& to) {
  if (const auto* batch = dynamic_cast<const Output<ParticleBatch>*>(&port)) {
    to.put("count", (*batch)->count);
    if ((*batch)->count > 0) to.put("positions", (*batch)->positions, (*batch)->count);
    if ((*batch)->count > 0 && !(*batch)->velocities.empty())
      to.put("velocities", (*batch)->velocities, (*batch)->count);
    return true;
  }
  if (const auto* mesh = dynamic_cast<const Output<DynamicMesh>*>(&port)) {
    to.put("vertices", (*mesh)->vertices, (*mesh)->vertices.size());
    to.put("normals", (*mesh)->normals, (*mesh)->normals.size());
    to.put("triangles", (*mesh)->triangles, (*mesh)->triangles.size());
    return true;
  }
  if (const auto* mesh = dynamic_cast<const Output<TriangleMesh>*>(&port)) {
    to.put("vertices", std::span<const Vec3f>((*mesh)->vertices));
    to.put("triangles", std::span<const Vec3i>((*mesh)->triangles));
    return true;
  }
  if (const auto* forces = dynamic_cast<const Output<SolidForces>*>(&port)) {
    for (std::size_t k = 0; k < (*forces)->solids.size(); ++k) {
      to.in(std::to_string(k)).put("force", (*forces)->solids[k].force);
      to.in(std::to_string(k)).put("torque", (*forces)->solids[k].torque);
    }
    return true;
  }
  // The particles of a fluid are states, and the others do not change.
  return dynamic_cast<const Output<Particles>*>(&port) != nullptr ||
         dynamic_cast<const Output<Boundary>*>(&port) != nullptr ||
         dynamic_cast<const Output<BodyLink>*>(&port) != nullptr ||
         dynamic_cast<const Output<JointLink>*>(&port) != nullptr ||
         dynamic_cast<const Output<SinkRegion>*>(&port) != nullptr;
}

class Resume : public testing::Test {
 protected:
  Resume() {
    registerNodes(registry);
    registry.addService<BodyDynamics>("brake", [] { return std::make_unique<Brake>(); });
    registry.addService<MeshReader>("tetrahedra", [] { return std::make_unique<Tetrahedra>(); });
    for (const char* name : {"wave_paddle", "dfsph", "vortex_force", "tracers", "my_plugin"})
      plugins_.push_back(
          std::make_unique<Plugin>(buildFolder() + "/lib/weir/test_plugins/weir_" + name + ".so", registry));
    folder_.write("mesh.tetrahedron", "");
    folder_.write("particles.csv", "x,y,z,vx,vy,vz\n0.05,0.3,0.05,0,-1,0\n0.08,0.35,0.08,0.1,0,0\n");
  }

  static Value parametersOf(const std::string& type) {
    const auto found = kParameters.find(type);
    return found == kParameters.end() ? Value::object() : parseJson(found->second, type);
  }

  static void addMore(Value& scene, const char* nodes) {
    Value more = parseJson(nodes, "more");
    for (const auto& [name, node] : more["nodes"].asObject()) scene["nodes"][name] = node;
    for (const Value& link : more["links"].asArray()) scene["links"].push(link);
  }

  /// The scene with a node of that type.
  Value sceneWith(const Node& node, const std::string& type) const {
    Value scene = parseJson(kScene, "test");
    Value& it = scene["nodes"]["it"] = Value::object();
    it["type"] = type;
    it["params"] = parametersOf(type);
    const auto link = [&](const std::string& from, const std::string& to) {
      scene["links"].push(Value(from + " -> " + to));
    };
    const auto sampler = kOwnSamplers.find(type);
    if (const auto more = kMoreNodes.find(type); more != kMoreNodes.end()) addMore(scene, more->second);
    if (sampler != kOwnSamplers.end()) scene["nodes"]["sampler"] = parseJson(sampler->second, type);
    for (const InputPort* input : node.inputs())
      // A joint's other end is the world.
      if (const auto from = kSources.find(input->typeName());
          from != kSources.end() && (type != "Joint" || input->required()))
        link(sampler != kOwnSamplers.end() ? "sampler.particles" : from->second, "it." + input->name());
    for (const OutputPort* output : node.outputs()) {
      const auto to = kReaders.find(output->typeName());
      const bool emits = output->typeName() == "ParticleBatch" && type.ends_with("Emitter");
      // Of the nodes with particles fluids alone meet solids.
      if (type == "ParticleFluid") link("it." + output->name(), "walls.fluid");
      if (to != kReaders.end()) link("it." + output->name(), emits ? "water.emitters" : to->second);
    }
    return scene;
  }

  /// The scene with a module of that type in the fluid.
  Value sceneWithModule(const std::string& type) const {
    Value scene = parseJson(kScene, "test");
    std::string name = "it";
    Value module = Value::object();
    ParticleFluid fluid;
    for (const auto& usual : fluid.pipeline()->modules())
      if (usual->info().type == type) name = usual->name();
    if (const auto place = kInPlaceOf.find(type); place != kInPlaceOf.end()) name = place->second;
    if (name == "it") module["before"] = "predict";
    if (name == "it" || kInPlaceOf.contains(type)) module["type"] = type;
    module["params"] = parametersOf(type);
    scene["nodes"]["water"]["modules"][name] = std::move(module);
    return scene;
  }

  Differences differencesOf(const Value& scene) {
    const std::string text = writeJson(scene);
    const auto make = [&] {
      std::vector<std::string> ignored;
      const Place place{"test", "", folder_.path()};
      auto built = buildScene(parseJson(text, "test"), place, registry, {}, ignored);
      return std::make_unique<Simulation>(std::move(built), *device_, log_, registry);
    };
    ResumeCheck check{.savedAt = 2, .comparedFor = 2};
    check.observe = [&](Simulation& simulation, const StateWriter& to) {
      for (const Node* node : simulation.scene().graph.order())
        for (const OutputPort* port : node->outputs())
          EXPECT_TRUE(putOutput(*port, to.in(node->name()).in(port->name())))
              << "this test does not know how to compare outputs of the type " << port->typeName();
    };
    return resumeDifferences(make, check);
  }

  Registry registry;

 private:
  TemporaryFolder folder_;
  std::vector<std::unique_ptr<Plugin>> plugins_;
  std::unique_ptr<Device> device_ = openDevice("cpu", 2);
  Log log_;
};

TEST_F(Resume, EveryNodeTypeGoesOnBitByBit) {
  std::size_t tested = 0;
  for (const auto& [type, info] : registry.nodes()) {
    SCOPED_TRACE(type);
    try {
      EXPECT_EQ(differencesOf(sceneWith(*registry.createNode(type), type)), Differences{});
      ++tested;
    } catch (const Error& error) {
      ADD_FAILURE() << "no scene of this test holds the node type " << type
                    << ", see kParameters: " << error.what();
    }
  }
  EXPECT_EQ(tested, registry.nodes().size());
  EXPECT_TRUE(registry.nodes().contains("WavePaddle"));
  EXPECT_TRUE(registry.nodes().contains("VortexTracers"));
  EXPECT_TRUE(registry.nodes().contains("MyPluginProbe"));
}

TEST_F(Resume, EveryModuleTypeGoesOnBitByBit) {
  std::size_t tested = 0;
  for (const auto& [type, info] : registry.modules()) {
    SCOPED_TRACE(type);
    ASSERT_EQ(info.info.family, FluidModule::kFamily) << "this test does not know where such a module stands";
    try {
      EXPECT_EQ(differencesOf(sceneWithModule(type)), Differences{});
      ++tested;
    } catch (const Error& error) {
      ADD_FAILURE() << "no scene of this test holds the module type " << type
                    << ", see kParameters and kInPlaceOf: " << error.what();
    }
  }
  EXPECT_EQ(tested, registry.modules().size());
  EXPECT_TRUE(registry.modules().contains("Dfsph"));
  EXPECT_TRUE(registry.modules().contains("VortexForce"));
}

/// As the wave paddle of the examples was: its position is a plain member.
class ForgetfulPaddle final : public Node, public RigidMotion {
 public:
  static constexpr NodeInfo kInfo{"ForgetfulPaddle", "Moves meshes, and forgets where they are."};
  const NodeInfo& info() const override { return kInfo; }
  Inputs<Particles> fluid{*this, "fluid", "The fluids.", true};
  Inputs<TriangleMesh> solids{*this, "solids", "The paddle.", true};

  void reset(const SetupContext& context) override {
    position_ = 0;
    parts_.clear();
    for (std::size_t k = 0; k < solids.size(); ++k)
      parts_.push_back(std::make_unique<Solid>(context.device, solids[k], SolidSurface{}, *this, 0.03f));
    couplingOf(fluid, 0).accept(parts_);
  }
  void step(const StepContext& context) override { position_ += 2 * context.dt; }
  Pose poseAt(double) const override { return {{}, {static_cast<float>(position_), 0, 0}}; }
  Vec3f pivotAt(double) const override { return {}; }

 private:
  std::vector<std::unique_ptr<Solid>> parts_;
  double position_ = 0;
};

/// Pushes the fluid harder from step to step.
class ForgetfulForce final : public FluidModule {
 public:
  static constexpr ModuleInfo kInfo{"ForgetfulForce", kFamily, "Pushes, and forgets how hard."};
  const ModuleInfo& info() const override { return kInfo; }
  void reset(FluidStep&) override { steps_ = 0; }
  void step(FluidStep& fluid) override {
    ++steps_;
    std::vector<Vec3f> velocities = fluid.particles.velocities().toHost(fluid.particles.bound());
    for (Vec3f& v : velocities) v.z += 0.001f * static_cast<float>(steps_);
    fluid.particles.velocities().assign(velocities);
  }

 private:
  int steps_ = 0;
};

/// What nobody sees but who asks for the report.
class ForgetfulCounter final : public Node {
 public:
  static constexpr NodeInfo kInfo{"ForgetfulCounter", "Counts steps, and forgets how many."};
  const NodeInfo& info() const override { return kInfo; }
  void reset(const SetupContext&) override { steps_ = 0; }
  void step(const StepContext&) override { ++steps_; }
  void report(NodeReport& report) override { report.statistics["counted"] = steps_; }

 private:
  std::int64_t steps_ = 0;
};

TEST_F(Resume, FindsANodeThatDoesNotDeclareWhatMovesTheFluid) {
  registry.addNode<ForgetfulPaddle>();
  const Differences found =
      differencesOf(sceneWith(*registry.createNode("ForgetfulPaddle"), "ForgetfulPaddle"));
  ASSERT_FALSE(found.empty());
  std::string all;
  for (const std::string& difference : found) all += difference + "\n";
  EXPECT_CONTAINS(all, "state/nodes/water/particles/position");
}

TEST_F(Resume, FindsANodeThatDoesNotDeclareWhatItReports) {
  registry.addNode<ForgetfulCounter>();
  const Differences found =
      differencesOf(sceneWith(*registry.createNode("ForgetfulCounter"), "ForgetfulCounter"));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_CONTAINS(found.front(), "frame 3: report/it/counted");
}

TEST_F(Resume, FindsAModuleThatDoesNotDeclareWhatMovesTheFluid) {
  registry.addModule<ForgetfulForce>();
  const Differences found = differencesOf(sceneWithModule("ForgetfulForce"));
  ASSERT_FALSE(found.empty());
  EXPECT_CONTAINS(found.front(), "frame 3: ");
}

}  // namespace
}  // namespace weir::test
