#include "nodes/particle_file/ply_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>

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

/// The numbers of those properties that may become attributes, as they are read.
class OtherNumbers {
 public:
  OtherNumbers(const PlyElement& vertex, const ParticleColumns& columns) : places_(vertex.properties.size()) {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const PlyProperty& property = vertex.properties[i];
      // An int does not hold all of the unsigned ones.
      if (columns.slot(i) || property.lengthType || property.type == PlyType::kUint32) continue;
      ParticleColumn column{.info = {.name = property.name}};
      if (!isFloat(property.type)) {
        column.info.type = AttributeType::kInt;
        column.values = std::vector<int>();
      }
      places_[i] = found_.size();
      found_.push_back(std::move(column));
    }
  }

  template <class Numbers>
  void read(Numbers& numbers, const PlyProperty& property, std::size_t place) {
    if (!places_[place]) return skipPlyProperty(numbers, property);
    auto& values = found_[*places_[place]].values;
    const double number = numbers.next(property.type);
    if (auto* whole = std::get_if<std::vector<int>>(&values))
      whole->push_back(wholeNumber(number, property, numbers.place()));
    else
      std::get<std::vector<float>>(values).push_back(static_cast<float>(number));
  }

  /// With NAME_x, NAME_y and NAME_z as one vector.
  std::vector<ParticleColumn> take() {
    std::vector<ParticleColumn> taken;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      const std::string& name = found_[i].info.name;
      if (i + 2 < found_.size() && name.ends_with("_x") && isVector(i, name.substr(0, name.size() - 2))) {
        taken.push_back(vectorOf(i, name.substr(0, name.size() - 2)));
        i += 2;
      } else {
        taken.push_back(std::move(found_[i]));
      }
    }
    return taken;
  }

 private:
  /// In ASCII files any number may stand where the header promises an integer.
  static int wholeNumber(double number, const PlyProperty& property, const Location& place) {
    const auto whole = static_cast<int>(
        std::clamp(number, double(std::numeric_limits<int>::min()), double(std::numeric_limits<int>::max())));
    if (double(whole) != number)
      throw ioError(inQuotes(property.name) + " is no integer of 32 bits", "an integer, as the header says")
          .at(place);
    return whole;
  }
  bool isVector(std::size_t first, const std::string& name) const {
    constexpr std::array<const char*, 3> kEndings{"_x", "_y", "_z"};
    for (std::size_t k = 0; k < kEndings.size(); ++k) {
      const AttributeInfo& info = found_[first + k].info;
      if (info.name != name + kEndings[k] || info.type != AttributeType::kFloat) return false;
    }
    return true;
  }
  ParticleColumn vectorOf(std::size_t first, const std::string& name) const {
    const auto numbers = [&](std::size_t k) -> const std::vector<float>& {
      return std::get<std::vector<float>>(found_[first + k].values);
    };
    std::vector<Vec3f> vectors(numbers(0).size());
    for (std::size_t i = 0; i < vectors.size(); ++i)
      vectors[i] = {numbers(0)[i], numbers(1)[i], numbers(2)[i]};
    return {.info = {.name = name, .type = AttributeType::kVec3}, .values = std::move(vectors)};
  }

  std::vector<std::optional<std::size_t>> places_;  // of each property in found_
  std::vector<ParticleColumn> found_;
};

template <class Numbers>
void readVertex(Numbers& numbers, const PlyElement& vertex, const ParticleColumns& columns,
                OtherNumbers& others, ParticleData& data) {
  ParticleRow row{};
  for (std::size_t i = 0; i < vertex.properties.size(); ++i) {
    const PlyProperty& property = vertex.properties[i];
    const auto slot = columns.slot(i);
    if (!slot) {
      others.read(numbers, property, i);
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
  OtherNumbers others(*vertex, columns);
  forEachPlyRow(content, header, [&](auto& numbers, const PlyElement& element) {
    if (&element == &*vertex)
      readVertex(numbers, element, columns, others, data);
    else
      skipPlyRow(numbers, element);
  });
  if (data.positions.empty()) throw ioError("the element 'vertex' has no rows", "one row or more");
  data.unused = columns.unused();
  data.columns = others.take();
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
