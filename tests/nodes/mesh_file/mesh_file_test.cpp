// What becomes of a file's mesh, with a reader that makes the mesh up.
#include "nodes/mesh_file/mesh_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "framework/graph/registry.h"
#include "framework/graph/scene_graph.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "tests/support/devices.h"
#include "tests/support/expect_error.h"
#include "tests/support/fluid_scene.h"

namespace weir::test {
namespace {

/// A box from (1, 1, 1) to (3, 5, 9), in 12 separate triangles, as STL files have them.
TriangleMesh soup() {
  TriangleMesh mesh;
  const auto corner = [](int bits) {
    return Vec3f{bits & 1 ? 3.0f : 1.0f, bits & 2 ? 5.0f : 1.0f, bits & 4 ? 9.0f : 1.0f};
  };
  const int quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                           {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads)
    for (const auto& t : {Vec3i{q[0], q[1], q[2]}, Vec3i{q[0], q[2], q[3]}}) {
      const int first = static_cast<int>(mesh.vertices.size());
      for (int k = 0; k < 3; ++k) mesh.vertices.push_back(corner(t[k]));
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
  return mesh;
}

class FakeReader final : public MeshReader {
 public:
  explicit FakeReader(TriangleMesh mesh) : mesh_(std::move(mesh)) {}
  std::vector<std::string> extensions() const override { return {".fake", ".other"}; }
  TriangleMesh read(const std::filesystem::path&) const override { return mesh_; }

 private:
  TriangleMesh mesh_;
};

class MeshFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = std::filesystem::temp_directory_path() /
             ("weir_mesh_file_" + std::to_string(::getpid()) + "_" +
              testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string fileNamed(const std::string& name) const {
    std::ofstream(folder / name) << "made up";
    return (folder / name).string();
  }
  TriangleMesh read(Value parameters, const TriangleMesh& mesh = soup(), bool withReader = true) {
    if (parameters.find("file") == nullptr) parameters["file"] = fileNamed("box.FAKE");
    Registry registry;
    if (withReader)
      registry.addService<MeshReader>("fake", [mesh] { return std::make_unique<FakeReader>(mesh); });
    warnings.clear();
    Log log([this](LogLevel, std::string_view text) { warnings.emplace_back(text); });
    const auto device = openDevice("cpu");
    SceneGraph graph;
    auto& node = static_cast<MeshFile&>(graph.add(std::make_unique<MeshFile>(), "solid"));
    node.assignAll(parameters, {});
    graph.reset({*device, log, registry, {}, 1e-3, 1});
    return *node.surface;
  }

  std::filesystem::path folder;
  std::vector<std::string> warnings;
};

void expectBounds(const TriangleMesh& mesh, const Vec3f& lo, const Vec3f& hi) {
  const Aabb box = mesh.bounds();
  EXPECT_LT(length(box.lo - lo), 1e-5f) << box.lo.x << " " << box.lo.y << " " << box.lo.z;
  EXPECT_LT(length(box.hi - hi), 1e-5f) << box.hi.x << " " << box.hi.y << " " << box.hi.z;
}

TEST_F(MeshFileTest, IsWeldedAndOtherwiseAsInTheFile) {
  const TriangleMesh mesh = read(Value::object());
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(diagnose(mesh).message(), "");
  EXPECT_NEAR(mesh.volume(), 64, 1e-4);
  EXPECT_TRUE(warnings.empty());
  expectBounds(mesh, {1, 1, 1}, {3, 5, 9});
}

TEST_F(MeshFileTest, IsScaledPutUprightTurnedAndPlaced) {
  expectBounds(read(object({{"unit", 0.1}})), {0.1f, 0.1f, 0.1f}, {0.3f, 0.5f, 0.9f});
  expectBounds(read(object({{"fit_size", 2}})), {0.25f, 0.25f, 0.25f}, {0.75f, 1.25f, 2.25f});
  expectBounds(read(object({{"up", "z"}})), {1, 1, -5}, {3, 9, -1});
  expectBounds(read(object({{"up", "x"}})), {-5, 1, 1}, {-1, 3, 9});
  expectBounds(read(object({{"anchor", "center"}, {"position", Value::Array{10, 20, 30}}})), {9, 18, 26},
               {11, 22, 34});
  expectBounds(read(object({{"anchor", "base"}, {"fit_size", 4}, {"up", "z"}})), {-0.5f, 0, -1},
               {0.5f, 4, 1});
  // Turned about its anchor: x goes to -z.
  expectBounds(read(object({{"anchor", "center"},
                            {"rotation", Value::Array{0, 90, 0}},
                            {"position", Value::Array{10, 20, 30}}})),
               {6, 18, 29}, {14, 22, 31});
  for (const char* up : {"x", "y", "z"}) EXPECT_GT(read(object({{"up", up}})).volume(), 0);
}

TEST_F(MeshFileTest, WarnsOfWhatIsWrongWithTheMesh) {
  TriangleMesh holed = soup();
  holed.triangles.pop_back();
  EXPECT_EQ(read(Value::object(), holed).triangles.size(), 11u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "solid");
  EXPECT_CONTAINS(warnings[0], "3 open edges (holes)");

  TriangleMesh turned = soup();
  turned.flip();
  EXPECT_LT(read(Value::object(), turned).volume(), 0);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_CONTAINS(warnings[0], "inside out");
  EXPECT_CONTAINS(warnings[0], "flip");
  EXPECT_GT(read(object({{"flip", true}}), turned).volume(), 0);
  EXPECT_TRUE(warnings.empty());
}

TEST_F(MeshFileTest, SaysWhatIsWrongWithTheFile) {
  const auto expectIo = [&](const Value& parameters, const TriangleMesh& mesh, bool withReader,
                            const std::vector<std::string>& parts) {
    const Error e = errorOf([&] { read(parameters, mesh, withReader); });
    EXPECT_EQ(e.kind(), ErrorKind::kIo) << e.what();
    EXPECT_EQ(e.location().node, "solid");
    EXPECT_EQ(e.location().parameter, "file");
    for (const std::string& part : parts) EXPECT_CONTAINS(e.what(), part);
  };
  const std::string missing = (folder / "none.fake").string();
  expectIo(object({{"file", missing}}), soup(), true, {missing, "no such file"});
  expectIo(object({{"file", folder.string()}}), soup(), true, {folder.string(), "folder"});
  expectIo(object({{"file", fileNamed("box.txt")}}), soup(), true, {"'.txt'", ".fake, .other"});
  expectIo(object({{"file", fileNamed("box")}}), soup(), true, {"no ending", ".fake, .other"});
  expectIo(object({{"file", fileNamed("box.obj")}}), soup(), false, {"'.obj'", "no plugin", "assimp"});
  expectIo(Value::object(), {}, true, {"no triangles"});
  TriangleMesh flat = soup();
  for (Vec3f& v : flat.vertices) v = {1, 2, 3};
  expectIo(Value::object(), flat, true, {"none of the file's 12 triangles"});
}

TEST_F(MeshFileTest, SaysWhatIsWrongWithTheParameters) {
  const Error none = errorOf([] { MeshFile().assignAll(Value::object(), {}); });
  EXPECT_EQ(none.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(none.what(), "no file");
  EXPECT_CONTAINS(errorOf([&] { read(object({{"unit", 2}, {"fit_size", 1}})); }).what(), "one of them");
  const Error huge = errorOf([&] { read(object({{"unit", 3e38}})); });
  EXPECT_EQ(huge.kind(), ErrorKind::kScene);
  EXPECT_CONTAINS(huge.what(), "too large");
}

}  // namespace
}  // namespace weir::test
