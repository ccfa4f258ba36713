#include "framework/particles/arrangement.h"

#include <algorithm>
#include <deque>
#include <mutex>
#include <utility>

#include "framework/compute/cpu_threads.h"
#include "framework/compute/device.h"

namespace weir {

bool isRelaxed(const std::optional<Arrangement>& told, const ParticleBatch::Request& request) {
  return told ? *told == Arrangement::kRelaxed : request.disordered;
}

namespace {

/// What a tile of sources depends on.
struct TileKey {
  double supportRatio;
  int height;
  std::uint64_t seed;
  bool operator==(const TileKey&) const = default;
};

}  // namespace

std::shared_ptr<const RelaxedTile> tileOfSource(const ParticleBatch::Request& request, std::uint64_t seed,
                                                const Device& device, int height) {
  constexpr int kSweeps = 200;
  constexpr std::size_t kKept = 32;
  static std::mutex mutex;
  static std::deque<std::pair<TileKey, std::shared_ptr<const RelaxedTile>>> kept;

  const TileKey key{request.supportRatio, height, seed};
  const std::scoped_lock lock(mutex);  // while it is made, too: other ranks wait for the same one
  const auto found = std::ranges::find(kept, key, &decltype(kept)::value_type::first);
  if (found != kept.end()) return found->second;
  const auto* cpu = dynamic_cast<const CpuDevice*>(&device);
  CpuThreads threads(cpu ? cpu->threads() : 0);
  auto tile =
      std::make_shared<const RelaxedTile>(request.supportRatio, kTileSide, height, kSweeps, seed, threads);
  if (kept.size() == kKept) kept.pop_front();
  kept.emplace_back(key, tile);
  return tile;
}

}  // namespace weir
