#include "framework/particles/divided_particles.h"

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>
#include <utility>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"
#include "framework/particles/make_room.h"
#include "framework/particles/pack_layout.h"

namespace weir {

namespace {

/// A power of two, unless that is much: what is sent differs in size from step to step, and so finds memory
/// that has come back.
std::int64_t roomFor(std::int64_t bytes) {
  constexpr std::int64_t kMuch = std::int64_t{1} << 26;
  return bytes > kMuch ? bytes : std::int64_t(std::bit_ceil(std::uint64_t(bytes)));
}

void addAttributes(const PackLayout& layout, ParticleSet& to) {
  for (const AttributeInfo& info : layout.attributes())
    withAttributeType(info.type, [&]<class T>(std::type_identity<T>) { to.add<T>(info); });
}

}  // namespace

DividedParticles::DividedParticles(Communicator& ranks, ParticleSet& particles, float cellSize)
    : ranks_(ranks),
      particles_(particles),
      cellSize_(cellSize),
      slabs_{.layers = {.inverseCellSize = 1.0f / cellSize},
             .cuts = std::vector<int>(std::size_t(ranks.size()) - 1, 1)},
      cuts_(particles.device(), slabs_.cuts),
      found_(particles.device()),
      foundCount_(particles.device(), 1),
      owners_(particles.device()),
      ends_(particles.device(), 3),
      buffer_(particles.device()) {}

DividedParticles::~DividedParticles() {
  try {
    releaseParcels();
  } catch (const Error&) {  // of the device, which whoever uses it next is told of
  }
}

void DividedParticles::cut(const Aabb& box) {
  if (box.empty()) return;
  const RankTimes::Scope scope(times(), RankWork::kCutting);
  slabs_.layers = layersAcross(box, cellSize_);
  Array<int> inLayer(particles_.device(), slabs_.layers.count);
  inLayer.fillZero();
  if (particles_.refreshCount() > 0)
    dispatch(particles_.device(), [&](auto& device) {
      countInLayersOn(device, particles_.positions().read(), particles_.count(), inLayer.view());
    });
  const std::vector<int> own = inLayer.toHost();
  std::vector<std::int64_t> counts(own.begin(), own.end());
  ranks_.sum(counts);
  cutLayersOf(counts);
}

void DividedParticles::cut(const Aabb& box, const std::vector<ArrayView<const Vec3f>>& positions) {
  if (box.empty()) return;
  const RankTimes::Scope scope(times(), RankWork::kCutting);
  slabs_.layers = layersAcross(box, cellSize_);
  Array<int> inLayer(particles_.device(), slabs_.layers.count);
  inLayer.fillZero();
  for (const ArrayView<const Vec3f>& some : positions)
    dispatch(particles_.device(),
             [&](auto& device) { countInLayersOn(device, some, some.size, inLayer.view()); });
  const std::vector<int> counts = inLayer.toHost();
  cutLayersOf({counts.begin(), counts.end()});
}

void DividedParticles::cutLayersOf(const std::vector<std::int64_t>& counts) {
  // What is on its way then comes to little beside what a rank has.
  constexpr std::int64_t kFewest = 4096;
  const std::int64_t all = std::accumulate(counts.begin(), counts.end(), std::int64_t{0});
  atOnce_ = std::max(kFewest, all / (kParts * ranks_.size()));
  slabs_.cuts = cutLayers(slabs_.layers.first, counts, ranks_.size());
  cuts_.assign(slabs_.cuts);
  cutAnew_ = true;
}

void DividedParticles::follow(const Slabs& slabs) {
  slabs_ = slabs;
  cuts_.assign(slabs_.cuts);
  cutAnew_ = true;
}

SlabsView DividedParticles::onDevice() const {
  return {slabs_.layers, cuts_.data(), slabs_.count()};
}

void DividedParticles::append(const ParticleBatch& batch, const BatchSelection& selected) {
  if (batch.count == 0) return;
  const RankTimes::Scope scope(times(), RankWork::kMigration);
  Array<int> own(particles_.device(), batch.count);
  const std::int64_t count = dispatch(particles_.device(), [&](auto& device) {
    return findOwnOn(device, {batch.positions.data(), batch.count}, selected, own.view());
  });
  particles_.append(batch, {{own.data(), count}, foundCount_.data()});
  particles_.refreshCount();
}

namespace {

/// Where each rank has saved its own rows: how many ranks those were.
constexpr const char* kRanks = "ranks";

}  // namespace

void saveRows(const ParticleSet& particles, const StateWriter& to) {
  for (const AttributeInfo& info : particles.attributes())
    withAttributeType(info.type, [&]<class T>(std::type_identity<T>) {
      const std::vector<T> rows = particles.get<T>(info.name).toHost(particles.bound());
      to.put(info.name, std::span<const T>(rows));
    });
}

void DividedParticles::save(const StateWriter& to) const {
  to.put("next_id", particles_.nextId());
  if (ranks_.size() > 1) to.put(kRanks, ranks_.size());
}

void DividedParticles::restore(const StateReader& from, const Aabb& box) {
  if (from.has(kRanks)) {
    readShare(from);
    cut(box);
    return migrate();
  }
  ParticleSet all(particles_.device());
  read(from, all);
  cut(box, {ArrayView<const Vec3f>{all.positions().read().data(), all.bound()}});
  takeOwn(all);
}

void DividedParticles::restore(const StateReader& from) {
  if (from.has(kRanks)) {
    readShare(from);
    return migrate();
  }
  ParticleSet all(particles_.device());
  read(from, all);
  takeOwn(all);
}

void DividedParticles::readShare(const StateReader& from) {
  particles_.clear();
  particles_.restore(from);
  particles_.refreshCount();
}

void DividedParticles::read(const StateReader& from, ParticleSet& all) const {
  addAttributes(PackLayout(particles_), all);
  all.restore(from);
}

void DividedParticles::takeOwn(ParticleSet& all) {
  const ArrayView<const Vec3f> positions{all.positions().read().data(), all.bound()};
  particles_.clear();
  Array<int> own(all.device(), all.bound());
  std::int64_t count = 0;
  if (all.bound() > 0)
    count =
        dispatch(all.device(), [&](auto& device) { return findOwnOn(device, positions, {}, own.view()); });
  const PackLayout layout(particles_);
  all.pack(layout, {own.data(), count}, buffer_);
  particles_.appendPacked(layout, std::as_const(buffer_).view());
  buffer_ = Array<std::byte>(particles_.device());  // never again so much
  particles_.continueIdsFrom(all.nextId());
  particles_.refreshCount();
}

Parcel DividedParticles::packed(const PackLayout& layout, ArrayView<const int> indices) {
  Array<std::byte> bytes(particles_.device());
  bytes.reserveDiscarding(roomFor(layout.bytesOf(indices.size)));
  particles_.pack(layout, indices, bytes);
  return Parcel(std::move(bytes));
}

Parcel DividedParticles::packed(const PackLayout& layout, const Neighbor& neighbor) {
  Array<std::byte> bytes(particles_.device());
  bytes.reserveDiscarding(roomFor(layout.bytesOf(neighbor.count)));
  particles_.pack(layout, neighbor.first, neighbor.count, bytes);
  return Parcel(std::move(bytes));
}

std::span<const Parcel> DividedParticles::received(const std::vector<int>& from) {
  std::vector<Parcel> parcels = ranks_.receiveParcels(from, particles_.device());
  std::move(parcels.begin(), parcels.end(), std::back_inserter(parcels_));
  return std::span(parcels_).last(parcels.size());
}

std::vector<int> DividedParticles::neighborRanks(int times) const {
  std::vector<int> all;
  for (const Neighbor& neighbor : neighbors_) all.insert(all.end(), std::size_t(times), neighbor.rank);
  return all;
}

ArrayView<const std::byte> DividedParticles::unpacked(const Parcel& parcel) {
  buffer_.resizeDiscarding(parcel.size());
  parcel.copyTo(particles_.device(), buffer_.data());
  return std::as_const(buffer_).view();
}

void DividedParticles::releaseParcels() {
  particles_.device().synchronize();
  parcels_.clear();
}

void DividedParticles::migrate() {
  migrate({});
}

/// Where space was cut anew, most particles may leave: if the longest axis is another one. They go in parts
/// then, the last ones first, so that none of the others takes the place of one that has left. In steps in
/// between, few leave.
void DividedParticles::migrate(ArrayView<const Vec3f> points) {
  const RankTimes::Scope scope(times(), RankWork::kMigration);
  releaseParcels();
  const auto at = [&]() -> ArrayView<const Vec3f> {
    if (points.size > 0) return points;
    return std::as_const(particles_).positions().read();
  };
  std::int64_t left = 0;
  if (particles_.refreshCount() > 0)
    left = dispatch(particles_.device(), [&](auto& device) { return findLeavingOn(device, at()); });
  const std::vector<int> leaving = found_.toHost(left);
  const std::int64_t parts = std::exchange(cutAnew_, false) ? ranks_.max((left + atOnce_ - 1) / atOnce_) : 1;
  for (std::int64_t part = 0; part < std::max<std::int64_t>(parts, 1); ++part) {
    const std::int64_t count = parts > 1 ? std::min(left, atOnce_) : left;
    left -= count;
    dispatch(particles_.device(), [&](auto& device) {
      findOwnersOn(device, at(), {found_.data() + left, count});
    });
    const auto first = leaving.begin() + left;
    if (part > 0) releaseParcels();
    exchange({first, first + count}, owners_.toHost(count));
  }
}

void DividedParticles::exchange(const std::vector<int>& leaving, const std::vector<int>& owners) {
  std::vector<std::vector<int>> byRank(std::size_t(ranks_.size()));
  for (std::size_t k = 0; k < leaving.size(); ++k) byRank[std::size_t(owners[k])].push_back(leaving[k]);
  const PackLayout layout(particles_);
  std::vector<int> others;
  for (int to = 0; to < ranks_.size(); ++to) {
    if (to == ranks_.rank()) continue;
    others.push_back(to);
    const Array<int> going(particles_.device(), byRank[std::size_t(to)]);
    ranks_.postParcel(to, packed(layout, going.view()));
  }
  particles_.remove(leaving);
  particles_.dropHalo();
  for (const Parcel& parcel : received(others)) particles_.appendPacked(layout, unpacked(parcel));
}

/// The one above comes first, as in the order of cells.
void DividedParticles::findNeighborRanks(const SortedLayers& sorted) {
  // Where the first layer ends and the last one begins and ends.
  const int layers[] = {1, sorted.layers - 1, sorted.layers};
  for (int k = 0; k < 3; ++k)
    particles_.device().copy(ends_.data() + k, sorted.cellStart.data + layers[k] * sorted.cellsInLayer,
                             sizeof(int));
  const std::vector<int> ends = ends_.toHost();
  neighbors_.clear();
  const int self = ranks_.rank();
  if (const auto above = slabs_.above(self))
    neighbors_.push_back({*above, sorted.layers - 1, ends[1], ends[2] - ends[1]});
  if (const auto below = slabs_.below(self)) neighbors_.push_back({*below, 0, 0, ends[0]});
}

void DividedParticles::showHalo(const SortedLayers& sorted) {
  const RankTimes::Scope scope(times(), RankWork::kHalo);
  const std::int64_t owned = particles_.refreshCount();
  findNeighborRanks(sorted);
  const PackLayout layout(particles_, {"position", "id"});
  Device& device = particles_.device();
  const std::int64_t starts = sorted.cellsInLayer + 1;
  for (const Neighbor& neighbor : neighbors_) {
    ranks_.postParcel(neighbor.rank, packed(layout, neighbor));
    Array<std::byte> cells(device);
    cells.resizeDiscarding(starts * std::int64_t{sizeof(int)});
    device.copy(cells.data(), sorted.cellStart.data + neighbor.shownLayer * (starts - 1),
                std::size_t(cells.size()));
    ranks_.postParcel(neighbor.rank, Parcel(std::move(cells)));
  }
  int layer = sorted.layers;
  std::int64_t placed = owned;
  const auto place = [&](ArrayView<const int> start) {
    dispatch(device, [&](auto& backend) { placeLayerOn(backend, sorted, layer, start, placed); });
    ++layer;
  };
  if (!slabs_.above(ranks_.rank())) place({});
  auto parcel = received(neighborRanks(2)).begin();
  for (Neighbor& neighbor : neighbors_) {
    neighbor.halo = particles_.appendHalo(layout, unpacked(*parcel++));
    const ArrayView<const std::byte> cells = unpacked(*parcel++);
    place({reinterpret_cast<const int*>(cells.data), starts});
    placed += neighbor.halo.count;
  }
  while (layer < sorted.layers + 2) place({});
}

void DividedParticles::refresh(std::initializer_list<std::string_view> attributes) {
  const RankTimes::Scope scope(times(), RankWork::kRefresh);
  const PackLayout layout(particles_, attributes);
  for (const Neighbor& neighbor : neighbors_) ranks_.postParcel(neighbor.rank, packed(layout, neighbor));
  auto parcel = received(neighborRanks(1)).begin();
  for (const Neighbor& neighbor : neighbors_)
    particles_.refreshHalo(layout, unpacked(*parcel++), neighbor.halo);
}

void DividedParticles::refreshWords(ArrayView<std::uint32_t> words, int wordsInOne) {
  const RankTimes::Scope scope(times(), RankWork::kRefresh);
  Device& device = particles_.device();
  for (const Neighbor& neighbor : neighbors_) {
    const std::int64_t bytesOfOne = wordsInOne * std::int64_t{sizeof(std::uint32_t)};
    Array<std::byte> bytes(device);
    bytes.reserveDiscarding(roomFor(neighbor.count * bytesOfOne));
    bytes.resizeDiscarding(neighbor.count * bytesOfOne);
    device.copy(bytes.data(), words.data + neighbor.first * wordsInOne, std::size_t(bytes.size()));
    ranks_.postParcel(neighbor.rank, Parcel(std::move(bytes)));
  }
  auto parcel = received(neighborRanks(1)).begin();
  for (const Neighbor& neighbor : neighbors_) {
    std::uint32_t* const to = words.data + wordsInOne * (particles_.bound() + neighbor.halo.first);
    WEIR_CHECK(parcel->size() == neighbor.halo.count * wordsInOne * std::int64_t{sizeof(*to)});
    (parcel++)->copyTo(device, to);
  }
}

void DividedParticles::gather(ParticleSet* all) {
  const RankTimes::Scope scope(times(), RankWork::kGathering);
  const std::vector<std::int64_t> counts = ranks_.allGather(particles_.refreshCount());
  // Ids first; what comes behind them goes straight to where it belongs.
  gatherIds(counts, all);
  for (const AttributeInfo& info : particles_.attributes())
    if (info.name != "id")
      withAttributeType(info.type, [&]<class T>(std::type_identity<T>) { gather<T>(info, counts, all); });
}

void DividedParticles::gatherIds(const std::vector<std::int64_t>& counts, ParticleSet* all) {
  const PackLayout ids(particles_, {"id"});
  if (all != nullptr) {
    for (const AttributeInfo& info : particles_.attributes())
      withAttributeType(info.type, [&]<class T>(std::type_identity<T>) { all->add<T>(info); });
    makeRoom(*all, std::accumulate(counts.begin(), counts.end(), std::int64_t{0}));
    particles_.pack(ids, 0, particles_.bound(), buffer_);
    all->appendPacked(ids, std::as_const(buffer_).view());
  }
  bring<std::int64_t>("id", counts, [&](const Parcel& parcel) { all->appendPacked(ids, unpacked(parcel)); });
  if (all == nullptr) return;
  all->continueIdsFrom(particles_.nextId());
  all->refreshCount();
  buffer_ = Array<std::byte>(particles_.device());
}

template <class T>
void DividedParticles::gather(const AttributeInfo& info, const std::vector<std::int64_t>& counts,
                              ParticleSet* all) {
  T* to = nullptr;
  if (all != nullptr) {
    const Attribute<const T> own = std::as_const(particles_).get<T>(info.name);
    to = all->get<T>(info.name).write().data();
    if (counts[0] > 0) particles_.device().copy(to, own.read().data(), std::size_t(counts[0]) * sizeof(T));
    to += counts[0];
  }
  bring<T>(info.name, counts, [&](const Parcel& parcel) {
    parcel.copyTo(particles_.device(), to);
    to += parcel.size() / std::int64_t{sizeof(T)};
  });
}

/// A rank and a part of what it has after the other, so that rank 0 has little on its way. Nobody goes on
/// before it has all, so that no more than one attribute is there twice.
template <class T, class Take>
void DividedParticles::bring(std::string_view attribute, const std::vector<std::int64_t>& counts,
                             const Take& take) {
  for (int from = 1; from < ranks_.size(); ++from)
    for (std::int64_t first = 0; first < counts[std::size_t(from)]; first += kAtOnce) {
      if (ranks_.rank() == from) ranks_.postParcel(0, packed<T>(attribute, first));
      const bool isTaker = ranks_.rank() == 0;
      for (const Parcel& parcel : received(isTaker ? std::vector{from} : std::vector<int>())) take(parcel);
      if (isTaker) releaseParcels();
    }
  releaseParcels();
  ranks_.sum(0);
}

/// Of those that this rank owns, from one of them on.
template <class T>
Parcel DividedParticles::packed(std::string_view attribute, std::int64_t first) {
  Device& device = particles_.device();
  const ArrayView<const T> own = particles_.get<T>(attribute).read();
  const std::int64_t bytes = std::min(kAtOnce, particles_.bound() - first) * std::int64_t{sizeof(T)};
  Array<std::byte> some(device, bytes);
  device.copy(some.data(), own.data + first, std::size_t(bytes));
  return Parcel(std::move(some));
}

std::int64_t DividedParticles::countOfAll() {
  return ranks_.sum(particles_.refreshCount());
}

double DividedParticles::memoryFor(double owned, double halo) {
  // What a rank sends to each of two others as their halo, and what it unpacks of one of these.
  constexpr double kOfHalo = sizeof(Vec3f) + sizeof(std::int64_t), kNeighbors = 2;
  const double shown = halo / kNeighbors * kOfHalo,
               sent = shown > 0 ? kNeighbors * double(roomFor(std::int64_t(shown))) : 0;
  // What of those that migrate is on its way in two turns, and their indices.
  constexpr double kOfMoving = 2 * sizeof(Vec3f) + sizeof(std::int64_t), kTurns = 2;
  return sent + shown + bytesOfArray(kTurns * owned / double(kParts), std::size_t(kOfMoving)) +
         bytesOfArray(owned, sizeof(int));
}

}  // namespace weir
