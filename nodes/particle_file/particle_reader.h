// Readers of particle files. The node ParticleFile asks the reader for a file's ending; plugins add readers:
//
//   registry.addService<ParticleReader>("vtkhdf", [] { return std::make_unique<VtkhdfParticleReader>(); });
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"
#include "framework/particles/attribute_types.h"

namespace weir {

/// One attribute of particles on the host, with as many values as there are particles.
struct ParticleColumn {
  template <class T>
  using Values = std::vector<T>;

  AttributeInfo info;
  AttributeTypes::VariantOf<Values> values = {};  ///< of the type of `info`
};

/// Particles on the host, in the order of the file's rows.
struct ParticleData {
  std::vector<Vec3f> positions;   ///< m
  std::vector<Vec3f> velocities;  ///< m/s, as many as positions; all 0 where the file has none
  /// What else the file says of each particle, by the names there; ParticleFile tells the user of it.
  std::vector<std::string> unused;
  /// What of that can become attributes, where the reader knows how to: single numbers. Three float columns
  /// NAME_x, NAME_y and NAME_z are the vector NAME.
  std::vector<ParticleColumn> columns;
};

class ParticleReader {
 public:
  static constexpr std::string_view kInterface = "ParticleReader";
  virtual ~ParticleReader() = default;

  /// The endings of files that it reads, lower case with the dot: ".csv".
  virtual std::vector<std::string> extensions() const = 0;
  /// Throws an io Error that names the file, and the line where there are lines, for what cannot be read,
  /// for positions or velocities that are not finite, and for a file without particles.
  virtual ParticleData read(const std::filesystem::path& file) const = 0;
  /// Of a file with several moments, such as an export, the one nearest to a time in s; read() gives the last
  /// one. Throws as read() does, an io Error for a time before the first moment or behind the last one, and a
  /// scene Error if files of this kind have no moments.
  virtual ParticleData readAt(const std::filesystem::path& file, double time) const;
};

}  // namespace weir
