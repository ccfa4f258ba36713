#include "framework/particles/divided_particles.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "framework/base/error.h"
#include "framework/particles/pack_layout.h"

namespace weir {

namespace {

/// More layers than this are not told apart: the outermost ones hold what is beyond.
constexpr std::int64_t kMaxLayers = 1 << 16;

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
      slabs_{.layers = {.inverseCellSize = 1.0f / cellSize},
             .cuts = std::vector<int>(std::size_t(ranks.size()) - 1, int(CellLayers::kFarthest))},
      cuts_(particles.device(), slabs_.cuts),
      found_(particles.device()),
      foundCount_(particles.device(), 1),
      owners_(particles.device()),
      buffer_(particles.device()) {}

DividedParticles::~DividedParticles() {
  try {
    releaseParcels();
  } catch (const Error&) {  // of the device, which whoever uses it next is told of
  }
}

void DividedParticles::cut(const Aabb& box) {
  cutLayersOf(box, particles_.positions().toHost(particles_.refreshCount()), false);
}

void DividedParticles::cut(const std::vector<Vec3f>& positions) {
  Aabb box;
  for (const Vec3f& p : positions)
    if (isFinite(p)) box.extend(p);
  cutLayersOf(box, positions, true);
}

void DividedParticles::cutLayersOf(const Aabb& box, const std::vector<Vec3f>& positions, bool ofAllRanks) {
  if (box.empty()) return;
  const Vec3f size = box.size();
  CellLayers& layers = slabs_.layers;
  // A face across x cuts the rows of cells that groups of particles stand in, and those beside a halo are
  // searched and summed more slowly: so the fluid must be twice as long there as in other directions.
  layers.axis = size.x >= 2 * std::max(size.y, size.z) ? 0 : (size.y > size.z ? 1 : 2);
  const std::int64_t first = layers.layerOf(box.lo), last = layers.layerOf(box.hi);
  std::vector<std::int64_t> counts(std::size_t(std::min(last - first + 1, kMaxLayers)), 0);
  for (const Vec3f& p : positions)
    if (isFinite(p))
      ++counts[std::size_t(std::clamp<std::int64_t>(layers.layerOf(p) - first, 0, std::ssize(counts) - 1))];
  if (!ofAllRanks) ranks_.sum(counts);
  slabs_.cuts = cutLayers(static_cast<int>(first), counts, ranks_.size());
  cuts_.assign(slabs_.cuts);
}

SlabsView DividedParticles::onDevice() const {
  return {slabs_.layers, cuts_.data(), slabs_.count()};
}

void DividedParticles::append(const ParticleBatch& batch, const BatchSelection& selected) {
  if (batch.count == 0) return;
  ParticleSet all(particles_.device());
  all.continueIdsFrom(particles_.nextId());
  all.append(batch, selected);
  all.refreshCount();
  appendOwn(all);
}

void DividedParticles::restore(const StateReader& from) {
  ParticleSet all(particles_.device());
  addAttributes(PackLayout(particles_), all);
  all.restore(from);
  cut(all.positions().toHost(all.bound()));
  particles_.clear();
  appendOwn(all);
}

void DividedParticles::appendOwn(ParticleSet& all) {
  const std::vector<Vec3f> positions = all.positions().toHost(all.bound());
  std::vector<int> own;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const int owner = isFinite(positions[i]) ? slabs_.view().slabOf(positions[i]) : 0;
    if (owner == ranks_.rank()) own.push_back(static_cast<int>(i));
  }
  const PackLayout layout(all);
  addAttributes(layout, particles_);
  const Array<int> indices(all.device(), own);
  all.pack(layout, indices.view(), buffer_);
  particles_.appendPacked(layout, std::as_const(buffer_).view());
  particles_.continueIdsFrom(all.nextId());
  particles_.refreshCount();
}

Parcel DividedParticles::packed(const PackLayout& layout, ArrayView<const int> indices) {
  Array<std::byte> bytes(particles_.device());
  bytes.reserveDiscarding(roomFor(layout.bytesOf(indices.size)));
  particles_.pack(layout, indices, bytes);
  return Parcel(std::move(bytes));
}

const Parcel& DividedParticles::nextOf(int rank) {
  return parcels_.emplace_back(ranks_.receiveParcel(rank, particles_.device()));
}

ArrayView<const std::byte> DividedParticles::unpackedOf(int rank) {
  const Parcel& parcel = nextOf(rank);
  buffer_.resizeDiscarding(parcel.size());
  parcel.copyTo(particles_.device(), buffer_.data());
  return std::as_const(buffer_).view();
}

void DividedParticles::releaseParcels() {
  particles_.device().synchronize();
  parcels_.clear();
}

void DividedParticles::migrate() {
  releaseParcels();
  const std::int64_t count = particles_.refreshCount();
  std::int64_t leaving = 0;
  if (count > 0) leaving = dispatch(particles_.device(), [&](auto& device) { return findLeavingOn(device); });
  const std::vector<int> indices = found_.toHost(leaving), owners = owners_.toHost(leaving);
  std::vector<std::vector<int>> byRank(std::size_t(ranks_.size()));
  for (std::size_t k = 0; k < indices.size(); ++k) byRank[std::size_t(owners[k])].push_back(indices[k]);
  const PackLayout layout(particles_);
  for (int to = 0; to < ranks_.size(); ++to) {
    if (to == ranks_.rank()) continue;
    const Array<int> going(particles_.device(), byRank[std::size_t(to)]);
    ranks_.postParcel(to, packed(layout, going.view()));
  }
  particles_.remove(indices);
  particles_.dropHalo();
  particles_.refreshCount();
  for (int from = 0; from < ranks_.size(); ++from)
    if (from != ranks_.rank()) particles_.appendPacked(layout, unpackedOf(from));
  particles_.refreshCount();
}

void DividedParticles::showHalo() {
  const std::int64_t count = particles_.refreshCount();
  const PackLayout layout(particles_, {"position", "id"});
  neighbors_.clear();
  for (const int rank : slabs_.neighborsOf(ranks_.rank())) {
    Neighbor& neighbor = neighbors_.emplace_back(particles_.device());
    neighbor.rank = rank;
    if (count > 0) {
      const std::int64_t shown =
          dispatch(particles_.device(), [&](auto& device) { return findShownOn(device, rank); });
      neighbor.shown.reserveDiscarding(roomFor(shown));
      neighbor.shown.resizeDiscarding(shown);
      particles_.device().copy(neighbor.shown.data(), found_.data(), std::size_t(shown) * sizeof(int));
    }
    ranks_.postParcel(rank, packed(layout, neighbor.shown.view()));
  }
  for (Neighbor& neighbor : neighbors_)
    neighbor.halo = particles_.appendHalo(layout, unpackedOf(neighbor.rank));
}

void DividedParticles::refresh(std::initializer_list<std::string_view> attributes) {
  const PackLayout layout(particles_, attributes);
  for (const Neighbor& neighbor : neighbors_)
    ranks_.postParcel(neighbor.rank, packed(layout, neighbor.shown.view()));
  for (const Neighbor& neighbor : neighbors_)
    particles_.refreshHalo(layout, unpackedOf(neighbor.rank), neighbor.halo);
}

void DividedParticles::refreshWords(ArrayView<std::uint32_t> words, int wordsInOne) {
  Device& device = particles_.device();
  for (const Neighbor& neighbor : neighbors_) {
    Array<std::byte> bytes(device);
    bytes.reserveDiscarding(
        roomFor(neighbor.shown.size() * wordsInOne * std::int64_t{sizeof(std::uint32_t)}));
    dispatch(device, [&](auto& backend) {
      gatherWordsOn(backend, {words.data, words.size}, wordsInOne, neighbor.shown.view(), bytes);
    });
    ranks_.postParcel(neighbor.rank, Parcel(std::move(bytes)));
  }
  for (const Neighbor& neighbor : neighbors_) {
    const Parcel& parcel = nextOf(neighbor.rank);
    std::uint32_t* const to = words.data + wordsInOne * (particles_.bound() + neighbor.halo.first);
    WEIR_CHECK(parcel.size() == neighbor.halo.count * wordsInOne * std::int64_t{sizeof(*to)});
    parcel.copyTo(device, to);
  }
}

void DividedParticles::gather(ParticleSet* all) {
  const PackLayout layout(particles_);
  std::vector<int> indices(std::size_t(particles_.refreshCount()));
  std::iota(indices.begin(), indices.end(), 0);
  const Array<int> owned(particles_.device(), indices);
  ranks_.postParcel(0, packed(layout, owned.view()));
  if (all == nullptr) return;
  addAttributes(layout, *all);
  for (int from = 0; from < ranks_.size(); ++from) all->appendPacked(layout, unpackedOf(from));
  releaseParcels();  // which are as large as all particles
  all->continueIdsFrom(particles_.nextId());
  all->refreshCount();
}

std::int64_t DividedParticles::countOfAll() {
  return ranks_.sum(particles_.refreshCount());
}

}  // namespace weir
