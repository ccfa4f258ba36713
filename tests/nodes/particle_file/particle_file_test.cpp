// The node: which reader it takes, where it puts the particles, and what a fluid gets from it.
#include "nodes/particle_file/particle_file.h"

#include <gtest/gtest.h>

#include "framework/graph/registry.h"
#include "nodes/particle_fluid/particle_fluid.h"
#include "tests/support/child_process.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

/// What a plugin would bring.
class OneParticleReader final : public ParticleReader {
 public:
  std::vector<std::string> extensions() const override { return {".one", ".uno"}; }
  ParticleData read(const std::filesystem::path&) const override {
    return {.positions = {{1, 2, 3}}, .velocities = {{0, 0, 4}}, .unused = {"mood"}};
  }
};

/// A file whose particles go into a fluid of which no module does anything.
class ParticleFileTest : public OnDevice {
 protected:
  ParticleFileTest() {
    registry_.addService<ParticleReader>("one", [] { return std::make_unique<OneParticleReader>(); });
  }

  void build(const std::string& file, Value parameters, const std::string& input = "initial") {
    auto& node = graph_.add(std::make_unique<ParticleFile>(), "block");
    parameters["file"] = Value(file);
    node.assignAll(parameters, {"test", "", ""});
    fluid_ = static_cast<ParticleFluid*>(&graph_.add(std::make_unique<ParticleFluid>(), "water"));
    Value modules = Value::object();
    for (const char* name : {"predict", "neighbors", "solver", "viscosity", "boundary"})
      modules[name] = object({{"enabled", false}});
    fluid_->pipeline()->assign(modules, registry_, {"test", "", ""});
    graph_.link({"block", "particles", "water", input});
  }
  void reset() { graph_.reset({*device, log_, registry_, {}, kDt, 1}); }
  void step(std::int64_t index) { graph_.step({*device, log_, {}, double(index) * kDt, kDt, index}); }
  ParticleSet& particles() { return fluid_->fluid->set(); }
  std::vector<Vec3f> positions() { return particles().positions().toHost(particles().refreshCount()); }
  std::vector<Vec3f> velocities() { return particles().velocities().toHost(particles().refreshCount()); }

  static constexpr double kDt = 1e-3;
  TemporaryFolder folder_;
  std::string messages_;
  Log log_{[this](LogLevel, std::string_view text) { messages_ += std::string(text) + "\n"; }};
  Registry registry_;
  SceneGraph graph_;
  ParticleFluid* fluid_ = nullptr;
};

TEST_P(ParticleFileTest, AFluidGetsTheRowsAsTheyAre) {
  std::string table = "x,y,z,vx,vy,vz,mass\n";
  constexpr int kRows = 100;
  for (int i = 0; i < kRows; ++i) table += std::to_string(i) + ".5,2,3,0," + std::to_string(-i) + ",1,7\n";
  build(folder_.write("Block.CSV", table), Value::object());
  reset();
  ASSERT_EQ(positions().size(), std::size_t{kRows});
  const std::vector<std::int64_t> ids = particles().ids().toHost(kRows);
  for (int k = 0; k < kRows; ++k) {  // the fluid sorts them; the id is the row
    const auto row = static_cast<float>(ids[std::size_t(k)]);
    EXPECT_EQ(positions()[std::size_t(k)], (Vec3f{row + 0.5f, 2, 3}));
    EXPECT_EQ(velocities()[std::size_t(k)], (Vec3f{0, -row, 1}));
  }
}

TEST_P(ParticleFileTest, ScalesThenTurnsThenMoves) {
  build(
      folder_.write("p.csv", "x,y,z,vx,vy,vz\n1,2,3,4,5,6\n"),
      object({{"position", Value::Array{10, 20, 30}}, {"scale", 0.5}, {"rotation", Value::Array{0, 0, 90}}}));
  reset();
  const Vec3f p = positions().at(0), v = velocities().at(0);
  EXPECT_NEAR(length(p - Vec3f{10 - 1, 20 + 0.5f, 30 + 1.5f}), 0, 1e-5);
  EXPECT_NEAR(length(v - Vec3f{-2.5f, 2, 3}), 0, 1e-6);
}

TEST_P(ParticleFileTest, TakesReadersOfPlugins) {
  build("anything.UNO", Value::object());
  reset();
  EXPECT_EQ(positions(), (std::vector<Vec3f>{{1, 2, 3}}));
  EXPECT_EQ(velocities(), (std::vector<Vec3f>{{0, 0, 4}}));
  EXPECT_CONTAINS(messages_, "node 'block': 1 particles from anything.UNO; not used: mood");
}

TEST_P(ParticleFileTest, EmittersGetTheParticlesOnce) {
  build("a.one", Value::object(), "emitters");
  reset();
  EXPECT_EQ(positions().size(), 0u);
  for (int i = 0; i < 3; ++i) {
    step(i);
    EXPECT_EQ(positions().size(), 1u);
  }
  reset();
  step(0);
  EXPECT_EQ(positions().size(), 1u);
}

TEST_P(ParticleFileTest, SaysWhatItCanRead) {
  for (const auto& [file, message] :
       {std::pair{"a.xyz", "'a.xyz' is of no known kind"}, {"a", "'a' has no ending"}}) {
    SceneGraph graph;
    std::swap(graph, graph_);
    build(file, Value::object());
    const Error error = errorOf([&] { reset(); });
    EXPECT_EQ(error.kind(), ErrorKind::kScene);
    EXPECT_EQ(error.message(), message);
    EXPECT_EQ(error.allowed(), "a file that ends in .csv, .ply, .one or .uno");
    EXPECT_EQ(error.location().node, "block");
    EXPECT_EQ(error.location().parameter, "file");
  }
}

TEST(ParticleFile, SaysThatNoFileIsGiven) {
  const Error error = errorOf([] { ParticleFile().assignAll(Value::object(), {"test", "", ""}); });
  EXPECT_EQ(error.message(), "no file is given");
  EXPECT_EQ(error.location().parameter, "file");
}

TEST_P(ParticleFileTest, RefusesWhatBecomesTooLarge) {
  build(folder_.write("p.csv", "x,y,z\n1,2,3\n1e30,0,0\n"), object({{"scale", 1e20}}));
  EXPECT_EQ(errorOf([&] { reset(); }).message(), "scaled and moved, row 1 of the file is not finite");
}

WEIR_ON_EVERY_DEVICE(ParticleFileTest);

}  // namespace
}  // namespace weir::test
