#include "framework/particles/initial_division.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "framework/particles/pack_layout.h"

namespace weir {

namespace {

// What is on its way at a time, or on the host, comes to little beside what a rank has.
constexpr std::int64_t kTurns = 64, kSlice = 1 << 16;

/// Particles for one rank.
struct Parting {
  std::vector<Vec3f> positions;
  std::vector<std::int64_t> ids;
};

/// One behind the other, on a device.
template <class... T>
Array<std::byte> joined(Device& device, const std::vector<T>&... of) {
  std::vector<std::byte> all;
  all.reserve(((of.size() * sizeof(T)) + ...));
  const auto add = [&](std::span<const std::byte> bytes) {
    all.insert(all.end(), bytes.begin(), bytes.end());
  };
  (add(std::as_bytes(std::span(of))), ...);
  return {device, all};
}

/// Sends to each rank what is for it, and takes what others send at the same time.
void exchange(Communicator& ranks, ParticleSet& particles, const std::vector<Parting>& to,
              const Vec3f& velocity) {
  const PackLayout layout(particles, {"position", "velocity", "id"});
  Device& device = particles.device();
  std::vector<int> others;
  for (int rank = 0; rank < ranks.size(); ++rank) {
    const auto& [positions, ids] = to[static_cast<std::size_t>(rank)];
    Array<std::byte> packed = joined(device, positions, std::vector<Vec3f>(positions.size(), velocity), ids);
    if (rank == ranks.rank()) {
      particles.appendPacked(layout, std::as_const(packed).view());
      continue;
    }
    others.push_back(rank);
    ranks.postParcel(rank, Parcel(std::move(packed)));
  }
  const std::vector<Parcel> arrived = ranks.receiveParcels(others, device);
  for (const Parcel& parcel : arrived) {
    Array<std::byte> here(device, parcel.size());
    parcel.copyTo(device, here.data());
    particles.appendPacked(layout, std::as_const(here).view());
  }
  device.synchronize();  // before parcels go back
}

/// Calls f(place, k) for so many particles of a batch from `first` on.
template <class F>
void forEachPlace(const ParticleBatch& batch, std::int64_t first, std::int64_t count, const F& f) {
  std::vector<Vec3f> places(static_cast<std::size_t>(count));
  if (count > 0)
    batch.positions.device().download(places.data(), batch.positions.data() + first,
                                      places.size() * sizeof(Vec3f));
  for (std::int64_t k = 0; k < count; ++k) f(places[static_cast<std::size_t>(k)], k);
}

void countInLayers(const ParticleBatch& batch, const CellLayers& layers, std::vector<std::int64_t>& counts) {
  for (std::int64_t first = 0; first < batch.count; first += kSlice)
    forEachPlace(batch, first, std::min(kSlice, batch.count - first), [&](const Vec3f& p, std::int64_t) {
      if (isFinite(p)) ++counts[static_cast<std::size_t>(layers.layerOf(p) - layers.first)];
    });
}

}  // namespace

InitialDivision initialDivision(Communicator& ranks, const Aabb& box, const std::vector<SharedBatch>& batches,
                                float cellSize) {
  const CellLayers layers = layersAcross(box, cellSize);
  std::vector<std::int64_t> counts(static_cast<std::size_t>(layers.count));
  // What every rank has whole is the first one's to count.
  for (const auto& [batch, part] : batches)
    if (part != nullptr || ranks.rank() == 0) countInLayers(*batch, layers, counts);
  ranks.sum(counts);
  InitialDivision division{.slabs = {layers, cutLayers(layers.first, counts, ranks.size())}};
  const CellLayers own = division.slabs.layersOf(ranks.rank());
  const auto first = counts.begin() + (own.first - layers.first);
  division.own = std::accumulate(first, first + own.count, std::int64_t{0});
  return division;
}

void appendPart(DividedParticles& divided, ParticleSet& particles, const ParticleBatch& batch,
                const BatchPart& part) {
  const bool hasNothingElse = batch.velocities.empty() && batch.attributes.empty();
  WEIR_CHECK(hasNothingElse);
  Communicator& ranks = divided.ranks();
  const RankTimes::Scope scope(divided.times(), RankWork::kMigration);
  const SlabsView slabs = divided.slabs().view();
  const std::int64_t firstId = particles.nextId(), runs = std::ssize(part.runs);
  const std::int64_t most = ranks.max(runs), atOnce = (most + kTurns - 1) / kTurns;
  // Parts are alike in order: all would send to the same rank at a time, if each did not begin elsewhere.
  const std::int64_t start = runs * ranks.rank() / ranks.size();
  for (std::int64_t turn = 0; turn < most; turn += atOnce) {
    std::vector<Parting> to(static_cast<std::size_t>(ranks.size()));
    for (std::int64_t k = turn; k < std::min(turn + atOnce, runs); ++k) {
      const BatchPart::Run& run = part.runs[static_cast<std::size_t>((start + k) % runs)];
      forEachPlace(batch, run.first, run.count, [&](const Vec3f& p, std::int64_t i) {
        Parting& of = to[static_cast<std::size_t>(slabs.slabOf(p))];
        of.positions.push_back(p);
        of.ids.push_back(firstId + run.number + i);
      });
    }
    exchange(ranks, particles, to, batch.velocity);
  }
  particles.continueIdsFrom(firstId + part.all);
  particles.refreshCount();
}

}  // namespace weir
