// Reads particles from VTKHDF files: Weir's own exports, and other programs' PolyData or UnstructuredGrid,
// with or without time steps, in one or several parts. Of cells, only polygons are looked at, as triangles.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "framework/base/vec.h"
#include "nodes/particle_file/recording.h"

namespace weir {

/// One array of point data.
using VtkHdfArray = RecordedArray;

struct VtkHdfStep {
  double time = 0;               ///< s; 0 in a file without time steps
  std::vector<Vec3f> positions;  ///< m; finite; may be empty
  std::vector<VtkHdfArray> arrays;

  /// The array of that name in any mix of cases, or null.
  const VtkHdfArray* find(std::string_view name) const;
  /// The array "velocity" as vectors [m/s], finite; empty if there is none. Throws an io Error, without the
  /// file's name, if it has not three components of floating-point numbers.
  std::vector<Vec3f> velocities() const;
};

class VtkHdfReader {
 public:
  /// Opens the file and reads its times. Throws an io Error if there is no such file, if it is no HDF5, or
  /// damaged, or holds no VTKHDF with points, or if it consists of other files that are not all whole.
  explicit VtkHdfReader(const std::filesystem::path& file);
  ~VtkHdfReader();

  /// Of each step [s]; one 0 for a file without time steps. A file whose run was stopped early may have none.
  const std::vector<double>& times() const;
  /// The step whose time is nearest, the earlier one of two; times() must not be empty.
  std::size_t nearestStep(double time) const;
  /// Throws an io Error if the file contradicts itself, is damaged, or holds a position that is not finite.
  VtkHdfStep read(std::size_t step) const;
  /// Throws an io Error if the file has no steps.
  VtkHdfStep readLast() const;
  /// Of a step; 0 if the file has none.
  std::int64_t polygonCount(std::size_t step) const;
  /// The polygons of a step as indices of its points; none if the file has no polygons. Throws an io Error if
  /// they are not triangles, or name points that are not there.
  std::vector<Vec3i> triangles(std::size_t step) const;
  /// A text of the file's group /simulation.
  std::string text(const std::string& name) const;
  bool hasText(const std::string& name) const;
  /// The other files that it consists of, from its folder; none if it is one file.
  const std::vector<std::string>& otherFiles() const;

 private:
  struct Open;
  std::unique_ptr<Open> open_;
};

}  // namespace weir
