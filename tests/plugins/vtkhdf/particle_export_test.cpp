// --export within a simulation: what the fluids hold at each frame is what the file holds.
#include "plugins/vtkhdf/particle_export.h"

#include <sys/mount.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "framework/graph/registry.h"
#include "framework/particles/pack_layout.h"
#include "framework/run/run.h"
#include "framework/scene/scene_file.h"
#include "nodes/register_nodes.h"
#include "plugins/vtkhdf/vtkhdf_particle_reader.h"
#include "tests/plugins/vtkhdf/sample_run.h"
#include "tests/support/child_process.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

/// What a fluid holds at a frame, fetched without the export.
struct FluidState {
  std::vector<Vec3f> positions, velocities;
  std::vector<float> densities;
  std::vector<std::int64_t> ids;
};

FluidState stateOf(Simulation& simulation, const char* fluid) {
  ParticleSet& set = static_cast<ParticleFluid&>(*simulation.scene().graph.find(fluid)).fluid->set();
  const std::int64_t n = set.refreshCount();
  return {set.positions().toHost(n), set.velocities().toHost(n), set.get<float>("density").toHost(n),
          set.ids().toHost(n)};
}

/// Calls something at each frame.
class AtFrames final : public Observer {
 public:
  explicit AtFrames(std::function<void(Simulation&)> action) : action_(std::move(action)) {}
  std::string name() const override { return "at frames"; }
  void begin(Simulation&) override {}
  std::unique_ptr<weir::Snapshot> capture(Simulation& simulation, std::unique_ptr<weir::Snapshot>) override {
    action_(simulation);
    return nullptr;
  }
  void end(Simulation&, RunEnd) override {}

 private:
  std::function<void(Simulation&)> action_;
};

std::string table(const std::vector<Vec3f>& positions, Vec3f velocity) {
  std::string text = "x,y,z,vx,vy,vz\n";
  for (const Vec3f& p : positions) {
    for (const float f : {p.x, p.y, p.z, velocity.x, velocity.y}) text += std::to_string(f) + ",";
    text += std::to_string(velocity.z) + "\n";
  }
  return text;
}

class ParticleExportTest : public InFolder, public testing::WithParamInterface<std::string> {
 protected:
  ParticleExportTest() : device_(openDevice(GetParam())) {
    registerNodes(registry_);
    registry_.addService<ParticleReader>("vtkhdf", [] { return std::make_unique<VtkHdfParticleReader>(); });
    writeFileText("water.csv", table(jitteredCube(6, 0.1f, 0.1f, 1), {0.5f, 0, -1}));
    writeFileText("oil.csv", table(jitteredCube(3, 0.1f, 0.1f, 2, {2, 0, 0}), {0, 1, 0}));
  }

  void writeFileText(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
  }

  static std::string fluid(const std::string& name, const std::string& file) {
    return "\"file_" + name + "\": {\"type\": \"ParticleFile\", \"params\": {\"file\": \"" + file +
           "\"}}, \"" + name + "\": {\"type\": \"ParticleFluid\", \"params\": {\"spacing\": 0.1}}";
  }
  static std::string link(const std::string& name) {
    return "\"file_" + name + ".particles -> " + name + ".initial\"";
  }
  static std::string sceneText(const std::string& nodes, const std::string& links) {
    return R"({"weir": 1, "world": {"dt": 0.002, "frame_rate": 100, "duration": 0.03}, "nodes": {)" + nodes +
           "}, \"links\": [" + links + "]}";
  }
  std::string oneFluid(const std::string& file = "water.csv") const {
    return sceneText(fluid("water", file), link("water"));
  }
  std::string twoFluids() const {
    return sceneText(fluid("water", "water.csv") + ", " + fluid("oil", "oil.csv"),
                     link("water") + ", " + link("oil"));
  }

  std::unique_ptr<Simulation> simulation(const std::string& text) {
    const std::string name = (folder / "scene.json").string();
    std::vector<std::string> warnings;
    auto scene = buildScene(parseJson(text, name), {name, "", folder.string()}, registry_, {}, warnings);
    scene->text = text;
    return std::make_unique<Simulation>(std::move(scene), *device_, log_, registry_);
  }

  const std::filesystem::path file_ = folder / "run.vtkhdf";
  std::unique_ptr<Device> device_;
  std::string messages_;
  Log log_{[this](LogLevel, std::string_view text) { messages_ += std::string(text) + "\n"; }};
  Registry registry_;
};

void expectEqual(const VtkHdfStep& step, const FluidState& wanted) {
  EXPECT_TRUE(step.positions == wanted.positions);
  EXPECT_TRUE(step.velocities() == wanted.velocities);
  EXPECT_TRUE(valuesOf<float>(step, "density") == wanted.densities);
  EXPECT_EQ(valuesOf<std::int64_t>(step, "id"), wanted.ids);
}

TEST_P(ParticleExportTest, HoldsEveryFrameAndCanBeReadByParticleFile) {
  const std::string text = oneFluid();
  const auto first = simulation(text);
  ParticleExport exporter(file_);
  std::vector<FluidState> frames;
  AtFrames record([&](Simulation& s) { frames.push_back(stateOf(s, "water")); });
  Observer* observers[] = {&exporter, &record};
  runSimulation(*first, observers);

  const VtkHdfReader reader(file_);
  ASSERT_EQ(reader.times().size(), 4u);
  ASSERT_EQ(frames.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_DOUBLE_EQ(reader.times()[k], 0.01 * double(k));
    EXPECT_EQ(frames[k].positions.size(), 216u);
    expectEqual(reader.read(k), frames[k]);
  }
  EXPECT_NE(frames[3].positions, frames[0].positions) << "nothing moved";
  EXPECT_GT(*std::min_element(frames[3].densities.begin(), frames[3].densities.end()), 0);
  EXPECT_EQ(reader.readLast().find(kFluidIndexName), nullptr);
  EXPECT_EQ(reader.text("scene"), text);
  EXPECT_EQ(reader.text("fluids"), "water\n");
  EXPECT_EQ(parseJson(reader.text("statistics"), "").find("end")->asString(), "finished");

  const auto second = simulation(oneFluid("run.vtkhdf"));
  second->reset();
  const FluidState again = stateOf(*second, "water");
  ASSERT_EQ(again.ids.size(), 216u);
  for (std::size_t k = 0; k < again.ids.size(); ++k) {
    const auto row = static_cast<std::size_t>(again.ids[k]);
    EXPECT_EQ(again.positions[k], frames[3].positions.at(row));
    EXPECT_EQ(again.velocities[k], frames[3].velocities.at(row));
  }
}

TEST_P(ParticleExportTest, TellsSeveralFluidsApart) {
  const auto sim = simulation(twoFluids());
  ParticleExport exporter(file_);
  FluidState water, oil;
  AtFrames record([&](Simulation& s) { water = stateOf(s, "water"), oil = stateOf(s, "oil"); });
  Observer* observers[] = {&exporter, &record};
  runSimulation(*sim, observers);

  const VtkHdfReader reader(file_);
  const VtkHdfStep step = reader.readLast();
  EXPECT_EQ(step.positions.size(), 216u + 27u);
  const auto& indices = valuesOf<std::int64_t>(step, "fluid_index");
  const std::string names = reader.text("fluids");
  const bool waterFirst = names == "water\noil\n";
  EXPECT_TRUE(waterFirst || names == "oil\nwater\n") << names;
  const auto pick = [&](std::int64_t fluid) {
    FluidState picked;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      if (indices[i] != fluid) continue;
      picked.positions.push_back(step.positions[i]);
      picked.velocities.push_back(step.velocities()[i]);
      picked.densities.push_back(valuesOf<float>(step, "density")[i]);
      picked.ids.push_back(valuesOf<std::int64_t>(step, "id")[i]);
    }
    return picked;
  };
  for (const bool isWater : {true, false}) {
    const FluidState found = pick(isWater == waterFirst ? 0 : 1), &wanted = isWater ? water : oil;
    EXPECT_TRUE(found.positions == wanted.positions);
    EXPECT_TRUE(found.velocities == wanted.velocities);
    EXPECT_TRUE(found.densities == wanted.densities);
    EXPECT_EQ(found.ids, wanted.ids);
  }
}

ParticleSet& particlesOf(Simulation& simulation, const char* fluid) {
  return static_cast<ParticleFluid&>(*simulation.scene().graph.find(fluid)).fluid->set();
}

TEST_P(ParticleExportTest, WritesAttributesThatOthersAddAndIdsOf64Bits) {
  static constexpr std::int64_t kLarge = (std::int64_t{1} << 40) + 1;
  const auto sim = simulation(oneFluid());
  ParticleExport exporter(file_);
  AtFrames add([](Simulation& s) {
    ParticleSet& set = particlesOf(s, "water");
    if (s.frame() == 0) {
      const auto n = static_cast<std::size_t>(set.bound());
      set.add<int>({"phase", AttributeType::kInt, "", ""}).assign(std::vector<int>(n, -7));
      set.ids().assign(std::vector<std::int64_t>(n, kLarge));
      set.add<Vec3f>({"spin", AttributeType::kVec3, "1/s", ""}).assign(std::vector<Vec3f>(n, {1, 2, 3}));
    }
    if (s.frame() == 1) set.add<float>({"late", AttributeType::kFloat, "", ""});
  });
  Observer* observers[] = {&add, &exporter};
  runSimulation(*sim, observers);
  const VtkHdfStep step = VtkHdfReader(file_).readLast();
  EXPECT_EQ(valuesOf<std::int64_t>(step, "phase"), std::vector<std::int64_t>(216, -7));
  EXPECT_EQ(valuesOf<std::int64_t>(step, "id"), std::vector<std::int64_t>(216, kLarge));
  EXPECT_EQ(step.find("spin")->components, 3);
  EXPECT_EQ(valuesOf<float>(step, "spin")[3 * 215 + 1], 2);
  EXPECT_EQ(step.find("late"), nullptr);
  EXPECT_CONTAINS(messages_, "leaves out the attribute 'late' of the fluid 'water'");
}

TEST_P(ParticleExportTest, LeavesOutTheHalo) {
  const auto sim = simulation(oneFluid());
  ParticleExport exporter(file_);
  FluidState last;
  AtFrames showSome([&](Simulation& s) {
    last = stateOf(s, "water");
    ParticleSet& set = particlesOf(s, "water");
    const PackLayout layout(set);
    const Array<int> some(*device_, std::vector<int>{5, 2, 7});
    Array<std::byte> bytes(*device_);
    set.pack(layout, some.view(), bytes);
    set.appendHalo(layout, std::as_const(bytes).view());
    EXPECT_EQ(set.countWithHalo().get(), set.bound() + some.size());
  });
  Observer* observers[] = {&showSome, &exporter};
  runSimulation(*sim, observers);
  expectEqual(VtkHdfReader(file_).readLast(), last);
}

TEST_P(ParticleExportTest, SaysWhereAFluidHasNoSuchAttribute) {
  const auto sim = simulation(twoFluids());
  ParticleExport exporter(file_);
  AtFrames add([](Simulation& s) {
    particlesOf(s, "oil").add<float>({"smell", AttributeType::kFloat, "", ""});
    particlesOf(s, "oil").add<Vec3f>({"spin", AttributeType::kVec3, "1/s", ""});
    particlesOf(s, "water").add<int>({"phase", AttributeType::kInt, "", ""});
    particlesOf(s, "oil").add<int>({"mixed", AttributeType::kInt, "", ""});
    particlesOf(s, "water").add<float>({"mixed", AttributeType::kFloat, "", ""});
    particlesOf(s, "oil").add<float>({"age", AttributeType::kFloat, "s", ""});
    particlesOf(s, "water").add<float>({"age", AttributeType::kFloat, "s", ""});
  });
  Observer* observers[] = {&add, &exporter};
  runSimulation(*sim, observers);
  const VtkHdfStep step = VtkHdfReader(file_).readLast();
  EXPECT_EQ(valuesOf<float>(step, "age"), std::vector<float>(216 + 27, 0));
  const auto fluid = valuesOf<std::int64_t>(step, "fluid_index"),
             phase = valuesOf<std::int64_t>(step, "phase");
  const auto smell = valuesOf<float>(step, "smell"), spin = valuesOf<float>(step, "spin");
  ASSERT_EQ(spin.size(), 3 * fluid.size());
  EXPECT_EQ(std::count(fluid.begin(), fluid.end(), 1), 27);
  for (std::size_t i = 0; i < fluid.size(); ++i) {
    const bool oil = fluid[i] == 1;
    EXPECT_EQ(phase[i], oil ? -1 : 0);
    EXPECT_EQ(std::isnan(smell[i]), !oil);
    EXPECT_EQ(std::isnan(spin[3 * i + 2]), !oil);
  }
  EXPECT_EQ(step.find("mixed"), nullptr);
  EXPECT_CONTAINS(messages_, "leaves out the attribute 'mixed' of the fluid 'oil', which is of another type");
}

TEST_P(ParticleExportTest, RefusesASceneWithoutAFluid) {
  const auto sim =
      simulation(sceneText(R"("a": {"type": "ParticleFile", "params": {"file": "water.csv"}})", ""));
  ParticleExport exporter(file_);
  const Error error = errorOf([&] { exporter.begin(*sim); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(error.message(), "the scene has no particles");
  EXPECT_EQ(error.location().file, file_.string());
}

TEST_P(ParticleExportTest, RefusesAPlaceWhereNothingCanBeWritten) {
  const auto sim = simulation(oneFluid());
  ParticleExport exporter(folder / "missing" / "run.vtkhdf");
  const Error error = errorOf([&] { exporter.begin(*sim); });
  EXPECT_EQ(error.kind(), ErrorKind::kIo);
  EXPECT_EQ(error.location().file, (folder / "missing" / "run.vtkhdf").string());
}

TEST_P(ParticleExportTest, KeepsItsFramesWhenTheRunFails) {
  const auto sim = simulation(oneFluid());
  ParticleExport exporter(file_);
  AtFrames fail([](Simulation& s) {
    if (s.frame() == 2) throw simulationError("boom");
  });
  Observer* observers[] = {&exporter, &fail};
  EXPECT_EQ(errorOf([&] { runSimulation(*sim, observers); }).message(), "boom");
  EXPECT_EQ(VtkHdfReader(file_).times().size(), 3u);
}

INSTANTIATE_TEST_SUITE_P(Devices, ParticleExportTest, testing::ValuesIn(availableDevices()),
                         [](const auto& tested) { return tested.param; });

TEST(VtkHdfPlugin, ExportsFromTheCommandLine) {
  const TemporaryFolder folder;
  folder.write("p.csv", "x,y,z\n0,0,0\n0.1,0,0\n");
  const std::string scene = folder.write("scene.json", R"({
      "weir": 1, "world": {"duration": 0.1, "frame_rate": 20},
      "nodes": {"file": {"type": "ParticleFile", "params": {"file": "p.csv"}},
                "water": {"type": "ParticleFluid", "params": {"spacing": 0.1}}},
      "links": ["file.particles -> water.initial"]})");
  ChildOptions options;
  options.folder = folder.path();
  const ChildResult result = runWeir({"run", scene, "--export", "run.vtkhdf"}, options);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(result.out, "run.vtkhdf\n");
  EXPECT_EQ(VtkHdfReader(folder / "run.vtkhdf").times().size(), 3u);
  EXPECT_CONTAINS(runWeir({"info"}).out, "HDF5: 1.");
  EXPECT_EQ(runWeir({"run", scene, "--export", "run.vtk"}).code, 2);
}

TEST(VtkHdfPlugin, AFullDiskEndsTheProgramWithAMessage) {
  const TemporaryFolder folder;
  folder.write("p.csv", table(jitteredCube(24, 0.1f, 0.1f, 1), {}));
  const std::string scene = folder.write("scene.json", R"({
      "weir": 1, "world": {"duration": 0.2, "frame_rate": 100},
      "nodes": {"file": {"type": "ParticleFile", "params": {"file": "p.csv"}},
                "water": {"type": "ParticleFluid", "params": {"spacing": 0.1}}},
      "links": ["file.particles -> water.initial"]})");
  const std::string file = folder / "run.vtkhdf";
  ChildOptions options;
  // The limit keeps HDF5 from closing the file even after it was given up, so some of its memory is never
  // freed.
  options.environment["ASAN_OPTIONS"] = "detect_leaks=0";
  // Files cannot grow beyond 3000 blocks of 512 bytes.
  const std::string limited = "trap '' XFSZ; ulimit -f 3000; exec \"$0\" run \"$1\" --export \"$2\"";
  const ChildResult result = runChild("/bin/sh", {"-c", limited, weirProgram(), scene, file}, options);
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_EQ(result.signal, 0);
  EXPECT_CONTAINS(result.err, file);
  EXPECT_CONTAINS(result.err, "File too large");
  const VtkHdfReader reader(file);
  ASSERT_GE(reader.times().size(), 1u);
  EXPECT_LT(reader.times().size(), 21u);
  EXPECT_EQ(reader.readLast().positions.size(), 24u * 24 * 24);
}

// At which dataset the disk is full decides what HDF5 is left with when the program ends.
TEST(VtkHdfPlugin, ADiskThatIsFullBeforeTheFirstFrameGetsOneMessage) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("scene.json", R"({
      "weir": 1, "world": {"duration": 0.1},
      "nodes": {"jet": {"type": "SquareEmitter",
                        "params": {"position": [0, 1, 0], "width": 0.5, "height": 0.5, "speed": 1}},
                "water": {"type": "ParticleFluid", "params": {"spacing": 0.1}}},
      "links": ["jet.particles -> water.emitters"]})");
  const std::string disk = folder / "disk", file = disk + "/run.vtkhdf";
  std::filesystem::create_directory(disk);
  ChildOptions options;
  options.environment["ASAN_OPTIONS"] = "detect_leaks=0";  // as above
  // Of the smallest nothing is free: the file cannot even begin.
  for (const char* size : {"size=4k", "size=24k", "size=40k", "size=64k"}) {
    if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, size) != 0)
      GTEST_SKIP() << "this user cannot mount a small disk";
    std::ofstream(disk + "/other") << std::string(4096, ' ');
    const ChildResult result = runChild(weirProgram(), {"run", scene, "--quiet", "--export", file}, options);
    ::umount(disk.c_str());
    EXPECT_EQ(result.code, 5) << size << "\n" << result.err;
    EXPECT_CONTAINS(result.err, "No space left");
    EXPECT_EQ(result.err.find("HDF5:"), std::string::npos) << size << "\n" << result.err;
  }
}

}  // namespace
}  // namespace weir::test
