#include "nodes/emitters/circle_emitter.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <tuple>

namespace weir {

namespace {

/// A node of the lattice, in half spacings, so that lattices about a node and about the middle of four nodes
/// both have whole coordinates.
struct LatticeNode {
  std::int64_t x, z;

  std::int64_t radiusSquared() const { return x * x + z * z; }
  /// Nodes at the same distance come in pairs that face each other, so that a ring that is not used up stays
  /// balanced.
  auto key() const {
    const bool upper = std::pair(x, z) > std::pair(-x, -z);
    return std::tuple(radiusSquared(), upper ? x : -x, upper ? z : -z, upper);
  }
};

/// The `count` nodes nearest to the centre; `parity` 0 has a node there, 1 the middle of four nodes.
std::vector<LatticeNode> nearestNodes(std::int64_t parity, std::size_t count, double radius) {
  const auto reach = static_cast<std::int64_t>(2 * radius) + 4;
  std::vector<LatticeNode> nodes;
  for (std::int64_t z = -reach; z <= reach; ++z)
    for (std::int64_t x = -reach; x <= reach; ++x)
      if ((x & 1) == parity && (z & 1) == parity && x * x + z * z <= reach * reach) nodes.push_back({x, z});
  std::sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.key() < b.key(); });
  nodes.resize(count);
  return nodes;
}

}  // namespace

double CircleEmitter::area() const {
  return std::numbers::pi * double(radius) * radius;
}

double CircleEmitter::layerSize(float spacing) const {
  return std::max(1.0, std::round(area() / (double(spacing) * spacing)));
}

Emitter::Layer CircleEmitter::makeLayer(const SetupContext& context, float spacing) const {
  const auto count = static_cast<std::size_t>(layerSize(spacing));
  // Of the two centred lattices the rounder one: its outermost node is nearer to the centre.
  std::vector<LatticeNode> nodes = nearestNodes(0, count, double(radius) / spacing);
  std::vector<LatticeNode> other = nearestNodes(1, count, double(radius) / spacing);
  if (other.back().radiusSquared() < nodes.back().radiusSquared()) nodes.swap(other);
  std::vector<Vec3f> points;
  for (const LatticeNode& node : nodes)
    points.push_back(
        {0.5f * spacing * static_cast<float>(node.x), 0, 0.5f * spacing * static_cast<float>(node.z)});
  return layersOf(context, points);
}

}  // namespace weir
