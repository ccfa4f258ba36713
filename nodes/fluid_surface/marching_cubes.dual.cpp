#include "nodes/fluid_surface/marching_cubes.h"

namespace weir {

namespace {

constexpr float kMinShare = 0.01f;  // of an edge, between a vertex and its ends

WEIR_HD Vec3i cornerAt(const Vec3i& node, int corner) {
  return {node.x + (corner & 1), node.y + (corner >> 1 & 1), node.z + (corner >> 2)};
}

/// What is inside, and what follows from it.
struct Signs {
  GridView grid;
  float level;

  WEIR_HD bool inside(std::int64_t block, const Vec3i& c) const { return grid.value(block, c) > level; }
  /// Bit k: whether the surface crosses the edge from the node along axis k.
  WEIR_HD int crossings(std::int64_t block, const Vec3i& c) const {
    const bool here = inside(block, c);
    int bits = 0;
    for (int axis = 0; axis < 3; ++axis) bits |= (inside(block, cornerAt(c, 1 << axis)) != here) << axis;
    return bits;
  }
  WEIR_HD int cubeCase(std::int64_t block, const Vec3i& c) const {
    int bits = 0;
    for (int corner = 0; corner < 8; ++corner) bits |= inside(block, cornerAt(c, corner)) << corner;
    return bits;
  }
};

struct CountNode {
  Signs signs;
  const CubeTable* table;
  ArrayView<int> vertices, triangles;

  WEIR_HD void operator()(std::int64_t n) const {
    const bool last = n == vertices.size - 1;  // beyond the nodes
    const std::int64_t block = n / BlockKey::kNodes;
    const Vec3i c = GridView::coordinates(static_cast<int>(n % BlockKey::kNodes));
    const int cubeCase = last ? 0 : signs.cubeCase(block, c);
    const int here = cubeCase & 1;
    // The case's corners 1, 2 and 4 are the other ends of the node's own edges.
    vertices[n] =
        ((cubeCase >> 1 & 1) != here) + ((cubeCase >> 2 & 1) != here) + ((cubeCase >> 4 & 1) != here);
    triangles[n] = table->triangles[cubeCase];
  }
};

struct TakeTotals {
  ArrayView<const int> vertices, triangles;
  int* totals;
  WEIR_HD void operator()(std::int64_t) const {
    totals[0] = vertices[vertices.size - 1];
    totals[1] = triangles[triangles.size - 1];
  }
};

struct PlaceVertices {
  Signs signs;
  ArrayView<const std::uint64_t> keys;
  ArrayView<const int> first;
  ArrayView<Vec3f> vertices, normals;

  WEIR_HD void operator()(std::int64_t n) const {
    int at = first[n];
    if (first[n + 1] == at) return;
    const std::int64_t block = n / BlockKey::kNodes;
    const Vec3i c = GridView::coordinates(static_cast<int>(n % BlockKey::kNodes));
    const int crossed = signs.crossings(block, c);
    for (int axis = 0; axis < 3; ++axis)
      if ((crossed >> axis & 1) != 0) place(at++, block, c, axis);
  }

 private:
  WEIR_HD void place(int at, std::int64_t block, const Vec3i& c, int axis) const {
    const GridView& grid = signs.grid;
    const Vec3i other = cornerAt(c, 1 << axis);
    const float here = grid.value(block, c), there = grid.value(block, other);
    float share = (signs.level - here) / (there - here);
    share = share > kMinShare ? (share < 1 - kMinShare ? share : 1 - kMinShare) : kMinShare;
    const Vec3i corner = BlockKey::coordinates(keys[block]);
    Vec3f p{coordinate(corner.x, c.x), coordinate(corner.y, c.y), coordinate(corner.z, c.z)};
    p[axis] += share;
    vertices[at] = grid.cellSize * p;
    const Vec3f uphill = (1 - share) * grid.gradient(block, c) + share * grid.gradient(block, other);
    normals[at] = outwards(uphill, axis, there < here);
  }
  WEIR_HD static float coordinate(int block, int node) {
    return static_cast<float>(block * BlockKey::kSide + node);
  }
  /// Where the field is even the normal goes along the edge.
  WEIR_HD static Vec3f outwards(const Vec3f& uphill, int axis, bool forwards) {
    const Vec3f normal = normalized(-uphill);
    if (dot(normal, normal) > 0.5f) return normal;
    Vec3f along;
    along[axis] = forwards ? 1.0f : -1.0f;
    return along;
  }
};

struct PlaceTriangles {
  Signs signs;
  const CubeTable* table;
  ArrayView<const int> firstVertex, firstTriangle;
  ArrayView<Vec3i> triangles;

  WEIR_HD void operator()(std::int64_t n) const {
    const int first = firstTriangle[n];
    if (firstTriangle[n + 1] == first) return;
    const std::int64_t block = n / BlockKey::kNodes;
    const Vec3i c = GridView::coordinates(static_cast<int>(n % BlockKey::kNodes));
    const int cubeCase = signs.cubeCase(block, c);
    const unsigned char* edges = table->edges[cubeCase].data();
    for (int t = 0; t < table->triangles[cubeCase]; ++t, edges += 3)
      triangles[first + t] = {vertexOn(block, c, edges[0]), vertexOn(block, c, edges[1]),
                              vertexOn(block, c, edges[2])};
  }

 private:
  WEIR_HD int vertexOn(std::int64_t block, const Vec3i& cell, int edge) const {
    const Vec3i c = cornerAt(cell, edge / 3);
    const int before = (1 << edge % 3) - 1;
    // One end of the edge is above the level, so the node has a block.
    return firstVertex[signs.grid.node(block, c)] + countBits(signs.crossings(block, c) & before);
  }
};

}  // namespace

template <class Backend>
void MarchingCubes::countOn(Backend& device, const SparseGrid& grid, float level) {
  const std::int64_t nodes = vertices_.size();
  parallelFor(device, "surface count", nodes,
              CountNode{{grid.view(), level}, table_.data(), vertices_.view(), triangles_.view()});
  exclusiveScan(device, std::as_const(vertices_).view(), vertices_.view(), nodes);
  exclusiveScan(device, std::as_const(triangles_).view(), triangles_.view(), nodes);
  parallelFor(device, "surface totals", 1,
              TakeTotals{std::as_const(vertices_).view(), std::as_const(triangles_).view(), totals_.data()});
}

template <class Backend>
void MarchingCubes::placeOn(Backend& device, const SparseGrid& grid, float level, DynamicMesh& mesh) {
  const Signs signs{grid.view(), level};
  const std::int64_t nodes = vertices_.size() - 1;
  parallelFor(device, "surface vertices", nodes,
              PlaceVertices{signs, grid.view().keys, std::as_const(vertices_).view(), mesh.vertices.view(),
                            mesh.normals.view()});
  parallelFor(device, "surface triangles", nodes,
              PlaceTriangles{signs, table_.data(), std::as_const(vertices_).view(),
                             std::as_const(triangles_).view(), mesh.triangles.view()});
}

template void MarchingCubes::countOn(ThisBackend&, const SparseGrid&, float);
template void MarchingCubes::placeOn(ThisBackend&, const SparseGrid&, float, DynamicMesh&);

}  // namespace weir
