// Pairs of a particle and a solid near it. Most particles are near none, and hardly any is near many: so what
// is known of pairs stands in lists, and takes memory by their number, not by particles × solids.
#pragma once

#include <cstdint>
#include <optional>

#include "framework/base/api.h"
#include "framework/compute/compact_once.h"
#include "framework/compute/key_lists.h"
#include "framework/compute/parallel_uneven.h"
#include "framework/compute/readback.h"
#include "framework/solids/solid_grid.h"

namespace WEIR_API weir {

/// For kernels. The pairs of particle i are begin(i) … end(i) − 1, in the order of their solids.
struct SolidPairsView {
  ArrayView<const int> first, count;  ///< of each particle
  ArrayView<const int> solid;         ///< of each pair

  WEIR_HD int begin(std::int64_t i) const { return first[i]; }
  WEIR_HD int end(std::int64_t i) const { return first[i] + count[i]; }
  /// That of particle i and solid k; -1 if they are not near each other.
  WEIR_HD int find(std::int64_t i, int k) const {
    for (int pair = begin(i); pair < end(i); ++pair)
      if (solid[pair] == k) return pair;
    return -1;
  }
};

/// Finds them.
class SolidPairs {
 public:
  explicit SolidPairs(Device& device);

  /// Of the particles and the solids, as these stand at the end of the step, that may be within `reach` m of
  /// each other. On a GPU the host does not wait for their number: it has room for two pairs of each
  /// particle, or for twice as many as there were when it waited.
  template <class Backend>
  void find(Backend& device, Count particles, ArrayView<const SolidView> solids, const SolidGridView& grid,
            ArrayView<const Vec3f> positions, float reach);
  /// Lets the next find() wait.
  void waitForNumber() { waits_ = true; }

  /// The particles that are near any solid, in their order.
  ArrayView<const int> near() const { return near_.view(); }
  Count nearCount() const { return {near_.size(), nearCounter_.data()}; }
  SolidPairsView view() const { return {first_.view(), count_.view(), solid_.view()}; }
  /// The places n in near() of the particles at each solid; empty where there are few solids.
  KeyListsView bySolid() const { return bySolid_.view(); }
  /// Pairs that there is room for; what somebody knows of each needs as much.
  std::int64_t room() const { return solid_.size(); }

  /// Pairs for which there was no room, since the beginning; not on the CPU. Waits for the device.
  std::int64_t lostOnHost() const { return lost_.toHost().front(); }
  /// Bytes for that many particles and solids, and for two pairs of each particle with that many bytes of
  /// somebody else's.
  double memoryFor(double particles, int solids, std::size_t bytesOfPair) const;

 private:
  static constexpr std::int64_t kUsual = 2;  // pairs of a particle; a mean

  void makeRoom(std::int64_t particles, std::int64_t solids);
  template <class Backend>
  void listBySolid(Backend& device, std::int64_t solids);

  Array<int> count_, first_;  // one more than particles, so that the last is their number
  Array<int> solid_;
  Array<std::uint8_t> marks_;  // scratch
  Array<int> near_, nearCounter_;
  Array<int> lost_;
  KeyLists bySolid_;
  std::optional<Readback<int>> number_;
  std::int64_t wanted_ = 0;  // room that was called for; on the CPU the number of pairs
  bool waits_ = true;
};

namespace detail {

struct SolidsInReach {
  ArrayView<const SolidView> solids;
  SolidGridView grid;
  ArrayView<const Vec3f> positions;
  float reach;

  /// Calls f(k) for each that is near particle i.
  template <class F>
  WEIR_HD void forEach(std::int64_t i, F&& f) const {
    const Vec3f p = positions[i];
    const NearSolids near = grid.near(p, 0, solids.size);
    for (int k = near.from(0); k < near.count; k = near.from(k + 1))
      if (!(solids[k].clearance.at(solids[k].end.toBody(p)) > reach)) f(k);
  }
};

/// Whether there are any, and how many.
struct CountSolids {
  SolidsInReach near;
  ArrayView<int> count;

  WEIR_HD bool operator()(std::int64_t i) const {
    int found = 0;
    near.forEach(i, [&](int) { ++found; });
    count[i] = found;
    return found > 0;
  }
};

/// Of particle near[n].
struct ListSolids {
  SolidsInReach solids;
  ArrayView<const int> near, first;
  ArrayView<int> count, solid;
  int* lost;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = near[n], room = count[i];
    const std::int64_t begin = first[i];
    int found = 0;
    if (begin + room <= solid.size)
      solids.forEach(i, [&](int k) {
        if (found < room) solid[begin + found++] = k;
      });
    else
      atomicAdd(lost, room);
    count[i] = found;
  }
};

/// The solids of particle near[n].
struct WriteKeys {
  SolidPairsView pairs;
  ArrayView<const int> near;
  ArrayView<std::uint32_t> keys;
  ArrayView<int> items;

  WEIR_HD void operator()(std::int64_t n) const {
    const int i = near[n];
    for (int pair = pairs.begin(i); pair < pairs.end(i); ++pair) {
      keys[pair] = static_cast<std::uint32_t>(pairs.solid[pair]);
      items[pair] = static_cast<int>(n);
    }
  }
};

}  // namespace detail

template <class Backend>
void SolidPairs::find(Backend& device, Count particles, ArrayView<const SolidView> solids,
                      const SolidGridView& grid, ArrayView<const Vec3f> positions, float reach) {
  const detail::SolidsInReach nearSolids{solids, grid, positions, reach};
  count_.resizeDiscarding(positions.size + 1);
  first_.resizeDiscarding(positions.size + 1);
  near_.resizeDiscarding(positions.size);
  marks_.resizeDiscarding(positions.size);
  count_.fillZero();
  compactOnce(device, "near solids", particles, detail::CountSolids{nearSolids, count_.view()}, marks_,
              near_.view(), nearCounter_.data());
  exclusiveScan(device, std::as_const(count_).view(), first_.view(), first_.size());
  makeRoom(positions.size, solids.size);
  parallelForUneven(device, "solids of particles", nearCount(),
                    detail::ListSolids{nearSolids, near(), std::as_const(first_).view(), count_.view(),
                                       solid_.view(), lost_.data()});
  listBySolid(device, solids.size);
}

template <class Backend>
void SolidPairs::listBySolid(Backend& device, std::int64_t solids) {
  bySolid_.forget();
  if (KeyLists::areFew(solids)) return;
  bySolid_.clear(device.kind() == DeviceKind::kCpu ? wanted_ : room());
  parallelForUneven(device, "particles of solids", nearCount(),
                    detail::WriteKeys{view(), near(), bySolid_.keys(), bySolid_.items()});
  bySolid_.sort(device, solids);
}

}  // namespace weir
