#include "nodes/particle_file/ply_reader.h"

#include <algorithm>
#include <cmath>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/geometry/ply_data.h"
#include "nodes/particle_file/particle_columns.h"

namespace weir {

namespace {

/// The element that holds the points.
constexpr std::string_view kVertex = "vertex";

std::vector<std::string> namesOf(const PlyElement& element) {
  std::vector<std::string> names;
  for (const PlyProperty& property : element.properties) names.push_back(property.name);
  return names;
}

/// x, y, z, vx, vy and vz must be single numbers with a fraction.
void checkTypes(const PlyElement& vertex, const ParticleColumns& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    if (columns.slot(i) && (property.lengthType || !isFloat(property.type)))
      throw ioError(inQuotes(property.name) + (property.lengthType ? " is a list" : " is of an integer type"),
                    "property float or property double")
          .at({.line = property.line, .column = 1});
  }
}

template <class Numbers>
void readVertex(Numbers& numbers, const PlyElement& vertex, const ParticleColumns& columns,
                ParticleData& data) {
  ParticleRow row{};
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    const auto slot = columns.slot(i);
    if (!slot) {
      skipPlyProperty(numbers, property);
      continue;
    }
    row[*slot] = static_cast<float>(numbers.next(property.type));
    if (!std::isfinite(row[*slot]))
      throw ioError(inQuotes(property.name) + " is not finite", "a finite single-precision number")
          .at(numbers.place());
  }
  addParticle(row, data);
}

ParticleData readPly(std::string_view content) {
  const PlyHeader header = readPlyHeader(content);
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& element) { return element.name == kVertex; });
  if (vertex == header.elements.end()) throw ioError("there is no element 'vertex'", "an element 'vertex'");
  const ParticleColumns columns(namesOf(*vertex));
  checkTypes(*vertex, columns);

  ParticleData data;
  forEachPlyRow(content, header, [&](auto& numbers, const PlyElement& element) {
    if (&element == &*vertex)
      readVertex(numbers, element, columns, data);
    else
      skipPlyRow(numbers, element);
  });
  if (data.positions.empty()) throw ioError("the element 'vertex' has no rows", "one row or more");
  data.unused = columns.unused();
  return data;
}

}  // namespace

ParticleData PlyReader::read(const std::filesystem::path& file) const {
  const std::string content = readParticleFile(file);
  try {
    return readPly(content);
  } catch (Error& error) {
    throw error.at({.file = file.string()});
  }
}

}  // namespace weir
