#include "python/src/walls.h"

#include <nanobind/stl/string.h>

#include <algorithm>

#include "python/src/node_outputs.h"
#include "python/src/numpy_arrays.h"

namespace weir::python {

Walls::Walls(std::shared_ptr<Device> device, const Boundary& boundary)
    : device_(std::move(device)), meshes_(boundary.meshes), pieces_(boundary.pieces) {
  if (device_->kind() == DeviceKind::kCpu) return;
  for (BoundaryPiece& piece : pieces_)
    if (piece.isMesh) copyToHost(piece.mesh);
}

void Walls::copyToHost(MeshSdfView& mesh) {
  const auto download = [&]<class T>(const T* from, std::size_t count) {
    std::vector<T> values(count);
    if (count > 0) device_->download(values.data(), from, count * sizeof(T));
    return values;
  };
  const auto product = [](const Vec3i& n) { return std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z); };
  constexpr int kNodes = MeshSdfView::kNodes;
  auto grid = std::make_unique<HostGrid>();
  grid->coarse = download(mesh.coarse, product({mesh.bricks.x + 1, mesh.bricks.y + 1, mesh.bricks.z + 1}));
  grid->brickIndex = download(mesh.brickIndex, product(mesh.bricks));
  const int last = grid->brickIndex.empty() ? -1 : *std::ranges::max_element(grid->brickIndex);
  grid->nodes = download(mesh.nodes, std::size_t(last + 1) * kNodes * kNodes * kNodes);
  mesh.coarse = grid->coarse.data();
  mesh.brickIndex = grid->brickIndex.data();
  mesh.nodes = grid->nodes.data();
  grids_.push_back(std::move(grid));
}

nb::tuple Walls::query(nb::handle at) const {
  const auto points = fromNumpy<Vec3f>(at);
  const BoundaryView view{pieces_.data(), static_cast<int>(pieces_.size()),
                          pieces_.empty() ? BoundaryPiece{} : pieces_.front()};
  std::vector<float> distances;
  std::vector<Vec3f> normals;
  for (const Vec3f& point : points) {
    const BoundaryHit hit = boundaryQuery(view, point);
    distances.push_back(hit.distance);
    normals.push_back(hit.normal);
  }
  return nb::make_tuple(toNumpy(std::move(distances)), toNumpy(std::move(normals)));
}

Walls wallsOf(const PythonScene& scene, const std::string& node, const std::string& output) {
  const OutputPort* found = readyNode(scene, node).findOutput(output);
  WEIR_CHECK(found != nullptr);
  WEIR_CHECK(found->typeName() == Boundary::kPortType);
  return {scene.device(), *static_cast<const Output<Boundary>&>(*found)};
}

void bindWalls(nb::module_& m) {
  nb::class_<Walls>(m, "Walls", "What weir.Walls is made of.")
      .def("query", &Walls::query, nb::arg("points"),
           nb::sig("def query(self, points: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]"));
}

}  // namespace weir::python
