#include "framework/geometry/triangle_tree.h"

#include "framework/geometry/box_blocks.h"
#include "framework/graph/memory_estimate.h"

namespace weir {

TriangleTree::TriangleTree() = default;
TriangleTree::TriangleTree(TriangleTree&&) noexcept = default;
TriangleTree& TriangleTree::operator=(TriangleTree&&) noexcept = default;
TriangleTree::~TriangleTree() = default;

TriangleTree::TriangleTree(Device& device, const TriangleMesh& mesh) {
  const BoxTree tree = buildBoxTree(mesh);
  if (tree.nodes.empty()) return;
  bounds_ = tree.nodes.front().box;
  std::vector<detail::TreeNode> nodes;
  nodes.reserve(tree.nodes.size());
  for (const BoxTree::Node& node : tree.nodes) {
    const int link = node.child > 0 ? node.child : node.first - node.last;
    nodes.push_back({node.box.lo, link, node.box.hi, node.first});
  }
  std::vector<detail::TreeTriangle> triangles;
  triangles.reserve(tree.order.size());
  const std::vector<PseudoNormals> normalsOfMesh = pseudoNormals(mesh);
  std::vector<PseudoNormals> normals;
  normals.reserve(tree.order.size());
  for (const int i : tree.order) {
    normals.push_back(normalsOfMesh[i]);
    const Vec3i& t = mesh.triangles[i];
    triangles.push_back({mesh.vertices[t.x], mesh.vertices[t.y], mesh.vertices[t.z]});
  }
  nodes_ = Array<detail::TreeNode>(device, nodes);
  triangles_ = Array<detail::TreeTriangle>(device, triangles);
  normals_ = Array<PseudoNormals>(device, normals);
  indices_ = Array<int>(device, tree.order);
  if (device.kind() != DeviceKind::kCpu) return;
  std::vector<Aabb> boxes;
  boxes.reserve(triangles.size());
  for (const detail::TreeTriangle& t : triangles)
    boxes.push_back({min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c)});
  blocks_ = std::make_unique<BoxBlocks>(device, boxes);
}

double TriangleTree::maxMemory(std::size_t triangles) {
  // A leaf holds one triangle or more, and a tree of n leaves has 2·n − 1 nodes.
  const auto count = static_cast<double>(triangles);
  return bytesOfArray(2 * count, sizeof(detail::TreeNode)) +
         bytesOfArray(count, sizeof(detail::TreeTriangle)) + bytesOfArray(count, sizeof(PseudoNormals)) +
         bytesOfArray(count, sizeof(int)) + BoxBlocks::maxMemory(triangles);
}

TriangleTreeView TriangleTree::view() const {
  return {nodes_.view(), triangles_.view(), normals_.view(), indices_.view(), bounds_, blocks_.get()};
}

}  // namespace weir
