#include "plugins/mesh_export/mesh_text.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <iterator>
#include <string_view>
#include <type_traits>

namespace weir {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr const char* kPlyStart =
    "ply\nformat binary_little_endian 1.0\ncomment made by Weir, lengths in metres\n";

template <class T>
char* put(char* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
  return to + sizeof value;
}

/// What a number is in a file.
template <class T>
auto plyNumber(T number) {
  if constexpr (std::is_same_v<T, std::int64_t>)
    return static_cast<double>(number);
  else
    return number;
}

struct PlyType {
  const char* name;
  std::size_t bytes;
};
PlyType typeOf(const PlyColumn& column) {
  constexpr PlyType kTypes[] = {
      {"float", sizeof(float)}, {"int", sizeof(std::int32_t)}, {"double", sizeof(double)}};
  return kTypes[column.numbers.index()];
}

/// Some readers, assimp among them, take numbers that begin like a blank for more of the header's end. The
/// last bit of the first coordinate is turned then.
void keepFromHeader(std::string& text, std::size_t start) {
  constexpr std::string_view kBlanks = " \t\r\n";
  if (start < text.size() && kBlanks.find(text[start]) != std::string_view::npos)
    text[start] = static_cast<char>(text[start] ^ 1);
}

}  // namespace

std::string plyOf(const MeshSpan& mesh) {
  constexpr std::size_t kVertexBytes = 6 * sizeof(float), kTriangleBytes = 1 + 3 * sizeof(std::int32_t);
  std::string text = kPlyStart;
  text += fmt::format("element vertex {}\n", mesh.vertices.size());
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) text += fmt::format("property float {}\n", name);
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                      mesh.triangles.size());
  const std::size_t start = text.size();
  text.resize(start + mesh.vertices.size() * kVertexBytes + mesh.triangles.size() * kTriangleBytes);
  char* to = text.data() + start;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) to = put(put(to, mesh.vertices[i]), mesh.normals[i]);
  constexpr unsigned char kCorners = 3;
  for (const Vec3i& t : mesh.triangles) to = put(put(to, kCorners), t);
  keepFromHeader(text, start);
  return text;
}

std::string objOf(const MeshSpan& mesh) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "# made by Weir, lengths in metres\n");
  // Shortest decimals that are the same float again.
  for (const Vec3f& v : mesh.vertices) fmt::format_to(out, "v {} {} {}\n", v.x, v.y, v.z);
  for (const Vec3f& n : mesh.normals) fmt::format_to(out, "vn {} {} {}\n", n.x, n.y, n.z);
  for (const Vec3i& t : mesh.triangles)
    fmt::format_to(out, "f {0}//{0} {1}//{1} {2}//{2}\n", t.x + 1, t.y + 1, t.z + 1);
  return fmt::to_string(text);
}

std::string plyOf(std::int64_t count, const std::vector<PlyColumn>& columns) {
  std::string text = kPlyStart;
  text += fmt::format("element vertex {}\n", count);
  for (const PlyColumn& column : columns)
    text += fmt::format("property {} {}\n", typeOf(column).name, column.name);
  text += "end_header\n";
  const std::size_t start = text.size();
  std::size_t rowBytes = 0;
  for (const PlyColumn& column : columns) rowBytes += typeOf(column).bytes;
  text.resize(start + static_cast<std::size_t>(count) * rowBytes);
  char* to = text.data() + start;
  for (std::int64_t i = 0; i < count; ++i)
    for (const PlyColumn& column : columns)
      std::visit(
          [&](const auto& numbers) { to = put(to, plyNumber(numbers[i * column.stride + column.first])); },
          column.numbers);
  keepFromHeader(text, start);
  return text;
}

}  // namespace weir
