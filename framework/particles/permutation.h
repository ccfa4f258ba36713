// Particles go into another order: what ParticleSet::permute and the sort by cells share.
#pragma once

#include <utility>
#include <vector>

#include "framework/compute/wide_access.h"
#include "framework/particles/attribute_storage.h"
#include "framework/particles/fine_cell.h"
#include "framework/particles/particle_set.h"

namespace weir::detail {

/// Moves several attributes at once, so that the order is read but once.
struct Permute {
  static constexpr int kMax = 8;  // columns in one launch
  static constexpr int kWordsOfVector = 3, kWordsOfLong = 2;

  ArrayView<const int> order;
  PermutedColumn columns[kMax];
  int used = 0;
  float inverseCellSize = 0;  // for `fine`
  // Where particles are to move on their way; `position` and `velocity` are columns, or none.
  ParticleSet::PendingMotion unmoved;
  int position = -1, velocity = -1;
  // Where the columns have positions, those in their new order, if anybody wants them.
  FineCell* fine = nullptr;

  WEIR_HD void operator()(std::int64_t k) const { (*this)(k, order[k]); }

  /// Particle i becomes particle k.
  WEIR_HD void operator()(std::int64_t k, std::int64_t i) const {
    const bool moves = unmoved.motion.dt != 0;
    for (int c = 0; c < used; ++c) {
      const PermutedColumn& column = columns[c];
      if (column.words == 1) {
        column.to[k] = column.from[i];
        continue;
      }
      if (column.words == kWordsOfLong) {
        reinterpret_cast<std::uint64_t*>(column.to)[k] =
            reinterpret_cast<const std::uint64_t*>(column.from)[i];
        continue;
      }
      if (column.words != kWordsOfVector) {
        copyWords(column, k, i);
        continue;
      }
      const Vec3f value = moves && (c == position || c == velocity)
                              ? moved(i, c)
                              : loadInTwo(reinterpret_cast<const Vec3f*>(column.from)[i]);
      storeInTwo(reinterpret_cast<Vec3f*>(column.to)[k], value);
      if (c == position && fine != nullptr) fine[k] = FineCell::of(value, inverseCellSize);
    }
  }

  WEIR_HD static void copyWords(const PermutedColumn& column, std::int64_t k, std::int64_t i) {
    const int words = column.words;
    for (int word = 0; word < words; ++word) column.to[k * words + word] = column.from[i * words + word];
  }

  WEIR_HD Vec3f moved(std::int64_t i, int c) const {
    const Vec3f v = unmoved.motion.velocity(loadInTwo(unmoved.velocities[i]));
    return c == velocity ? v : unmoved.motion.position(loadInTwo(unmoved.positions[i]), v);
  }
};

/// All attributes, in as many launches as it takes: next() says what one of them does, finish() comes after
/// it.
class Permutation {
 public:
  explicit Permutation(ParticleSet& particles);

  bool isLeft() const { return !left_.empty(); }
  Permute next(ArrayView<const int> order);
  void finish();

 private:
  ParticleSet& particles_;
  std::vector<AttributeStorage*> left_;
  std::vector<std::pair<AttributeStorage*, std::size_t>> begun_;
};

}  // namespace weir::detail
