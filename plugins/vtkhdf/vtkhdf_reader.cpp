#include "plugins/vtkhdf/vtkhdf_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>

#include "framework/base/check.h"
#include "framework/base/text.h"
#include "plugins/vtkhdf/files_elsewhere.h"
#include "plugins/vtkhdf/hdf5.h"

namespace weir {

namespace {

namespace fs = std::filesystem;
using hdf5::Dataset;
using hdf5::Group;

constexpr std::int64_t kMaxPoints = std::numeric_limits<std::int32_t>::max(), kMaxPolygons = kMaxPoints;

void checkIsFile(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) throw ioError("there is no such file").at({.file = file.string()});
  if (!fs::is_regular_file(status))
    throw ioError("this is a folder or a device, not a file").at({.file = file.string()});
}

std::vector<Vec3f> asVectors(const std::vector<float>& numbers) {
  std::vector<Vec3f> vectors(numbers.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
  return vectors;
}

std::optional<std::size_t> firstNotFinite(const std::vector<Vec3f>& vectors) {
  const auto bad =
      std::find_if_not(vectors.begin(), vectors.end(), [](const Vec3f& v) { return isFinite(v); });
  if (bad == vectors.end()) return std::nullopt;
  return static_cast<std::size_t>(bad - vectors.begin());
}

/// One column of integers, such as an offset for each step.
std::vector<std::int64_t> readIntegers(const Dataset& set) {
  if (!set.isInteger()) throw set.error("holds no integers");
  return set.readAll<std::int64_t>();
}

/// The entry of a step in a data set of Steps; `otherwise` if there is no such data set.
std::int64_t ofStep(const Group& steps, const std::string& name, std::size_t step, std::int64_t otherwise) {
  if (!steps.isDataset(name)) return otherwise;
  const Dataset set = steps.dataset(name);
  if (!set.isInteger() || set.columns() != 1) throw set.error("holds no column of integers");
  return set.read<std::int64_t>(static_cast<std::int64_t>(step), 1).front();
}

/// The same of the polygons, which are third of the four kinds of cells.
std::int64_t ofPolygons(const Group& steps, const std::string& name, std::size_t step) {
  constexpr std::int64_t kKinds = 4;
  constexpr std::size_t kPolygons = 2;
  const Dataset set = steps.dataset(name);
  if (!set.isInteger() || set.columns() != kKinds) throw set.error("holds no rows of 4 integers");
  const std::int64_t first = set.read<std::int64_t>(static_cast<std::int64_t>(step), 1)[kPolygons];
  if (first < 0 || first > hdf5::kMaxRows) throw set.error("has the offset " + std::to_string(first));
  return first;
}

void checkTriangles(const Group& polygons, std::int64_t cells, std::int64_t ids,
                    const std::vector<std::int64_t>& offsets) {
  bool good = ids == 3 * cells;
  for (std::size_t i = 0; good && i < offsets.size(); ++i)
    good = offsets[i] == 3 * static_cast<std::int64_t>(i);
  if (!good) throw polygons.error("holds polygons that are not triangles", "triangles");
}

VtkHdfArray readArray(const Dataset& set, const std::string& name, std::int64_t first, std::int64_t count) {
  VtkHdfArray array{.name = name, .components = static_cast<int>(set.columns()), .values = {}};
  if (set.isInteger())
    array.values = set.read<std::int64_t>(first, count);
  else
    array.values = set.read<float>(first, count);
  return array;
}

}  // namespace

const VtkHdfArray* VtkHdfStep::find(std::string_view name) const {
  const std::string wanted = lowerCase(name);
  for (const VtkHdfArray& array : arrays)
    if (lowerCase(array.name) == wanted) return &array;
  return nullptr;
}

std::vector<Vec3f> VtkHdfStep::velocities() const {
  const VtkHdfArray* array = find("velocity");
  if (!array) return {};
  const auto* numbers = std::get_if<std::vector<float>>(&array->values);
  if (array->components != 3 || !numbers)
    throw ioError("the array " + inQuotes(array->name) + " has " + std::to_string(array->components) +
                      (numbers ? " floating-point numbers a point" : " integers a point"),
                  "3 floating-point numbers a point");
  std::vector<Vec3f> vectors = asVectors(*numbers);
  if (const auto bad = firstNotFinite(vectors))
    throw ioError("the velocity of point " + std::to_string(*bad) + " is not finite", "finite numbers");
  return vectors;
}

struct VtkHdfReader::Open {
  explicit Open(const fs::path& path);
  ~Open() {
    const hdf5::Session session;
    kept.clear();
    steps.reset();
    root.reset();
    file.reset();
  }

  VtkHdfStep read(std::size_t step) const;
  std::int64_t polygonCount(std::size_t step) const;
  std::vector<Vec3i> triangles(std::size_t step) const;

  double fileSize = 0;
  std::optional<hdf5::File> file;
  std::optional<Group> root, steps;
  std::vector<double> times;
  std::vector<std::string> otherFiles;

 private:
  struct Parts {
    std::int64_t first = 0;
    std::vector<std::int64_t> points;  ///< of each
    std::int64_t allPoints = 0;
  };
  Parts partsOf(std::size_t step) const;
  /// How many polygons each part has.
  std::vector<std::int64_t> polygonsOf(const Parts& parts) const;
  void readTimes();
  void checkOtherFiles(const fs::path& path);
  /// Stays open, as opening one that stands in other files takes as long as it has steps.
  const Dataset& keptOpen(const Group& group, const std::string& name) const;

  mutable std::map<std::string, Dataset> kept;
};

VtkHdfReader::Open::Open(const fs::path& path) {
  checkIsFile(path);
  fileSize = bytesOfSet(path);
  file.emplace(hdf5::File::open(path));
  const Group top = file->root();
  constexpr const char* kAllowed = "VTKHDF with a PolyData or an UnstructuredGrid";
  if (!top.isGroup("VTKHDF"))
    throw ioError("this HDF5 file holds no VTKHDF", kAllowed).at({.file = path.string()});
  root.emplace(top.group("VTKHDF"));
  if (!root->hasAttribute("Type")) throw root->error("has no attribute Type", kAllowed);
  const std::string type = root->textAttribute("Type");
  if (type != "PolyData" && type != "UnstructuredGrid")
    throw root->error("is of type " + inQuotes(type), kAllowed);
  if (root->hasAttribute("Version") && root->intAttribute("Version").front() > 2)
    throw root->error("has version " + std::to_string(root->intAttribute("Version").front()), "1 or 2");
  checkOtherFiles(path);
  readTimes();
}

void VtkHdfReader::Open::checkOtherFiles(const fs::path& path) {
  const std::vector<FileElsewhere> files = filesElsewhere(*file, path);
  try {
    checkWhole(files);
  } catch (Error& e) {
    throw e.at({.file = path.string()});
  }
  for (const FileElsewhere& other : files) otherFiles.push_back(other.name);
}

const Dataset& VtkHdfReader::Open::keptOpen(const Group& group, const std::string& name) const {
  const std::string path = group.path() + "/" + name;
  const auto found = kept.find(path);
  return found != kept.end() ? found->second : kept.emplace(path, group.dataset(name)).first->second;
}

void VtkHdfReader::Open::readTimes() {
  if (!root->isGroup("Steps")) {
    times = {0.0};
    return;
  }
  steps.emplace(root->group("Steps"));
  const Dataset values = steps->dataset("Values");
  std::int64_t count = steps->hasAttribute("NSteps") ? steps->intAttribute("NSteps").front() : values.rows();
  if (count == values.rows() + 1) --count;  // its run was killed before the last one got its time
  if (count < 0 || count > values.rows())
    throw steps->error("has " + std::to_string(count) + " steps, but times for " +
                       std::to_string(values.rows()));
  times = values.read<double>(0, count);
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i])) throw values.error("has no finite time for step " + std::to_string(i));
}

VtkHdfReader::Open::Parts VtkHdfReader::Open::partsOf(std::size_t step) const {
  const std::vector<std::int64_t> counts = readIntegers(root->dataset("NumberOfPoints"));
  const auto parts = static_cast<std::int64_t>(counts.size());
  std::int64_t first = 0, here = parts;
  if (steps) {
    first = ofStep(*steps, "PartOffsets", step, static_cast<std::int64_t>(step));
    here = ofStep(*steps, "NumberOfParts", step, 1);
  }
  if (first < 0 || here < 0 || first > parts || here > parts - first)
    throw root->error("lists " + std::to_string(parts) + " parts, but step " + std::to_string(step) +
                      " asks for " + std::to_string(here) + " from part " + std::to_string(first) + " on");
  Parts found{.first = first, .points = {}};
  for (std::int64_t i = first; i < first + here; ++i) {
    const std::int64_t count = counts[static_cast<std::size_t>(i)];
    if (count < 0 || count > kMaxPoints - found.allPoints)
      throw root->error("claims " + std::to_string(count) + " points in part " + std::to_string(i),
                        "0 to " + std::to_string(kMaxPoints) + " in a step");
    found.points.push_back(count);
    found.allPoints += count;
  }
  return found;
}

std::vector<std::int64_t> VtkHdfReader::Open::polygonsOf(const Parts& parts) const {
  const Dataset set = root->group("Polygons").dataset("NumberOfCells");
  if (!set.isInteger()) throw set.error("holds no integers");
  std::vector<std::int64_t> cells =
      set.read<std::int64_t>(parts.first, static_cast<std::int64_t>(parts.points.size()));
  std::int64_t all = 0;
  for (const std::int64_t count : cells) {
    if (count < 0 || count > kMaxPolygons - all)
      throw set.error("claims " + std::to_string(count) + " polygons",
                      "0 to " + std::to_string(kMaxPolygons) + " in a step");
    all += count;
  }
  return cells;
}

std::int64_t VtkHdfReader::Open::polygonCount(std::size_t step) const {
  if (!root->isGroup("Polygons")) return 0;
  const std::vector<std::int64_t> cells = polygonsOf(partsOf(step));
  return std::accumulate(cells.begin(), cells.end(), std::int64_t{0});
}

std::vector<Vec3i> VtkHdfReader::Open::triangles(std::size_t step) const {
  if (polygonCount(step) <= 0) return {};
  const Parts parts = partsOf(step);
  const Group polygons = root->group("Polygons");
  const auto count = static_cast<std::int64_t>(parts.points.size());
  const auto ofParts = [&](const char* name) {
    const Dataset set = polygons.dataset(name);
    if (!set.isInteger()) throw set.error("holds no integers");
    return set.read<std::int64_t>(parts.first, count);
  };
  const std::vector<std::int64_t> cells = polygonsOf(parts), ids = ofParts("NumberOfConnectivityIds");
  const Dataset corners = polygons.dataset("Connectivity"), offsets = polygons.dataset("Offsets");
  if (!corners.isInteger()) throw corners.error("holds no integers");
  std::int64_t cell = steps ? ofPolygons(*steps, "CellOffsets", step) : 0;
  std::int64_t id = steps ? ofPolygons(*steps, "ConnectivityIdOffsets", step) : 0;
  std::vector<Vec3i> result;
  std::int64_t firstPoint = 0;
  for (std::size_t k = 0; k < parts.points.size(); ++k) {
    // Each part has one row of offsets more than cells.
    const std::int64_t row = cell + parts.first + static_cast<std::int64_t>(k);
    checkTriangles(polygons, cells[k], ids[k], offsets.read<std::int64_t>(row, cells[k] + 1));
    const std::vector<std::int64_t> part = corners.read<std::int64_t>(id, ids[k]);
    for (std::size_t i = 0; i < part.size(); i += 3) {
      for (std::size_t j = i; j < i + 3; ++j)
        if (part[j] < 0 || part[j] >= parts.points[k])
          throw corners.error("names point " + std::to_string(part[j]) + " of a part of " +
                              std::to_string(parts.points[k]));
      const auto at = [&](std::size_t j) { return static_cast<int>(firstPoint + part[j]); };
      result.push_back({at(i), at(i + 1), at(i + 2)});
    }
    cell += cells[k];
    id += ids[k];
    firstPoint += parts.points[k];
  }
  return result;
}

VtkHdfStep VtkHdfReader::Open::read(std::size_t step) const {
  const std::int64_t count = partsOf(step).allPoints;
  const Dataset& points = keptOpen(*root, "Points");
  if (points.columns() != 3) throw points.error("has " + std::to_string(points.columns()) + " columns", "3");
  if (points.isInteger()) throw points.error("holds integers", "floating-point numbers");
  if (static_cast<double>(count) > fileSize * hdf5::kStrongestCompression)
    throw points.error("claims " + std::to_string(count) + " points, more than fit into the file");

  VtkHdfStep result{.time = times[step]};
  const std::int64_t first = steps ? ofStep(*steps, "PointOffsets", step, 0) : 0;
  result.positions = asVectors(points.read<float>(first, count));
  if (const auto bad = firstNotFinite(result.positions))
    throw points.error("holds a position that is not finite, point " + std::to_string(*bad) + " of step " +
                           std::to_string(step),
                       "finite numbers");

  if (!root->isGroup("PointData")) return result;
  const Group data = root->group("PointData");
  std::optional<Group> offsets;
  if (steps && steps->isGroup("PointDataOffsets")) offsets.emplace(steps->group("PointDataOffsets"));
  for (const std::string& name : data.members()) {
    if (!data.isDataset(name)) continue;
    const std::int64_t from = offsets ? ofStep(*offsets, name, step, first) : first;
    result.arrays.push_back(readArray(keptOpen(data, name), name, from, count));
  }
  return result;
}

VtkHdfReader::VtkHdfReader(const fs::path& file) {
  const hdf5::Session session;
  open_ = std::make_unique<Open>(file);
}

VtkHdfReader::~VtkHdfReader() = default;

const std::vector<double>& VtkHdfReader::times() const {
  return open_->times;
}

std::size_t VtkHdfReader::nearestStep(double time) const {
  const std::vector<double>& times = open_->times;
  WEIR_CHECK(!times.empty());
  const auto nearest = std::min_element(times.begin(), times.end(), [&](double a, double b) {
    return std::abs(a - time) < std::abs(b - time);
  });
  return static_cast<std::size_t>(nearest - times.begin());
}

VtkHdfStep VtkHdfReader::read(std::size_t step) const {
  WEIR_CHECK(step < open_->times.size());
  const hdf5::Session session;
  return open_->read(step);
}

std::int64_t VtkHdfReader::polygonCount(std::size_t step) const {
  WEIR_CHECK(step < open_->times.size());
  const hdf5::Session session;
  return open_->polygonCount(step);
}

std::vector<Vec3i> VtkHdfReader::triangles(std::size_t step) const {
  WEIR_CHECK(step < open_->times.size());
  const hdf5::Session session;
  return open_->triangles(step);
}

VtkHdfStep VtkHdfReader::readLast() const {
  const hdf5::Session session;
  if (open_->times.empty())
    throw open_->steps->error("is empty: the file holds no time step", "one or more steps");
  return open_->read(open_->times.size() - 1);
}

bool VtkHdfReader::hasText(const std::string& name) const {
  const hdf5::Session session;
  const Group root = open_->file->root();
  return root.isGroup("simulation") && root.group("simulation").isDataset(name);
}

const std::vector<std::string>& VtkHdfReader::otherFiles() const {
  return open_->otherFiles;
}

std::string VtkHdfReader::text(const std::string& name) const {
  const hdf5::Session session;
  return open_->file->root().group("simulation").readText(name);
}

}  // namespace weir
