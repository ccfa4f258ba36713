#include "nodes/geometry/triangle_tree.h"

#include "framework/graph/memory_estimate.h"

namespace weir {

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
}

double TriangleTree::mostMemory(std::size_t triangles) {
  // A leaf holds one triangle or more, and a tree of n leaves has 2·n − 1 nodes.
  const auto count = static_cast<double>(triangles);
  return bytesOfArray(2 * count, sizeof(detail::TreeNode)) +
         bytesOfArray(count, sizeof(detail::TreeTriangle)) + bytesOfArray(count, sizeof(PseudoNormals)) +
         bytesOfArray(count, sizeof(int));
}

TriangleTreeView TriangleTree::view() const {
  return {nodes_.view(), triangles_.view(), normals_.view(), indices_.view(), bounds_};
}

}  // namespace weir
