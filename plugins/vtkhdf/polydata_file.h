// The growing file behind VtkHdfWriter: temporal PolyData in VTKHDF 2.0, one vertex cell a particle, or a
// surface's triangles as polygons.
//
// The layout is the one that VTK's own documentation of the format gives for temporal PolyData, with all
// optional parts, for readers that do not fill them in:
// https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html#vtkhdf-file-format
//
// Cells say nothing but how many there are, so they are written once: steps that have as many particles as
// the one before share its part (its counts and offsets of cells), and all share one row 0, 1, 2, … of point
// ids.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "plugins/vtkhdf/hdf5.h"
#include "plugins/vtkhdf/virtual_steps.h"
#include "plugins/vtkhdf/vtkhdf_layout.h"

namespace weir {

/// Not thread-safe, and every call must be inside a hdf5::Session.
class PolyDataFile {
 public:
  /// Makes the file with no steps. An existing file of that name is replaced only after the new one stands
  /// complete in the same folder. Throws an io Error if the name does not end in .vtkhdf, or is a folder or
  /// anything else but a file, or if the file cannot be made.
  PolyDataFile(const std::filesystem::path& file, const VtkHdfLayout& layout);
  /// Goes on with a file of the same layout behind its first `steps` steps; those that follow are left out.
  /// It is changed beside the file, which it replaces once it is whole. Throws an io Error if there are
  /// fewer.
  PolyDataFile(const std::filesystem::path& file, const VtkHdfLayout& layout, std::int64_t steps);
  /// Makes a whole file of particles that stand in other files, and brings it to the disk. What stands at the
  /// path stays until then, and after an io Error.
  static void writeVirtual(const std::filesystem::path& file, const VtkHdfLayout& layout,
                           const VirtualSteps& from, const ExportTexts& texts);
  /// Makes the file that such a file names in VirtualSteps::counting, with the numbers below `end`, in the
  /// same way.
  static void writeCounting(const std::filesystem::path& file, std::int64_t end);

  /// Adds one step and hands it to the operating system. After an io Error only abandon() may be called.
  void write(const VtkHdfFrame& frame);
  /// Puts a text into the file's group /simulation, which readers of VTKHDF ignore.
  void setText(const std::string& name, std::string_view text);
  /// Waits until all steps are on the disk.
  void sync();
  /// Completes the file.
  void close();
  /// After an error: closes without touching what is on the disk.
  void abandon();

 private:
  PolyDataFile() = default;
  PolyDataFile(const std::filesystem::path& file, const VtkHdfLayout& layout, const VirtualSteps& from,
               const ExportTexts& texts);

  /// The four data sets by which PolyData lists cells of one kind.
  struct Cells {
    Cells(hdf5::Group& root, const std::string& kind, std::int64_t chunkRows);
    Cells(hdf5::Group group, std::int64_t chunkRows);
    /// Leaves that many parts, ids and offsets.
    void truncate(std::int64_t parts, std::int64_t ids, std::int64_t offsetRows);
    // Each adds a part: without cells, with one cell for each of that many points, or with triangles.
    void appendNone();
    void appendPoints(std::int64_t count);
    /// The same where the numbers of points are there.
    void appendCounts(std::int64_t cells, std::int64_t ids);
    void appendTriangles(std::span<const Vec3i> triangles);
    hdf5::Dataset cellCounts, connectivityCounts, connectivity, offsets;
  };
  /// The group Steps: where in each data set a step begins.
  struct Steps {
    explicit Steps(hdf5::Group& root);
    void truncate(std::int64_t steps);
    hdf5::Group group;
    hdf5::Dataset values, partOffsets, partCounts, pointOffsets, cellOffsets, connectivityOffsets;
  };
  /// A data set and where in it each step begins.
  struct Column {
    hdf5::Dataset values, offsets;
  };
  struct Field {
    hdf5::Dataset values, offsets, sizes;
  };
  /// All that the file consists of; gone after close().
  struct Contents {
    Contents(hdf5::File& file, const VtkHdfLayout& layout);
    hdf5::Group root, simulation;
    Steps steps;
    hdf5::Dataset points, pointCounts;
    Cells vertices, lines, polygons, strips;
    std::vector<Column> attributes;
    std::vector<Field> fields;
  };

  /// All of a step but values of points and triangles.
  struct Step {
    std::span<const double> fields;
    std::int64_t points;
    std::span<const Vec3i> triangles;
  };

  void truncate(std::int64_t steps);
  void appendValues(const VtkHdfFrame& frame);
  /// All but its time.
  void appendStep(const Step& step);
  /// Lets `fill` make the file at `draft`, then puts it in its place; at an error nothing is left of it.
  template <class F>
  void replaceBy(const std::filesystem::path& real, const std::filesystem::path& draft, const F& fill);
  /// The cells that steps have: vertices for particles, polygons for triangles.
  Cells& cells() { return triangles_ ? contents_->polygons : contents_->vertices; }
  /// Adds a part with the cells of a step; of particles it serves also the steps that follow with as many.
  void addPart(const Step& step);

  std::unique_ptr<hdf5::File> file_;
  std::unique_ptr<Contents> contents_;
  bool triangles_ = false;
  bool virtual_ = false;
  std::int64_t frames_ = 0, points_ = 0;
  std::int64_t parts_ = 0, cells_ = 0;  // of all parts
  std::int64_t partPoints_ = -1;        // points of the last part; -1: there is none
  std::int64_t partCells_ = 0;          // its cells
};

}  // namespace weir
