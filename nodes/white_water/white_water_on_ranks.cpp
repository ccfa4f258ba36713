// What white water does where several ranks share its fluid.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "framework/communication/ranks_report.h"
#include "framework/graph/memory_estimate.h"
#include "nodes/white_water/white_water.h"

namespace weir {

namespace {

/// As particles are gathered in the order of ranks, which is none that others have.
void putIntoOrderOfIds(ParticleSet& set) {
  const std::vector<std::int64_t> ids = set.ids().toHost(set.bound());
  std::vector<int> order(ids.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return ids[std::size_t(a)] < ids[std::size_t(b)]; });
  set.permute(Array<int>(set.device(), order).view());
}

}  // namespace

void WhiteWater::join(Communicator& ranks) {
  const OutputPort& source = *fluid.links().front();
  if (dynamic_cast<OwnedParticles*>(&source.node()) == nullptr)
    throw sceneError("ranks do not share the particles of '" + source.path() + "'",
                     "a node whose particles they do, such as ParticleFluid", "run without --ranks");
  ranks_ = &ranks;
}

OwnedParticles& WhiteWater::sharedFluid() const {
  auto* const shared = dynamic_cast<OwnedParticles*>(&fluid.links().front()->node());
  WEIR_CHECK(shared != nullptr);
  return *shared;
}

bool WhiteWater::isWatched() const {
  return watched_ || particles.links().size() > particles.requests().size();
}

void WhiteWater::share(Device& device) {
  shared_ = std::make_unique<Shared>(*ranks_, *set_, kNearRadius * fluid->material.spacing);
  if (ranks_->rank() > 0 || !isWatched()) return;
  shared_->gathered.emplace(device).expectAtMost(maxParticles);
}

/// Of a fluid in a cube at most so many planes of particles more than a fair share: where slabs are cut
/// between layers of up to three spacings, and what is near on both sides.
double WhiteWater::memoryOnRanks(Device& device) const {
  constexpr double kRemote = 2 * 4, kPlanes = 4 + kRemote;
  const double all = fluid->maxCount, plane = std::pow(all, 2.0 / 3), n = static_cast<double>(maxParticles);
  const double share = std::min(all, std::ceil(all / ranks_->size() + kPlanes * plane));
  // What is near is sent and received.
  const double sources = memoryOfSources(share) + bytesOfArray(share, sizeof(int)) +
                         2 * bytesOfArray(std::min(all, kRemote * plane), sizeof(FluidPoint));
  // All white water may be on one rank, but not on several at a time.
  const double own = memoryOfOwn(n) + DividedParticles::memoryFor(n) + bytesOfArray(n, sizeof(Vec3f));
  if (device.kind() == DeviceKind::kCpu) return ranks_->sizeHere() * sources + own + memoryOfGathered();
  return sources + own + (ranks_->rank() == 0 ? memoryOfGathered() : 0);
}

double WhiteWater::memoryOfGathered() const {
  const double n = static_cast<double>(maxParticles);
  return isWatched() ? ParticleSet::memoryFor(n) + ParticleSet::memoryOfAttribute(n, AttributeType::kInt) +
                           3 * ParticleSet::memoryOfAttribute(n, AttributeType::kFloat)
                     : 0;
}

WhiteWater::Births WhiteWater::birthsOfAll(std::int64_t own) {
  struct OfRank {
    std::int64_t wanted, present;
  };
  Births births{.own = own};
  std::int64_t present = set_->bound();
  if (shared_) {
    present = 0;
    const std::vector<OfRank> all = shared_->particles.ranks().allGather(OfRank{own, set_->bound()});
    for (int rank = 0; rank < ranks_->size(); ++rank) {
      const OfRank& one = all[std::size_t(rank)];
      if (rank < ranks_->rank()) births.before += one.wanted;
      births.wanted += one.wanted;
      present += one.present;
    }
  } else {
    births.wanted = own;
  }
  births.made = std::clamp<std::int64_t>(maxParticles - present, 0, births.wanted);
  return births;
}

void WhiteWater::lookOnRanks() {
  Communicator& ranks = shared_->particles.ranks();
  const Tally own = tallyOwn();
  std::int64_t sums[] = {own.particles, own.kinds.x, own.kinds.y, own.kinds.z};
  ranks.sum(sums);
  shared_->tally = {sums[0], {int(sums[1]), int(sums[2]), int(sums[3])}};
  sumRemoved();
  if (isWatched()) gatherAll();
  Value& report = shared_->report;
  report["ranks"] = ranks.size();
  report["particles"] = meanAndMaxOfRanks(ranks, double(own.particles));
  report["fluid_of_others"] = meanAndMaxOfRanks(ranks, double(shared_->fluid.points().size));
  report["gathered"] = isWatched() ? shared_->tally.particles : 0;
  report["step_ms"] = stepTimesOfRanks(ranks, shared_->particles.times(), shared_->stepsTimed);
}

/// What sinks have removed since the last frame.
void WhiteWater::sumRemoved() {
  removedBefore_ += shared_->particles.ranks().sum(removed_->toHost().front());
  removed_->fillZero();
}

void WhiteWater::gatherAll() {
  std::optional<ParticleSet>& to = shared_->gathered;
  if (to) to->clear();
  shared_->particles.gather(to ? &*to : nullptr);
  if (to) putIntoOrderOfIds(*to);
}

Value WhiteWater::ranksReport() const {
  return shared_ ? shared_->report : Value::object();
}

}  // namespace weir
