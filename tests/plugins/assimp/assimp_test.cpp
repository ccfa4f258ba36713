// The plugin as the program loads it, on small files of several formats.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>

#include "framework/graph/plugin.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "tests/support/child_process.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

namespace fs = std::filesystem;

class Assimp : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::temp_directory_path() / ("weir_assimp_" + std::to_string(::getpid()) + "_" +
                                          testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder);
    registry = std::make_unique<Registry>();
    plugin = std::make_unique<Plugin>(buildFolder() + "/lib/weir/plugins/weir_assimp.so", *registry);
    auto services = registry->createServices<MeshReader>();
    ASSERT_EQ(services.size(), 1u);
    EXPECT_EQ(services[0].name, "assimp");
    reader = std::move(services[0].implementation);
  }
  void TearDown() override {
    reader.reset();
    registry.reset();
    fs::remove_all(folder);
  }

  fs::path write(const std::string& name, const std::string& content) const {
    std::ofstream(folder / name, std::ios::binary) << content;
    return folder / name;
  }

  fs::path folder;
  std::unique_ptr<Plugin> plugin;
  std::unique_ptr<Registry> registry;
  std::unique_ptr<MeshReader> reader;
};

/// A corner of the box of 1 x 2 x 3 from the origin.
Vec3f corner(int bits) {
  return {bits & 1 ? 1.0f : 0.0f, bits & 2 ? 2.0f : 0.0f, bits & 4 ? 3.0f : 0.0f};
}
constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                              {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

std::string text(const Vec3f& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

std::string objBox() {
  std::string file = "# a box of quads\n";
  for (int i = 0; i < 8; ++i) file += "v " + text(corner(i)) + "\n";
  for (const auto& q : kQuads) {
    file += "f";
    for (const int i : q) file += " " + std::to_string(i + 1);
    file += "\n";
  }
  return file;
}

std::string plyHead(int vertices, int faces) {
  std::string head = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  if (faces > 0)
    head += "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  return head + "end_header\n";
}

std::string plyBox() {
  std::string file = plyHead(8, 6);
  for (int i = 0; i < 8; ++i) file += text(corner(i)) + "\n";
  for (const auto& q : kQuads) {
    file += "4";
    for (const int i : q) file += " " + std::to_string(i);
    file += "\n";
  }
  return file;
}

std::vector<std::array<Vec3f, 3>> boxTriangles() {
  std::vector<std::array<Vec3f, 3>> triangles;
  for (const auto& q : kQuads) {
    triangles.push_back({corner(q[0]), corner(q[1]), corner(q[2])});
    triangles.push_back({corner(q[0]), corner(q[2]), corner(q[3])});
  }
  return triangles;
}

std::string stlText() {
  std::string file = "solid box\n";
  for (const auto& t : boxTriangles()) {
    file += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3f& v : t) file += "vertex " + text(v) + "\n";
    file += "endloop\nendfacet\n";
  }
  return file + "endsolid box\n";
}

std::string stlBinary() {
  std::string file(80, ' ');
  const auto append = [&](const void* bytes, std::size_t count) {
    file.append(static_cast<const char*>(bytes), count);
  };
  const auto triangles = boxTriangles();
  const auto count = static_cast<std::uint32_t>(triangles.size());
  append(&count, sizeof count);
  for (const auto& t : triangles) {
    const Vec3f normal{};
    append(&normal, sizeof normal);
    for (const Vec3f& v : t) append(&v, sizeof v);
    file.append(2, '\0');
  }
  return file;
}

void expectBox(const TriangleMesh& raw, const char* what) {
  EXPECT_EQ(raw.triangles.size(), 12u) << what;
  const TriangleMesh mesh = cleaned(raw);
  EXPECT_EQ(diagnose(mesh).message(), "") << what;
  EXPECT_EQ(mesh.vertices.size(), 8u) << what;
  EXPECT_NEAR(mesh.volume(), 6, 1e-5) << what;
  const Aabb box = mesh.bounds();
  EXPECT_EQ(box.lo, (Vec3f{0, 0, 0})) << what;
  EXPECT_EQ(box.hi, (Vec3f{1, 2, 3})) << what;
}

TEST_F(Assimp, ReadsTheSameBoxFromSeveralFormats) {
  expectBox(reader->read(write("box.obj", objBox())), "obj");
  expectBox(reader->read(write("box.ply", plyBox())), "ply");
  expectBox(reader->read(write("text.stl", stlText())), "stl, text");
  expectBox(reader->read(write("binary.stl", stlBinary())), "stl, binary");
  expectBox(reader->read(write("BOX WITH SPACES é.OBJ", objBox())), "a strange name");
}

TEST_F(Assimp, TheDuckOfTheResourcesIsClosedAndFacesOutward) {
  const TriangleMesh mesh = cleaned(reader->read(resourcesFolder() + "/meshes/duck.obj"));
  EXPECT_GT(mesh.triangles.size(), 5000u);
  EXPECT_EQ(diagnose(mesh).message(), "");
  EXPECT_GT(mesh.volume(), 0);
}

TEST_F(Assimp, KnowsTheEndingsWithTheDotInLowerCase) {
  const std::vector<std::string> endings = reader->extensions();
  for (const char* ending : {".obj", ".stl", ".ply", ".3ds", ".dae", ".glb"})
    EXPECT_NE(std::find(endings.begin(), endings.end(), ending), endings.end()) << ending;
  for (const std::string& ending : endings) {
    EXPECT_EQ(ending.front(), '.');
    EXPECT_EQ(ending.find_first_of("*;ABCDEFGHIJKLMNOPQRSTUVWXYZ"), std::string::npos) << ending;
  }
}

/// A COLLADA scene that places one tetrahedron twice: moved, and scaled in a mirror under another node.
constexpr std::string_view kPlacedTwice = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><created>2020-01-01T00:00:00</created><modified>2020-01-01T00:00:00</modified><up_axis>Y_UP</up_axis></asset>
  <library_geometries>
    <geometry id="tetrahedron"><mesh>
      <source id="corners">
        <float_array id="numbers" count="12">0 0 0  1 0 0  0 1 0  0 0 1</float_array>
        <technique_common><accessor source="#numbers" count="4" stride="3">
          <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
        </accessor></technique_common>
      </source>
      <vertices id="vertices"><input semantic="POSITION" source="#corners"/></vertices>
      <triangles count="4"><input semantic="VERTEX" source="#vertices" offset="0"/>
        <p>0 2 1  0 1 3  0 3 2  1 2 3</p></triangles>
    </mesh></geometry>
  </library_geometries>
  <library_visual_scenes><visual_scene id="scene">
    <node id="moved"><translate>10 0 0</translate><instance_geometry url="#tetrahedron"/></node>
    <node id="outer"><translate>0 5 0</translate>
      <node id="mirrored"><scale>-2 1 1</scale><instance_geometry url="#tetrahedron"/></node></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
)";

TEST_F(Assimp, AppliesTheTransformsOfTheScene) {
  const TriangleMesh mesh = cleaned(reader->read(write("two.dae", std::string(kPlacedTwice))));
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_EQ(diagnose(mesh).message(), "");
  // Were the mirrored one inside out, its volume would be subtracted.
  EXPECT_NEAR(mesh.volume(), 1 / 6.0 + 2 / 6.0, 1e-6);
  const Aabb box = mesh.bounds();
  EXPECT_LT(length(box.lo - Vec3f{-2, 0, 0}), 1e-6f);
  EXPECT_LT(length(box.hi - Vec3f{11, 6, 1}), 1e-6f);
}

TEST_F(Assimp, LeavesOutWhatIsNoPolygon) {
  EXPECT_TRUE(reader->read(write("points.ply", plyHead(2, 0) + "0 0 0\n1 2 3\n")).empty());
  EXPECT_TRUE(reader->read(write("lines.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\n")).empty());
  EXPECT_TRUE(reader->read(write("noise.obj", std::string(1000, '\xfe'))).empty());
}

TEST_F(Assimp, BrokenFilesAreErrorsThatNameTheFile) {
  const std::string box = objBox(), binary = stlBinary();
  const std::string badIndex = plyHead(3, 1) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  for (const auto& [name, content] : std::vector<std::pair<std::string, std::string>>{
           {"empty.obj", ""},
           {"index.ply", badIndex},
           {"cut.stl", binary.substr(0, 200)},
           {"claims.stl", std::string(80, ' ') + "\xff\xff\xff\x7f" + std::string(50, '\0')},
           {"no.dae", "<COLLADA"},
           {"claims.off", "OFF\n4000 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n4 0 1 2 3\n"}}) {
    const fs::path file = write(name, content);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const Error e = errorOf([&] { reader->read(file); });
    EXPECT_EQ(testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout(), "") << name;
    EXPECT_EQ(e.kind(), ErrorKind::kIo) << name;
    EXPECT_CONTAINS(e.what(), file.string());
  }
  EXPECT_EQ(errorOf([&] { reader->read(folder / "none.obj"); }).kind(), ErrorKind::kIo);
}

}  // namespace
}  // namespace weir::test
