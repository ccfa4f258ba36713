#include "framework/geometry/box_tree.h"

#include <algorithm>

#include "framework/base/check.h"

namespace weir {

namespace {

constexpr int kSetApart = 24;  // how often on the way to a leaf large triangles may be set apart

struct Item {
  Vec3f middle;  // of the triangle's box
  float size;    // longest side of the box
  int triangle;
};

float longest(const Vec3f& size) {
  return std::max({size.x, size.y, size.z});
}

class Builder {
 public:
  Builder(const TriangleMesh& mesh, BoxTree& tree) : mesh_(mesh), tree_(tree) {
    items_.reserve(mesh.triangles.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const Aabb box = boxOf(static_cast<int>(i));
      items_.push_back({box.center(), longest(box.size()), static_cast<int>(i)});
    }
    const int count = static_cast<int>(items_.size());
    tree_.nodes.reserve(items_.size());
    tree_.nodes.push_back({.first = 0, .last = count});
    split(0, 0, 0);
    for (const Item& item : items_) tree_.order.push_back(item.triangle);
  }

 private:
  Aabb boxOf(int triangle) const {
    Aabb box;
    for (int k = 0; k < 3; ++k) box.extend(mesh_.vertices[mesh_.triangles[triangle][k]]);
    return box;
  }

  void split(int node, int depth, int setApart) {
    WEIR_CHECK(depth <= BoxTree::kDepth);
    const auto [none, first, last, unset] = tree_.nodes[node];
    if (last - first <= BoxTree::kLeaf) {
      Aabb box;
      for (int i = first; i < last; ++i) box.extend(boxOf(items_[i].triangle));
      tree_.nodes[node].box = box;
      return;
    }
    const int firstSmall = setApart < kSetApart ? setLargeApart(first, last) : first;
    const bool apart = firstSmall > first;
    const int middle = apart ? firstSmall : halve(first, last);
    const int child = static_cast<int>(tree_.nodes.size());
    tree_.nodes[node].child = child;
    tree_.nodes.push_back({.first = first, .last = middle});
    tree_.nodes.push_back({.first = middle, .last = last});
    split(child, depth + 1, setApart + apart);
    split(child + 1, depth + 1, setApart + apart);
    Aabb box = tree_.nodes[child].box;
    box.extend(tree_.nodes[child + 1].box);
    tree_.nodes[node].box = box;
  }

  /// Puts the triangles that are longer than half of where the middles lie and of the longest triangle in
  /// front, if they are few. Returns the first of the others, or `first` if there is nothing to set apart.
  int setLargeApart(int first, int last) {
    Aabb middles;
    float largest = 0;
    for (int i = first; i < last; ++i) {
      middles.extend(items_[i].middle);
      largest = std::max(largest, items_[i].size);
    }
    const float limit = 0.5f * std::max(longest(middles.size()), largest);
    const auto isLarge = [&](const Item& item) { return item.size > limit; };
    const auto begin = items_.begin() + first, end = items_.begin() + last;
    const auto large = std::count_if(begin, end, isLarge);
    if (large == 0 || large > (last - first) / 4) return first;
    return static_cast<int>(std::stable_partition(begin, end, isLarge) - items_.begin());
  }

  int halve(int first, int last) {
    Aabb middles;
    for (int i = first; i < last; ++i) middles.extend(items_[i].middle);
    const Vec3f size = middles.size();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const int middle = first + (last - first) / 2;
    std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last,
                     [axis](const Item& a, const Item& b) {
                       const float x = a.middle[axis], y = b.middle[axis];
                       return x < y || (x == y && a.triangle < b.triangle);
                     });
    return middle;
  }

  const TriangleMesh& mesh_;
  BoxTree& tree_;
  std::vector<Item> items_;
};

}  // namespace

BoxTree buildBoxTree(const TriangleMesh& mesh) {
  BoxTree tree;
  if (mesh.empty()) return tree;
  const int vertices = static_cast<int>(mesh.vertices.size());
  for (const Vec3i& t : mesh.triangles) {
    WEIR_CHECK(std::min({t.x, t.y, t.z}) >= 0);
    WEIR_CHECK(std::max({t.x, t.y, t.z}) < vertices);
    for (int k = 0; k < 3; ++k) WEIR_CHECK(isFinite(mesh.vertices[t[k]]));
  }
  const Builder builder(mesh, tree);
  return tree;
}

}  // namespace weir
