#include "framework/geometry/mesh_sdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/geometry/mesh_query.h"

namespace weir {

namespace {

constexpr int kBrick = MeshSdfView::kBrick;
constexpr int kNodes = MeshSdfView::kNodes;
constexpr int kBrickNodes = kNodes * kNodes * kNodes;

/// The host's cores: those of the device, if it runs on them.
class HostThreads {
 public:
  explicit HostThreads(Device& device) {
    if (device.kind() != DeviceKind::kCpu) own_.emplace();
    cpu_ = own_ ? &*own_ : &static_cast<CpuDevice&>(device);
  }

  /// Calls f(i) for every i in [0, n), in any order.
  template <class F>
  void forEach(std::int64_t n, F f) {
    const auto body = [](void* context, std::int64_t begin, std::int64_t end) {
      for (std::int64_t i = begin; i < end; ++i) (*static_cast<F*>(context))(i);
    };
    cpu_->forRanges(n, 1, body, &f);
  }

 private:
  std::optional<CpuDevice> own_;
  CpuDevice* cpu_ = nullptr;
};

constexpr double kBytesPerBrick = sizeof(float) + sizeof(int);  // of the coarse grid
constexpr double kMaxCoarseBytes = MeshSdf::kMaxBytes / 8.0;
constexpr double kBytesPerFineBrick = kBrickNodes * sizeof(float);

struct GridSize {
  Vec3d bricks;              ///< whole numbers, which may be too large for an int
  double bytes;              ///< of the coarse grid
  double probableFineBytes;  ///< if the surface is smooth
};

GridSize sizeOfGrid(const TriangleMesh& mesh, float cellSize, float band) {
  // With one brick of margin at least, distances at the edge of the grid grow outwards.
  const float margin = std::max(band + cellSize, kBrick * cellSize);
  const Vec3f extent = mesh.bounds().size();
  const double brick = kBrick * static_cast<double>(cellSize);
  GridSize size{{}, kBytesPerBrick, 0};
  for (int axis = 0; axis < 3; ++axis) {
    size.bricks[axis] = std::ceil((static_cast<double>(extent[axis]) + 2.0 * margin) / brick);
    size.bytes *= size.bricks[axis] + 1;
  }
  const double thickness = 2 * band + std::sqrt(3.0) * brick;
  size.probableFineBytes = kBytesPerFineBrick * mesh.area() * thickness / (brick * brick * brick);
  return size;
}

float largestCoordinate(const Aabb& box) {
  return std::max({std::abs(box.lo.x), std::abs(box.lo.y), std::abs(box.lo.z), std::abs(box.hi.x),
                   std::abs(box.hi.y), std::abs(box.hi.z)});
}

Error tooLarge(const TriangleMesh& mesh, float cellSize, float band, const std::string& what, double bytes,
               double max) {
  const auto gibibytes = [](double n) { return fmt::format("{:.3g} GiB", n / (std::int64_t{1} << 30)); };
  float larger = cellSize;
  GridSize size;
  do {
    larger *= 1.1f;
    size = sizeOfGrid(mesh, larger, band);
  } while (size.bytes > kMaxCoarseBytes || size.bytes + size.probableFineBytes > MeshSdf::kMaxBytes);
  return sceneError(
      fmt::format("with cells of {} m the signed distance grid of the mesh is too large: {}, {}", cellSize,
                  what, gibibytes(bytes)),
      fmt::format("at most {}", gibibytes(max)), fmt::format("try a cell_size of {:.2g} m or more", larger));
}

/// Origin, size and number of bricks of a grid around the mesh.
MeshSdfView layOut(const TriangleMesh& mesh, float cellSize, float band) {
  const Aabb box = mesh.bounds();
  const float furthest = largestCoordinate(box);
  constexpr float kSteps = 16;  // floats within a cell
  if (furthest * std::numeric_limits<float>::epsilon() * kSteps > cellSize)
    throw sceneError(
        fmt::format(
            "the mesh reaches {} m from the origin, where single precision cannot resolve its cells of "
            "{} m",
            furthest, cellSize),
        {}, "move the mesh closer to the origin, or set a larger cell_size");

  const GridSize size = sizeOfGrid(mesh, cellSize, band);
  if (size.bytes > kMaxCoarseBytes)
    throw tooLarge(mesh, cellSize, band,
                   fmt::format("it is {:.0f} × {:.0f} × {:.0f} bricks of {}³ cells", size.bricks.x,
                               size.bricks.y, size.bricks.z, kBrick),
                   size.bytes, kMaxCoarseBytes);
  MeshSdfView grid;
  grid.cellSize = cellSize;
  for (int axis = 0; axis < 3; ++axis) {
    grid.bricks[axis] = static_cast<int>(size.bricks[axis]);
    grid.origin[axis] = static_cast<float>(box.center()[axis] - 0.5 * kBrick * cellSize * size.bricks[axis]);
  }
  return grid;
}

/// Fills a grid with distances.
class Builder {
 public:
  Builder(HostThreads& threads, const TriangleMesh& mesh, bool closed, const MeshSdfView& grid, float band)
      : threads_(threads), query_(mesh), closed_(closed), grid_(grid), band_(band) {
    const float brick = kBrick * grid.cellSize;
    const Vec3f bricks{static_cast<float>(grid.bricks.x), static_cast<float>(grid.bricks.y),
                       static_cast<float>(grid.bricks.z)};
    rounding_ = 2 * std::numeric_limits<float>::epsilon() *
                largestCoordinate({grid.origin, grid.origin + brick * bricks});
    findCoarse();
    chooseBricks();
    checkSize(mesh);
    nodes.resize(static_cast<std::size_t>(fineBricks_.size()) * kBrickNodes);
    threads_.forEach(static_cast<std::int64_t>(fineBricks_.size()), [this](std::int64_t i) { fillBrick(i); });
  }

  bool hasInside() const {
    const auto negative = [](float d) { return d < 0; };
    return std::any_of(nodes.begin(), nodes.end(), negative) ||
           std::any_of(coarse.begin(), coarse.end(), negative);
  }

  std::vector<float> coarse, nodes;
  std::vector<int> brickIndex;

 private:
  /// Of the node that is that many cells from the origin of the grid.
  Vec3f position(const Vec3i& cells) const {
    const Vec3f c{static_cast<float>(cells.x), static_cast<float>(cells.y), static_cast<float>(cells.z)};
    return grid_.origin + grid_.cellSize * c;
  }

  /// A bit more than the distance, by more than the rounding of it and of two positions.
  float withSlack(float distance) const { return 1.0001f * distance + rounding_; }

  bool isInside(const Vec3f& p) const { return query_.windingNumber(p) > 0.5; }

  /// The signed distance of p, from values that are known `step` away from it. No surface is between the two
  /// where such a value exceeds the step, so the sign is the same if the mesh is closed. If it is not, the
  /// sign may change in a hole, far from all triangles.
  float distanceAt(const Vec3f& p, std::initializer_list<std::optional<float>> known, float step) const {
    float atMost = std::numeric_limits<float>::infinity();
    std::optional<bool> inside;
    for (const std::optional<float>& value : known) {
      if (!value) continue;
      atMost = std::min(atMost, withSlack(std::abs(*value) + step));
      if (closed_ && std::abs(*value) > withSlack(step)) inside = *value < 0;
    }
    const float distance = query_.closestDistance(p, atMost);
    return (inside ? *inside : isInside(p)) ? -distance : distance;
  }

  void findCoarse();
  void chooseBricks();
  void checkSize(const TriangleMesh& mesh) const;
  void fillBrick(std::int64_t index);

  HostThreads& threads_;
  MeshQuery query_;
  bool closed_;
  const MeshSdfView& grid_;
  float band_, rounding_;
  std::vector<Vec3i> fineBricks_;
};

void Builder::findCoarse() {
  const Vec3i count = grid_.bricks + Vec3i{1, 1, 1};
  coarse.resize(static_cast<std::size_t>(count.x) * count.y * count.z);
  threads_.forEach(static_cast<std::int64_t>(count.y) * count.z, [&](std::int64_t row) {
    const Vec3i at{0, static_cast<int>(row % count.y), static_cast<int>(row / count.y)};
    float* values = coarse.data() + row * count.x;
    std::optional<float> before;
    for (int x = 0; x < count.x; ++x)
      before = values[x] =
          distanceAt(position(kBrick * Vec3i{x, at.y, at.z}), {before}, kBrick * grid_.cellSize);
  });
}

void Builder::chooseBricks() {
  const Vec3i count = grid_.bricks;
  const float halfDiagonal = 0.5f * std::sqrt(3.0f) * kBrick * grid_.cellSize;
  const float reach = withSlack(band_ + halfDiagonal);
  brickIndex.assign(static_cast<std::size_t>(count.x) * count.y * count.z, -1);
  constexpr int kFine = 0;
  threads_.forEach(static_cast<std::int64_t>(count.y) * count.z, [&](std::int64_t row) {
    const int y = static_cast<int>(row % count.y), z = static_cast<int>(row / count.y);
    const float* corners = coarse.data() + (static_cast<std::int64_t>(z) * (count.y + 1) + y) * (count.x + 1);
    for (int x = 0; x < count.x; ++x) {
      // One corner often says that the centre is too far away.
      if (std::abs(corners[x]) > withSlack(reach + halfDiagonal)) continue;
      const Vec3f center = position(kBrick * Vec3i{x, y, z} + Vec3i{kBrick / 2, kBrick / 2, kBrick / 2});
      if (query_.closestDistance(center, reach) < reach) brickIndex[row * count.x + x] = kFine;
    }
  });
  for (std::size_t i = 0; i < brickIndex.size(); ++i) {
    if (brickIndex[i] != kFine) continue;
    brickIndex[i] = static_cast<int>(fineBricks_.size());
    const int row = static_cast<int>(i / count.x);
    fineBricks_.push_back({static_cast<int>(i % count.x), row % count.y, row / count.y});
  }
}

void Builder::checkSize(const TriangleMesh& mesh) const {
  const double bytes = static_cast<double>(fineBricks_.size()) * kBytesPerFineBrick +
                       static_cast<double>(coarse.size()) * kBytesPerBrick;
  if (bytes > MeshSdf::kMaxBytes)
    throw tooLarge(mesh, grid_.cellSize, band_,
                   fmt::format("{} bricks of {}³ cells are near its surface", fineBricks_.size(), kBrick),
                   bytes, MeshSdf::kMaxBytes);
}

void Builder::fillBrick(std::int64_t index) {
  const Vec3i first = kBrick * fineBricks_[index];
  float* values = nodes.data() + index * kBrickNodes;
  constexpr int kStrideY = kNodes, kStrideZ = kNodes * kNodes;
  for (int z = 0; z < kNodes; ++z)
    for (int y = 0; y < kNodes; ++y)
      for (int x = 0; x < kNodes; ++x) {
        float* value = values + z * kStrideZ + y * kStrideY + x;
        const auto before = [&](int i, int stride) {
          return i > 0 ? std::optional<float>(*(value - stride)) : std::nullopt;
        };
        *value = distanceAt(position(first + Vec3i{x, y, z}),
                            {before(x, 1), before(y, kStrideY), before(z, kStrideZ)}, grid_.cellSize);
      }
}

/// What a user should know of a mesh that was given as `original` and is used as `mesh`.
void warn(const TriangleMesh& original, const TriangleMesh& mesh, MeshDiagnosis diagnosis, bool hasInside,
          float cellSize, std::vector<std::string>& warnings) {
  if (const std::size_t dropped = original.triangles.size() - mesh.triangles.size(); dropped > 0)
    warnings.push_back(fmt::format(
        "{} triangles are left out: without area, duplicate, or with vertices that are NaN or infinite",
        dropped));
  if (!hasInside)
    warnings.push_back(fmt::format(
        "it has no inside: it is an open sheet, or thinner than its cells of {} m everywhere. Both "
        "its sides are outside, so that particles may pass through it",
        cellSize));
  else if (diagnosis.insideOut)
    warnings.push_back("it is inside out; its triangles were turned round");
  diagnosis.insideOut = false;
  if (!diagnosis.good())
    warnings.push_back(fmt::format(
        "it has {}{}", diagnosis.message(),
        diagnosis.openEdges > 0 ? "; holes count as closed, so what an open shell encloses is solid" : ""));
}

}  // namespace

MeshSdf::MeshSdf(Device& device, const TriangleMesh& original, float cellSize, float band,
                 std::vector<std::string>& warnings) {
  WEIR_CHECK(cellSize > 0);
  WEIR_CHECK(band >= 0);
  TriangleMesh mesh = cleaned(original);
  if (mesh.empty()) throw sceneError("the mesh has no triangles with an area", "one triangle or more");
  const MeshDiagnosis diagnosis = diagnose(mesh);
  if (diagnosis.insideOut) mesh.flip();

  layout_ = layOut(mesh, cellSize, band);
  HostThreads threads(device);
  const bool closed = diagnosis.closed() && diagnosis.inconsistentEdges == 0;
  const Builder built(threads, mesh, closed, layout_, band);
  warn(original, mesh, diagnosis, built.hasInside(), cellSize, warnings);

  coarse_ = Array<float>(device, built.coarse);
  nodes_ = Array<float>(device, built.nodes);
  brickIndex_ = Array<int>(device, built.brickIndex);
}

double MeshSdf::maxMemory(const TriangleMesh& mesh, float cellSize, float band) {
  if (mesh.empty()) return 0;
  const GridSize size = sizeOfGrid(mesh, cellSize, band);
  constexpr double kRough = 2, kFewBricks = 64;
  const double bricks = size.bricks.x * size.bricks.y * size.bricks.z;
  const double fine = std::min(bricks * kBytesPerFineBrick,
                               kRough * size.probableFineBytes + kFewBricks * kBytesPerFineBrick);
  return std::min(size.bytes + fine, static_cast<double>(kMaxBytes) + kMaxCoarseBytes);
}

MeshSdfView MeshSdf::view(bool inverted) const {
  MeshSdfView view = layout_;
  view.coarse = coarse_.data();
  view.brickIndex = brickIndex_.data();
  view.nodes = nodes_.data();
  view.inverted = inverted;
  return view;
}

}  // namespace weir
