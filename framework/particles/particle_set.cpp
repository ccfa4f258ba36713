#include "framework/particles/particle_set.h"

#include <algorithm>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "framework/graph/memory_estimate.h"
#include "framework/particles/permutation.h"

namespace weir {

using detail::AttributeStorage;
using detail::TypedStorage;

namespace {

template <class T>
std::shared_ptr<TypedStorage<T>> typed(const std::shared_ptr<AttributeStorage>& storage) {
  return std::static_pointer_cast<TypedStorage<T>>(storage);
}

}  // namespace

ParticleSet::ParticleSet(Device& device)
    : device_(&device),
      wide_(device),
      places_(device),
      vectorRoom_(std::make_shared<detail::Room>()),
      wideRoom_(std::make_shared<detail::Room>()),
      placesRoom_(std::make_shared<detail::Room>()),
      counter_(device) {
  counter_.resize(1);
  counter_.fillZero();
  const auto vector = AttributeType::kVec3;
  position_ = typed<Vec3f>(addStorage({"position", vector, "m", "Position."}, vector));
  velocity_ = typed<Vec3f>(addStorage({"velocity", vector, "m/s", "Velocity."}, vector));
  const AttributeInfo id{"id", AttributeType::kInt64, "", "A number that stays with the particle, from 0."};
  id_ = typed<std::int64_t>(addStorage(id, id.type));
}

ParticleSet::~ParticleSet() = default;

double ParticleSet::memoryOfAttribute(double particles, AttributeType type, bool derived) {
  const std::size_t size = withAttributeType(type, []<class T>(std::type_identity<T>) { return sizeof(T); });
  // What is derived has no spare, and vectors have that of the positions (see permuteOn). So has all of
  // the type of ids.
  const bool sharesSpare = type == AttributeType::kVec3 || type == AttributeType::kInt64;
  const bool twice = !derived && (particles <= kFew || !sharesSpare);
  return (twice ? 2 : 1) * bytesOfArray(particles, size);
}

double ParticleSet::memoryFor(double particles) {
  const double spares = particles <= kFew ? 0
                                          : bytesOfArray(particles, sizeof(Vec3f)) +
                                                bytesOfArray(particles, sizeof(std::int64_t));
  return spares + 2 * memoryOfAttribute(particles, AttributeType::kVec3) +
         memoryOfAttribute(particles, AttributeType::kInt64);
}

Lease<Vec3f> ParticleSet::leaseVectors() {
  WEIR_CHECK(!vectorRoom_->isLent);
  return {vectorRoom_, true, spares_.get<Vec3f>(*device_, 0, capacity())};
}

Lease<Vec4f> ParticleSet::leaseWide() {
  return lendWide(capacity(), true);
}

Lease<Vec4f> ParticleSet::leaseUnordered(std::int64_t min) {
  return lendWide(std::max(min, capacity()), false);
}

Lease<Vec4f> ParticleSet::lendWide(std::int64_t size, bool byParticle) {
  WEIR_CHECK(!wideRoom_->isLent);
  const std::int64_t before = wide_.capacity();
  wide_.resizeDiscarding(size);
  // Searches read some fine cells that nobody writes, and forget what they said.
  if (size > before) wide_.fillZero();
  return {wideRoom_, byParticle, wide_};
}

Lease<Vec4f> ParticleSet::leasePlaces() {
  WEIR_CHECK(!placesRoom_->isLent);
  places_.resizeDiscarding(capacity());
  return {placesRoom_, true, places_};
}

ParticleSet::Storage ParticleSet::storage(std::string_view name) const {
  for (const Storage& storage : storages_)
    if (storage->info().name == name) return storage;
  return nullptr;
}

const AttributeInfo* ParticleSet::find(std::string_view name) const {
  const Storage found = storage(name);
  return found != nullptr ? &found->info() : nullptr;
}

std::vector<AttributeInfo> ParticleSet::attributes() const {
  std::vector<AttributeInfo> shown = allAttributes();
  std::erase_if(shown, [](const AttributeInfo& info) { return info.internal; });
  return shown;
}

std::vector<AttributeInfo> ParticleSet::allAttributes() const {
  std::vector<AttributeInfo> infos;
  for (const auto& storage : storages_) infos.push_back(storage->info());
  return infos;
}

ParticleSet::Storage ParticleSet::addStorage(const AttributeInfo& info, AttributeType type) {
  if (Storage found = storage(info.name)) {
    if (found->info().type != type)
      throw sceneError("two modules use the particle attribute '" + info.name + "' with different types",
                       "one type for one name");
    return found;
  }
  AttributeInfo typedInfo = info;
  typedInfo.type = type;
  return withAttributeType(type, [&]<class T>(std::type_identity<T>) -> Storage {
    auto added = std::make_shared<TypedStorage<T>>(*this, typedInfo, *device_, spares_);
    added->values.resizeDiscarding(capacity());
    added->values.fillZero();
    return storages_.emplace_back(std::move(added));
  });
}

void detail::AttributeStorage::settle() {
  if (set_.motion_ && (this == set_.position_.get() || this == set_.velocity_.get())) set_.settle();
}

void ParticleSet::settle() {
  if (!motion_) return;
  const FreeMotion motion = *motion_;
  motion_.reset();
  dispatch(*device_, [&](auto& device) { moveOn(device, motion); });
}

void ParticleSet::rearrange() {
  halo_ = 0;
  moveElements();
}

void ParticleSet::moveElements() {
  for (const auto& room : {vectorRoom_, wideRoom_, placesRoom_}) {
    const bool scratchMemoryIsLent = room->isLent && room->isByParticle;
    WEIR_CHECK(!scratchMemoryIsLent);
  }
  vectorRoom_->contents.advance();
  for (const Storage& storage : storages_) storage->rearranged();
}

std::int64_t ParticleSet::refreshCount() {
  bound_ = counter_.toHost().front();
  return bound_;
}

void ParticleSet::makeRoom(std::int64_t particles) {
  if (particles <= capacity()) return;
  constexpr std::int64_t kMinGrowth = 4096;
  const std::int64_t present = capacity();
  const std::int64_t grown = std::max(grownSize(present, particles), present + kMinGrowth);
  // Where there are more than were expected, nobody knows how many there will be.
  const std::int64_t most = particles > maxParticles_ ? kUnknown : maxParticles_;
  const std::int64_t room = std::max(particles, std::min(grown, most));
  // One after another, so that never more than one of them is there twice; what is given back here makes room
  // for that one.
  spares_.release();
  for (const auto& storage : storages_) storage->grow(room);
}

void ParticleSet::addAttributesOf(const ParticleBatch& batch) {
  for (const BatchAttribute& brought : batch.attributes) {
    const AttributeInfo& info = brought.info;
    const Storage present = storage(info.name);
    const bool ofAll = present == position_ || present == velocity_ || present == id_;
    if (present && (ofAll || present->info().derived || present->info().type != info.type))
      throw sceneError("particles bring the attribute '" + info.name + "' as " +
                           std::string(nameOf(info.type)) + ", and the fluid has one of that name, " +
                           (ofAll                     ? "which every particle has"
                            : present->info().derived ? "which it computes itself"
                                                      : std::string(nameOf(present->info().type))),
                       "another name for the attribute");
    addStorage(info, info.type);
  }
}

void ParticleSet::append(const ParticleBatch& batch, const BatchSelection& selected) {
  if (batch.count == 0) return;
  const std::int64_t added =
                         selected.kept != nullptr ? std::min(batch.count, selected.order.size) : batch.count,
                     need = bound_ + added;
  checkFits(need);
  addAttributesOf(batch);
  settle();
  rearrange();
  makeRoom(need);
  dispatch(*device_, [&](auto& device) {
    for (const Storage& storage : storages_) {
      const auto [words, wordsInOne] = storage->words();
      zeroFromOn(device, words, wordsInOne, count(), added);
    }
    appendOn(device, batch, selected);
  });
  bound_ = need;
  nextId_ += batch.count;
}

void ParticleSet::continueIdsFrom(std::int64_t id) {
  WEIR_CHECK(id >= nextId_);
  nextId_ = id;
}

void ParticleSet::permute(ArrayView<const int> order) {
  dispatch(*device_, [&](auto& device) { permuteOn(device, order); });
}

detail::Permutation::Permutation(ParticleSet& particles) : particles_(particles) {
  particles.rearrange();
  for (const auto& storage : particles.storages_)
    if (!storage->info().derived) left_.push_back(storage.get());
}

detail::Permute detail::Permutation::next(ArrayView<const int> order) {
  // Where there are many particles, one attribute of each type at a time: the next of the type goes to where
  // the last one was.
  const std::size_t atOnce = particles_.hasFew() ? Permute::kMax : 1;
  Permute permute{.order = order, .unmoved = particles_.pendingMotion()};
  std::size_t used[kAttributeTypes] = {};
  std::erase_if(left_, [&](AttributeStorage* storage) {
    std::size_t& spare = used[static_cast<int>(storage->info().type)];
    if (permute.used == Permute::kMax || spare == atOnce) return false;
    if (storage->info().name == "position") permute.position = permute.used;
    if (storage->info().name == "velocity") permute.velocity = permute.used;
    permute.columns[permute.used++] = storage->beginPermutation(spare);
    begun_.emplace_back(storage, spare++);
    return true;
  });
  return permute;
}

void detail::Permutation::finish() {
  for (const auto& [storage, spare] : begun_) storage->finishPermutation(spare);
  begun_.clear();
  if (!isLeft()) particles_.motion_.reset();
}

void ParticleSet::move(const FreeMotion& motion) {
  settle();
  motion_ = motion;
  position_->rearranged();
  velocity_->rearranged();
}

void ParticleSet::clear() {
  rearrange();
  motion_.reset();
  counter_.fillZero();
  bound_ = 0;
  nextId_ = 0;
}

void ParticleSet::save(const StateWriter& to) const {
  position_->settle();
  to.put("next_id", nextId_);
  for (const auto& storage : storages_)
    if (!storage->info().internal) storage->save(to, bound_);
}

void ParticleSet::restore(const StateReader& from) {
  rearrange();
  motion_.reset();
  bound_ = std::ssize(from.getAll<std::int64_t>("id"));
  from.get("next_id", nextId_);
  makeRoom(bound_);
  const int count = static_cast<int>(bound_);
  device_->upload(counter_.data(), &count, sizeof(int));
  for (const auto& storage : storages_)
    if (!storage->info().internal) storage->restore(from);
}

}  // namespace weir
