// Small files of one box in every format that is read unasked, and the plugin as the program loads it.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "framework/graph/plugin.h"
#include "nodes/mesh_file/mesh_reader.h"
#include "tests/support/child_process.h"

namespace weir::test {

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
inline Vec3f corner(int bits) {
  return {bits & 1 ? 1.0f : 0.0f, bits & 2 ? 2.0f : 0.0f, bits & 4 ? 3.0f : 0.0f};
}
inline constexpr int kQuads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

inline std::string text(const Vec3f& v) {
  return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

inline std::string objBox() {
  std::string file = "# a box of quads\n";
  for (int i = 0; i < 8; ++i) file += "v " + text(corner(i)) + "\n";
  for (const auto& q : kQuads) {
    file += "f";
    for (const int i : q) file += " " + std::to_string(i + 1);
    file += "\n";
  }
  return file;
}

inline std::string plyHead(int vertices, int faces) {
  std::string head = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
                     "\nproperty float x\nproperty float y\nproperty float z\n";
  if (faces > 0)
    head += "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  return head + "end_header\n";
}

inline std::string plyBox() {
  std::string file = plyHead(8, 6);
  for (int i = 0; i < 8; ++i) file += text(corner(i)) + "\n";
  for (const auto& q : kQuads) {
    file += "4";
    for (const int i : q) file += " " + std::to_string(i);
    file += "\n";
  }
  return file;
}

inline std::vector<std::array<Vec3f, 3>> boxTriangles() {
  std::vector<std::array<Vec3f, 3>> triangles;
  for (const auto& q : kQuads) {
    triangles.push_back({corner(q[0]), corner(q[1]), corner(q[2])});
    triangles.push_back({corner(q[0]), corner(q[2]), corner(q[3])});
  }
  return triangles;
}

inline std::string stlText() {
  std::string file = "solid box\n";
  for (const auto& t : boxTriangles()) {
    file += "facet normal 0 0 0\nouter loop\n";
    for (const Vec3f& v : t) file += "vertex " + text(v) + "\n";
    file += "endloop\nendfacet\n";
  }
  return file + "endsolid box\n";
}

inline std::string stlBinary() {
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

inline std::string offBox() {
  std::string file = "OFF\n8 6 0\n";
  for (int i = 0; i < 8; ++i) file += text(corner(i)) + "\n";
  for (const auto& q : kQuads) {
    file += "4";
    for (const int i : q) file += " " + std::to_string(i);
    file += "\n";
  }
  return file;
}

/// Positions and indices of the box, as a buffer of glTF.
inline std::string gltfBuffer() {
  std::string bytes;
  const auto append = [&](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  for (int i = 0; i < 8; ++i) {
    const Vec3f v = corner(i);
    append(&v, sizeof v);
  }
  for (const auto& q : kQuads)
    for (const int k : {0, 1, 2, 0, 2, 3}) {
      const auto index = static_cast<std::uint16_t>(q[k]);
      append(&index, sizeof index);
    }
  return bytes;
}

/// `uri` is the buffer's; without one it is that of a .glb file.
inline std::string gltfBox(const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
"accessors": [
 {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3]},
 {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
"bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
"buffers": [{"byteLength": 168)" +
         (uri.empty() ? "" : ", \"uri\": \"" + uri + "\"") + "}]}";
}

inline std::string littleEndian(std::uint64_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
  return text;
}

inline std::string glbBox() {
  std::string json = gltfBox("");
  while (json.size() % 4 != 0) json += ' ';
  const std::string buffer = gltfBuffer();
  return "glTF" + littleEndian(2, 4) + littleEndian(12 + 8 + json.size() + 8 + buffer.size(), 4) +
         littleEndian(json.size(), 4) + "JSON" + json + littleEndian(buffer.size(), 4) +
         std::string("BIN\0", 4) + buffer;
}

inline std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {  // a multiple of three bytes
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | static_cast<unsigned char>(bytes[i + k]);
    for (int shift = 18; shift >= 0; shift -= 6) text += kDigits[three >> shift & 63];
  }
  return text;
}

/// A file of a zip archive.
struct ZipMember {
  std::string name, text;
};

/// Compressed as well as zlib can.
std::string zipped(const std::vector<ZipMember>& members);
/// The members of a .3mf file of the box, whose model ends in `blanks` blanks.
std::vector<ZipMember> threeMfBox(std::size_t blanks = 0);

}  // namespace weir::test
