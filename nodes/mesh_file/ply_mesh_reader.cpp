#include "nodes/mesh_file/ply_mesh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/geometry/ply_data.h"
#include "framework/geometry/polygon.h"
#include "framework/scene/scene_file.h"

namespace weir {

namespace {

/// Vertices are numbered by int.
constexpr std::uint64_t kMaxVertices = 500'000'000;

std::optional<std::size_t> findProperty(const PlyElement& element,
                                        std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < element.properties.size(); ++i)
    if (std::find(names.begin(), names.end(), element.properties[i].name) != names.end()) return i;
  return std::nullopt;
}

/// What the rows of an element are for a mesh.
enum class RowKind { kVertex, kFace, kStrip, kOther };

class PlyMesh {
 public:
  explicit PlyMesh(const PlyHeader& header) {
    bool hasVertices = false;
    for (const PlyElement& element : header.elements) {
      if (element.name == "vertex") useVertices(element), hasVertices = true;
      if (element.name == "face") faces_ = indicesOf(element);
      if (element.name == "tristrips") strips_ = indicesOf(element);
    }
    if (!hasVertices) throw ioError("there is no element 'vertex'", "an element 'vertex'");
  }

  template <class Numbers>
  void readRow(Numbers& numbers, const PlyElement& element) {
    switch (kindOf(element)) {
      case RowKind::kVertex:
        return readVertex(numbers, element);
      case RowKind::kFace:
        readList(numbers, element, *faces_);
        return addFace(numbers.place());
      case RowKind::kStrip:
        readList(numbers, element, *strips_);
        return addStrips(numbers.place());
      case RowKind::kOther:
        break;
    }
    skipPlyRow(numbers, element);
  }

  TriangleMesh take() {
    // Faces may stand before the vertices.
    std::size_t begin = 0;
    for (const std::size_t end : ends_) {
      addPolygon({corners_.data() + begin, end - begin}, mesh_.vertices, mesh_.triangles);
      begin = end;
    }
    return std::move(mesh_);
  }

 private:
  void useVertices(const PlyElement& element) {
    if (element.count > kMaxVertices)
      throw ioError("the file announces " + std::to_string(element.count) + " vertices",
                    "at most " + std::to_string(kMaxVertices));
    vertexCount_ = element.count;
    constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
    for (int k = 0; k < 3; ++k) {
      const auto found = findProperty(element, {kNames[static_cast<std::size_t>(k)]});
      if (!found || element.properties[*found].lengthType)
        throw ioError("the element 'vertex' has no property " + inQuotes(kNames[static_cast<std::size_t>(k)]),
                      "properties x, y and z");
      axes_[static_cast<std::size_t>(k)] = *found;
    }
  }

  /// Where the list of corners stands among an element's properties.
  static std::size_t indicesOf(const PlyElement& element) {
    const auto found = findProperty(element, {"vertex_indices", "vertex_index"});
    if (!found || !element.properties[*found].lengthType || isFloat(element.properties[*found].type))
      throw ioError("the element " + inQuotes(element.name) + " has no list of integers 'vertex_indices'",
                    "a property list of that name, or of the name 'vertex_index'");
    return *found;
  }

  RowKind kindOf(const PlyElement& element) const {
    if (element.name == "vertex") return RowKind::kVertex;
    if (element.name == "face") return RowKind::kFace;
    return element.name == "tristrips" ? RowKind::kStrip : RowKind::kOther;
  }

  template <class Numbers>
  void readVertex(Numbers& numbers, const PlyElement& element) {
    Vec3f position{};
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const auto axis = std::find(axes_.begin(), axes_.end(), i);
      if (axis == axes_.end())
        skipPlyProperty(numbers, element.properties[i]);
      else
        position[static_cast<int>(axis - axes_.begin())] =
            static_cast<float>(numbers.next(element.properties[i].type));
    }
    mesh_.vertices.push_back(position);
  }

  /// The list at `index` of the element's properties into indices_.
  template <class Numbers>
  void readList(Numbers& numbers, const PlyElement& element, std::size_t index) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& property = element.properties[i];
      if (i != index) {
        skipPlyProperty(numbers, property);
        continue;
      }
      indices_.clear();
      for (std::uint64_t left = nextPlyLength(numbers, property); left > 0; --left)
        indices_.push_back(numbers.next(property.type));
    }
  }

  int asVertex(double number, const Location& place) const {
    if (!(number >= 0 && number < static_cast<double>(vertexCount_)) || number != std::floor(number))
      throw ioError(fmt::format("a face names vertex {} of {}", number, vertexCount_),
                    "integers from 0 on, below the number of vertices")
          .at(place);
    return static_cast<int>(number);
  }

  void addFace(const Location& place) {
    if (indices_.size() < 3) return;  // a point or a line
    for (const double number : indices_) corners_.push_back(asVertex(number, place));
    ends_.push_back(corners_.size());
  }

  /// Every corner of a strip makes a triangle with the two before it, turned in turn; -1 begins another one.
  void addStrips(const Location& place) {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < indices_.size(); ++i) {
      if (indices_[i] < 0) {
        begin = i + 1;
        continue;
      }
      if (i < begin + 2) continue;
      const bool turned = (i - begin) % 2 == 1;
      for (const std::size_t k : {turned ? i - 1 : i - 2, turned ? i - 2 : i - 1, i})
        corners_.push_back(asVertex(indices_[k], place));
      ends_.push_back(corners_.size());
    }
  }

  std::array<std::size_t, 3> axes_{};
  std::optional<std::size_t> faces_, strips_;
  std::vector<double> indices_;  // of the present row
  std::uint64_t vertexCount_ = 0;
  std::vector<int> corners_;       // of all polygons
  std::vector<std::size_t> ends_;  // of each polygon among them
  TriangleMesh mesh_;
};

TriangleMesh readPlyMesh(std::string_view content) {
  const PlyHeader header = readPlyHeader(content);
  PlyMesh mesh(header);
  forEachPlyRow(content, header,
                [&](auto& numbers, const PlyElement& element) { mesh.readRow(numbers, element); });
  return mesh.take();
}

}  // namespace

TriangleMesh PlyMeshReader::read(const std::filesystem::path& file) const {
  const std::string content = readTextFile(file, std::numeric_limits<std::size_t>::max());
  try {
    return readPlyMesh(content);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
