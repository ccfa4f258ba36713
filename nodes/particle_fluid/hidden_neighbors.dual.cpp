#include "nodes/particle_fluid/hidden_neighbors.h"

#include "framework/compute/parallel_uneven.h"
#include "framework/geometry/segment_hit.h"
#include "framework/particles/divided_particles.h"
#include "nodes/particle_fluid/wall_field.h"

namespace weir {

namespace {

/// Whether the way between two particles leads through a thin part of a solid, see the header.
class Passage {
 public:
  WEIR_HD Passage(const SolidView& solid, const Vec3f& p, const Vec3f& q) {
    const TriangleTreeView& tree = solid.tree;
    forEachHit(tree, solid.end.toBody(p), solid.end.toBody(q), [&](const SegmentHit& hit) {
      const bool front = dot(tree.normals[hit.triangle].normals[PseudoNormals::kFace], hit.normal) > 0;
      return add({hit.normal, hit.fraction, front == (solid.kind != SolidKind::kContainer)});
    });
    // One end is within the solid.
    if (count_ > 0 && (enters_ == 0 || enters_ == count_)) blocked_ = true;
  }
  WEIR_HD bool isBlocked() const { return blocked_; }

 private:
  static constexpr int kMax = 8;             // more triangles do block
  static constexpr float kMinCosine = 0.9f;  // of the front and the back of a thin part

  struct Crossing {
    Vec3f against;  // the triangle's normal, against the segment
    double fraction;
    bool enters;
  };

  /// Whether there is need to go on.
  WEIR_HD bool add(const Crossing& crossing) {
    for (int k = 0; k < count_ && !blocked_; ++k) {
      const Crossing& other = crossings_[k];
      if (other.enters == crossing.enters) continue;
      const Crossing &in = crossing.enters ? crossing : other, &out = crossing.enters ? other : crossing;
      blocked_ = in.fraction <= out.fraction && dot(in.against, out.against) > kMinCosine;
    }
    if (count_ == kMax) blocked_ = true;
    if (blocked_) return false;
    crossings_[count_++] = crossing;
    enters_ += crossing.enters;
    return true;
  }

  Crossing crossings_[kMax];
  int count_ = 0, enters_ = 0;
  bool blocked_ = false;
};

/// What each particle sees of each solid, two bits for each solid, so that ranks can tell each other.
struct SeenByAll {
  static constexpr int kInWord = 16;  // solids
  ArrayView<std::uint32_t> words;     // empty where one rank has all particles
  int wordsInOne = 0;

  WEIR_HD int at(std::int64_t i, int k) const {
    return static_cast<int>(words[i * wordsInOne + k / kInWord] >> (2 * (k % kInWord)) & 3u);
  }
  WEIR_HD void set(std::int64_t i, int k, int sides) const {
    words[i * wordsInOne + k / kInWord] |= static_cast<std::uint32_t>(sides) << (2 * (k % kInWord));
  }
};

struct WriteSeen {
  SolidPairsView pairs;
  ArrayView<const int> near, sides;
  SeenByAll seen;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = near[n];
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) seen.set(i, pairs.solid[pair], sides[pair]);
  }
};

struct TakeOutHidden {
  ArrayView<const SolidView> solids;
  SolidPairsView pairs;
  ArrayView<const int> near, sides;  // of pairs
  ImageOwners ownerOf;
  ArrayView<const Vec3f> positions;
  NeighborEditor neighbors;
  // Of several ranks, whose indices are their own.
  SeenByAll seenByAll;
  ArrayView<const std::int64_t> ids;

  WEIR_HD void operator()(std::int64_t n, const Team& team) const {
    const int i = near[n];
    bool any = false;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int seen = sides[pair];
      any =
          any || (solids[pairs.solid[pair]].kind == SolidKind::kSheet ? seen != 0 : (seen & kSeesBack) != 0);
    }
    if (any) neighbors.keepIf(i, team, [&](int j) { return sees(i, j); });
  }

  WEIR_HD bool sees(std::int64_t i, std::int64_t j) const {
    const std::int64_t owner = ownerOf(j);
    const bool forth = ids.size > 0 ? ids[i] < ids[j] : i < owner;
    const std::int64_t from = forth ? i : j, to = forth ? j : i;
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      const int k = pairs.solid[pair];
      const SolidView& solid = solids[k];
      if (mayHide(solid.kind, sides[pair], seenBy(owner, k)) && hides(solid, positions[from], positions[to]))
        return false;
    }
    return true;
  }

  WEIR_HD int seenBy(std::int64_t j, int k) const {
    if (seenByAll.words.size > 0) return seenByAll.at(j, k);
    const int pair = pairs.find(j, k);
    return pair < 0 ? 0 : sides[pair];
  }

  WEIR_HD static bool hides(const SolidView& solid, const Vec3f& p, const Vec3f& q) {
    if (solid.kind != SolidKind::kSheet) return Passage(solid, p, q).isBlocked();
    return firstHit(solid.tree, solid.end.toBody(p), solid.end.toBody(q)).found();
  }

  WEIR_HD static bool mayHide(SolidKind kind, int one, int other) {
    if (kind != SolidKind::kSheet) return (one & other & kSeesBack) != 0;
    return ((one & kSeesFront) != 0 && (other & kSeesBack) != 0) ||
           ((one & kSeesBack) != 0 && (other & kSeesFront) != 0);
  }
};

}  // namespace

template <class Backend>
void takeOutHiddenNeighbors(Backend& device, FluidStep& fluid) {
  WallField& walls = fluid.walls;
  const ArrayView<const int> near = walls.pairs.near(), sides = std::as_const(walls.sides).view();
  Array<std::uint32_t> words(fluid.device);
  SeenByAll seen;
  ArrayView<const std::int64_t> ids;
  if (fluid.divided != nullptr) {
    fluid.exchange({"position"});
    seen.wordsInOne = static_cast<int>(walls.views.size() - 1) / SeenByAll::kInWord + 1;
    words.resize(fluid.particles.capacity() * seen.wordsInOne);
    words.fillZero();
    seen.words = words.view();
    parallelForUneven(device, "seen sides", walls.pairs.nearCount(),
                      WriteSeen{walls.pairs.view(), near, sides, seen});
    fluid.divided->refreshWords(seen.words, seen.wordsInOne);
    ids = fluid.particles.ids().read();
  }
  constexpr TeamPlan kPlan{16, 1 << 17};
  parallelForUneven<kPlan>(
      device, "hidden neighbours", walls.pairs.nearCount(),
      TakeOutHidden{.solids = walls.views.view(),
                    .pairs = walls.pairs.view(),
                    .near = near,
                    .sides = sides,
                    .ownerOf = fluid.images != nullptr ? fluid.images->owners() : ImageOwners{},
                    .positions = fluid.particles.positions().read(),
                    .neighbors = fluid.neighbors.editor(),
                    .seenByAll = seen,
                    .ids = ids});
}

template void takeOutHiddenNeighbors(ThisBackend&, FluidStep&);

}  // namespace weir
