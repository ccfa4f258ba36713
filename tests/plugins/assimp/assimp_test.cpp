// The plugin as the program loads it, on small files of several formats.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>

#include "framework/base/sanitizers.h"
#include "tests/plugins/assimp/mesh_files.h"
#include "tests/support/byte_mutator.h"
#include "tests/support/expect_error.h"
#include "tests/support/variable_for.h"

namespace weir::test {
namespace {

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

TEST_F(Assimp, ReadsTheFormatsOfSolidsUnasked) {
  expectBox(reader->read(write("box.off", offBox())), "off");
  write("box.bin", gltfBuffer());
  expectBox(reader->read(write("box.gltf", gltfBox("box.bin"))), "gltf, with a file of its own");
  expectBox(reader->read(
                write("data.gltf", gltfBox("data:application/octet-stream;base64," + base64(gltfBuffer())))),
            "gltf, with data in it");
  expectBox(reader->read(write("box.glb", glbBox())), "glb");
  expectBox(reader->read(write("box.3mf", zipped(threeMfBox()))), "3mf");
  std::vector<std::string> endings = reader->extensions();
  std::sort(endings.begin(), endings.end());
  EXPECT_EQ(endings, (std::vector<std::string>{".3mf", ".glb", ".gltf", ".obj", ".off", ".ply", ".stl"}));
  EXPECT_CONTAINS(reader->hintFor(".dae"), "WEIR_MESH_FORMATS=all");
  EXPECT_EQ(reader->hintFor(".txt"), "");
}

TEST_F(Assimp, KnowsTheEndingsWithTheDotInLowerCase) {
  const VariableFor all("WEIR_MESH_FORMATS", "all");
  EXPECT_EQ(reader->hintFor(".dae"), "");
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

TEST_F(Assimp, OpensNoFileOutsideOfTheMeshsFolder) {
  const fs::path inside = folder / "inside";
  fs::create_directories(inside / "below");
  const auto write = [&](const fs::path& file) { std::ofstream(file, std::ios::binary) << gltfBuffer(); };
  write(inside / "box.bin");
  write(inside / "below/deep.bin");
  // Of a name of its own, as Assimp looks for a file's name in the mesh's folder, too.
  write(folder / "outside.bin");
  fs::create_symlink(folder / "outside.bin", inside / "link.bin");
  fs::create_symlink(inside / "box.bin", inside / "near.bin");
  const auto uses = [&](const std::string& uri) { return Assimp::write("inside/box.gltf", gltfBox(uri)); };
  for (const std::string uri : {"box.bin", "below/deep.bin", "near.bin", "below/../box.bin"})
    expectBox(reader->read(uses(uri)), uri.c_str());
  for (const std::string& uri :
       {std::string("../outside.bin"), (folder / "outside.bin").string(), std::string("link.bin"),
        std::string("below/../../outside.bin"), std::string("/dev/zero")})
    EXPECT_EQ(errorOf([&] { reader->read(uses(uri)); }).kind(), ErrorKind::kIo) << uri;
  // The mesh itself may be a link: the scene has named it.
  fs::create_directories(folder / "scene");
  fs::create_symlink(Assimp::write("box.obj", objBox()), folder / "scene/box.obj");
  expectBox(reader->read(folder / "scene/box.obj"), "a link");
}

TEST_F(Assimp, AFileThatUnpacksToFarMoreThanItHoldsIsRefused) {
#if defined(WEIR_ADDRESS_SANITIZER) || defined(WEIR_THREAD_SANITIZER)
  GTEST_SKIP() << "sanitizers have no limit of memory";
#endif
  const fs::path bomb = write("bomb.3mf", zipped(threeMfBox(std::size_t{400} << 20)));
  EXPECT_LT(fs::file_size(bomb), 4u << 20);
  const Error e = errorOf([&] { reader->read(bomb); });
  EXPECT_EQ(e.kind(), ErrorKind::kIo);
  EXPECT_CONTAINS(e.what(), bomb.string());
  EXPECT_CONTAINS(e.message(), "memory");
  EXPECT_CONTAINS(e.allowed(), "a file of 2 MB");
  EXPECT_CONTAINS(e.hint(), "WEIR_MESH_MEMORY_MB");
  const VariableFor more("WEIR_MESH_MEMORY_MB", "4000");
  expectBox(reader->read(bomb), "with more memory");
}

TEST_F(Assimp, LimitsThatAreNoNumbersAreRefused) {
  const fs::path box = write("box.obj", objBox());
  for (const char* variable : {"WEIR_MESH_MEMORY_MB", "WEIR_MESH_SECONDS"})
    for (const char* value : {"0", "-1", "many", "1.5", "99999999999"}) {
      const VariableFor wrong(variable, value);
      const Error e = errorOf([&] { reader->read(box); });
      EXPECT_EQ(e.kind(), ErrorKind::kUsage) << variable << "=" << value;
      EXPECT_CONTAINS(e.what(), variable);
    }
}

struct DamagedSeed {
  const char* file;
  std::function<std::string()> content;
};

class DamagedMesh : public Assimp, public testing::WithParamInterface<DamagedSeed> {};

INSTANTIATE_TEST_SUITE_P(Formats, DamagedMesh,
                         testing::Values(DamagedSeed{"d.obj", [] { return std::string(objBox()); }},
                                         DamagedSeed{"t.stl", [] { return stlText(); }},
                                         DamagedSeed{"b.stl", [] { return stlBinary(); }},
                                         DamagedSeed{"d.off", [] { return std::string(offBox()); }},
                                         DamagedSeed{"d.gltf",
                                                     [] {
                                                       return gltfBox(
                                                           "data:application/octet-stream;base64," +
                                                           base64(gltfBuffer()));
                                                     }},
                                         DamagedSeed{"d.glb", [] { return glbBox(); }},
                                         DamagedSeed{"d.3mf", [] { return zipped(threeMfBox()); }}),
                         [](const testing::TestParamInfo<DamagedSeed>& seed) {
                           std::string name = seed.param.file;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

// Damaged files are read or refused. WEIR_TEST_MUTANTS is how many there are of each format.
TEST_P(DamagedMesh, DoesNoHarm) {
  const VariableFor hurry("WEIR_MESH_SECONDS", "5");
  const char* asked = std::getenv("WEIR_TEST_MUTANTS");
  const std::uint64_t mutants = asked != nullptr ? std::strtoull(asked, nullptr, 10) : 60;
  const std::string content = GetParam().content();
  std::uint64_t refused = 0, contained = 0;
  for (std::uint64_t seed = 0; seed < mutants; ++seed) {
    const fs::path file = write(GetParam().file, damaged(content, seed));
    try {
      const TriangleMesh mesh = reader->read(file);
      for (const Vec3i& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) EXPECT_LT(static_cast<std::size_t>(t[k]), mesh.vertices.size());
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(e.kind(), ErrorKind::kIo);
      EXPECT_CONTAINS(e.what(), file.string());
      if (std::string(e.message()).find("Assimp ") != std::string::npos) ++contained;
    }
  }
  if (asked != nullptr)
    std::printf("%s: %llu refused, %llu crashes or limits within the copy\n", GetParam().file,
                static_cast<unsigned long long>(refused), static_cast<unsigned long long>(contained));
  // If none were refused, the damage would not be what this test needs.
  EXPECT_GT(refused, 0u);
}

// The program's answer to a file that once kept it busy for ever.
TEST(MeshInAProgram, APlyFileThatEndsWithinItsHeaderIsAnErrorAtOnce) {
  const TemporaryFolder folder;
  const ChildResult result = runWeir({"run", resourcesFolder() + "/scenes/mesh_in_tank.json", "--frames", "1",
                                      "--set", "mesh.file=" + folder.write("t.ply", "ply\nformat ascii")},
                                     {.limit = std::chrono::seconds(60)});
  EXPECT_EQ(result.code, 5) << result.err;
  EXPECT_CONTAINS(result.err, "t.ply:2:1: node 'mesh': the file ends within its header");
}

TEST(MeshInAProgram, AFormatThatIsNotReadUnaskedNamesTheWay) {
  const TemporaryFolder folder;
  const std::vector<std::string> run{
      "run",      resourcesFolder() + "/scenes/mesh_in_tank.json",
      "--frames", "0",
      "--set",    "water.spacing=0.05",
      "--set",    "mesh.file=" + folder.write("two.dae", std::string(kPlacedTwice))};
  const ChildResult refused = runWeir(run);
  EXPECT_EQ(refused.code, 5) << refused.err;
  EXPECT_CONTAINS(refused.err, ".3mf, .glb, .gltf, .obj, .off, .ply, .stl");
  EXPECT_CONTAINS(refused.err, "WEIR_MESH_FORMATS=all");
  EXPECT_EQ(runWeir(run, {.environment = {{"WEIR_MESH_FORMATS", "all"}}}).code, 0);
}

}  // namespace
}  // namespace weir::test
