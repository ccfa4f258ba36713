// Cubic lattices of particles that fill a region at rest.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "framework/base/api.h"
#include "framework/base/vec.h"

namespace WEIR_API weir {

/// Nodes at first + spacing·(i, j, k); or as many as are to fill a box, in rows along x.
struct Lattice {
  /// The box is divided into count.y × count.z rows. A row has floor(nodes/rows) or one more, spread evenly
  /// over the box's length, and the longer rows are spread evenly among the others.
  struct Rows {
    Vec3d low, size;  // m
    std::int64_t nodes = 0;
  };

  Vec3d first;
  double spacing = 0;        ///< m
  Vec3<std::int64_t> count;  ///< along x that of the longest row
  std::optional<Rows> rows{};

  /// Centred in the box, with size/spacing nodes along each axis, rounded, but at least one. In a box whose
  /// sides are whole multiples of the spacing, the outer nodes are half a spacing from the faces; no node of
  /// the lattice's endless continuation is in the box but these. Throws a scene Error for more than
  /// kMaxNodes nodes for each of so many ranks.
  static Lattice inBox(const Aabb& box, float spacing, int ranks = 1);
  /// With as many nodes as the box has cubes of the spacing: inBox(), where that has as many within kExact
  /// and where a side is shorter than three spacings; elsewhere rows. Throws as inBox().
  static Lattice filling(const Aabb& box, float spacing, int ranks = 1);
  /// With a node at `center` along each axis, or where `between` says so the middle of two; none is farther
  /// than `reach` from it along an axis. Throws as inBox().
  static Lattice around(const Vec3f& center, float reach, float spacing, const Vec3<bool>& between = {},
                        int ranks = 1);

  static constexpr double kExact = 0.01;  // of the volume that nodes are to fill

  static constexpr double kMaxNodes = 2147483647;  // particles of a rank are counted by ints

  std::int64_t size() const { return rows ? rows->nodes : count.x * count.y * count.z; }
};

struct Jitter {
  float share = 0;  ///< of the spacing: how far a node is moved at most along each axis
  std::uint64_t seed = 0;
};

/// How far the particle of node (x, y, z) is from it, in spacings.
using Displacement = std::function<Vec3f(std::int64_t x, std::int64_t y, std::int64_t z)>;

/// Nodes in their order are cut into chunks, which several may take by turns: this is number `turn` of so
/// many.
struct LatticeShare {
  static constexpr std::int64_t kChunk = 16384;  // nodes

  std::int64_t turn = 0, turns = 1;

  /// How many chunks of so many nodes it takes.
  std::int64_t chunksOf(std::int64_t nodes) const {
    const std::int64_t all = (nodes + kChunk - 1) / kChunk;
    return (all + turns - 1 - turn) / turns;
  }
};

/// Of each chunk of a share.
using LatticePoints = std::vector<std::vector<Vec3f>>;

/// The nodes of the share, each moved by its jitter, that `inside` accepts (all without it), x running
/// fastest. `inside` is called from `threads` threads (0 is one for every core); the result is the same for
/// any number. With a displacement the nodes decide what is inside, and their particles may be outside.
LatticePoints sampleLattice(const Lattice& lattice, const LatticeShare& share, const Jitter& jitter,
                            int threads, const std::function<bool(const Vec3f&)>& inside = {},
                            const Displacement& displacement = {});

}  // namespace weir
