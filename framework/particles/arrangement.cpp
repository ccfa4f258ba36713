#include "framework/particles/arrangement.h"

#include "framework/compute/cpu_threads.h"
#include "framework/compute/device.h"

namespace weir {

bool isRelaxed(const std::optional<Arrangement>& told, const ParticleBatch::Request& request) {
  return told ? *told == Arrangement::kRelaxed : request.disordered;
}

RelaxedTile tileOfSource(const ParticleBatch::Request& request, std::uint64_t seed, const Device& device,
                         int height) {
  constexpr int kSweeps = 200;
  const auto* cpu = dynamic_cast<const CpuDevice*>(&device);
  CpuThreads threads(cpu ? cpu->threads() : 0);
  return {request.supportRatio, kTileSide, height, kSweeps, seed, threads};
}

}  // namespace weir
