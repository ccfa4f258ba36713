#include "framework/particles/particle_set.h"

#include <algorithm>
#include <limits>

#include "framework/base/error.h"
#include "framework/graph/memory_estimate.h"
#include "framework/particles/permutation.h"

namespace weir {

using detail::AttributeStorage;
using detail::TypedStorage;

ParticleSet::ParticleSet(Device& device)
    : device_(&device),
      spares_(std::make_unique<detail::SpareMemory>()),
      wideScratch_(device),
      places_(device),
      counter_(device) {
  counter_.resize(1);
  counter_.fillZero();
  positions_ = &add<Vec3f>({"position", AttributeType::kVec3, "m", "Position."});
  velocities_ = &add<Vec3f>({"velocity", AttributeType::kVec3, "m/s", "Velocity."});
  ids_ = &add<int>({"id", AttributeType::kInt, "", "A number that stays with the particle, from 0."});
}

ParticleSet::~ParticleSet() = default;
ParticleSet::ParticleSet(ParticleSet&&) noexcept = default;
ParticleSet& ParticleSet::operator=(ParticleSet&&) noexcept = default;

double ParticleSet::memoryOfAttribute(double particles, AttributeType type, bool derived) {
  const std::size_t size = type == AttributeType::kVec3  ? sizeof(Vec3f)
                           : type == AttributeType::kInt ? sizeof(int)
                                                         : sizeof(float);
  // What is derived has no spare, and vectors have that of the positions (see permuteOn). So have ints.
  const bool twice = !derived && (particles <= kFew || type == AttributeType::kFloat);
  return (twice ? 2 : 1) * bytesOfArray(particles, size);
}

double ParticleSet::memoryFor(double particles) {
  const double spares =
      particles <= kFew ? 0 : bytesOfArray(particles, sizeof(Vec3f)) + bytesOfArray(particles, sizeof(int));
  return spares + 2 * memoryOfAttribute(particles, AttributeType::kVec3) +
         memoryOfAttribute(particles, AttributeType::kInt);
}

Array<Vec3f>& ParticleSet::scratch() {
  ++scratchUses_;
  return spares_->get<Vec3f>(*device_, 0, capacity());
}

Array<Vec4f>& ParticleSet::wideScratch(std::int64_t least) {
  ++uses_;
  const std::int64_t size = std::max(least, capacity()), before = wideScratch_.capacity();
  wideScratch_.resizeDiscarding(size);
  // Searches read some fine cells that nobody writes, and forget what they said.
  if (size > before) wideScratch_.fillZero();
  return wideScratch_;
}

Array<Vec4f>& ParticleSet::places() {
  ++placesUses_, ++uses_;
  places_.resizeDiscarding(capacity());
  return places_;
}

AttributeStorage* ParticleSet::storage(std::string_view name) const {
  for (const auto& storage : storages_)
    if (storage->info().name == name) return storage.get();
  return nullptr;
}

const AttributeInfo* ParticleSet::find(std::string_view name) const {
  const AttributeStorage* found = storage(name);
  return found != nullptr ? &found->info() : nullptr;
}

std::vector<AttributeInfo> ParticleSet::attributes() const {
  std::vector<AttributeInfo> infos;
  for (const auto& storage : storages_) infos.push_back(storage->info());
  return infos;
}

template <class T>
Array<T>& ParticleSet::add(const AttributeInfo& info) {
  used();
  if (AttributeStorage* found = storage(info.name)) {
    auto* typed = dynamic_cast<TypedStorage<T>*>(found);
    if (typed == nullptr)
      throw sceneError("two modules use the particle attribute '" + info.name + "' with different types",
                       "one type for one name");
    return typed->values;
  }
  AttributeInfo typedInfo = info;
  typedInfo.type = detail::attributeTypeOf<T>();
  auto added = std::make_unique<TypedStorage<T>>(typedInfo, *device_, *spares_);
  added->values.resizeDiscarding(capacity());
  added->values.fillZero();
  Array<T>& values = added->values;
  storages_.push_back(std::move(added));
  return values;
}

template <class T>
Array<T>& ParticleSet::get(std::string_view name) {
  used();
  auto* typed = dynamic_cast<TypedStorage<T>*>(storage(name));
  WEIR_CHECK(typed != nullptr);
  return typed->values;
}

template <class T>
const Array<T>& ParticleSet::get(std::string_view name) const {
  return const_cast<ParticleSet*>(this)->get<T>(name);
}

template Array<float>& ParticleSet::add<float>(const AttributeInfo&);
template Array<Vec3f>& ParticleSet::add<Vec3f>(const AttributeInfo&);
template Array<int>& ParticleSet::add<int>(const AttributeInfo&);
template Array<float>& ParticleSet::get<float>(std::string_view);
template Array<Vec3f>& ParticleSet::get<Vec3f>(std::string_view);
template Array<int>& ParticleSet::get<int>(std::string_view);
template const Array<float>& ParticleSet::get<float>(std::string_view) const;
template const Array<Vec3f>& ParticleSet::get<Vec3f>(std::string_view) const;
template const Array<int>& ParticleSet::get<int>(std::string_view) const;

std::int64_t ParticleSet::refreshCount() {
  bound_ = counter_.toHost().front();
  return bound_;
}

void ParticleSet::makeRoom(std::int64_t particles) {
  if (particles <= capacity()) return;
  constexpr std::int64_t kMinGrowth = 4096;
  const std::int64_t present = capacity();
  const std::int64_t grown = std::max(grownSize(present, particles), present + kMinGrowth);
  const std::int64_t room = std::max(particles, std::min(grown, most_));
  // One after another, so that never more than one of them is there twice; what is given back here makes room
  // for that one.
  spares_->release();
  for (const auto& storage : storages_) storage->grow(room);
}

void ParticleSet::append(const ParticleBatch& batch, const BatchSelection& selected) {
  if (batch.count == 0) return;
  if (bound_ + batch.count > std::numeric_limits<int>::max() ||
      nextId_ + batch.count > std::numeric_limits<int>::max())
    throw simulationError("the fluid would get more than 2,147,483,647 particles", "fewer particles");
  used();
  const std::int64_t need = bound_ + batch.count;
  makeRoom(need);
  for (const auto& storage : storages_) storage->zeroBehind(*device_, counter_.data(), batch.count);
  dispatch(*device_, [&](auto& device) { appendOn(device, batch, selected); });
  bound_ = need;
  nextId_ += batch.count;
}

void ParticleSet::permute(ArrayView<const int> order) {
  ++uses_;
  dispatch(*device_, [&](auto& device) { permuteOn(device, order); });
}

detail::Permutation::Permutation(ParticleSet& particles) : particles_(particles) {
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
  used();
  motion_ = motion;
}

void ParticleSet::moveNow() {
  const FreeMotion motion = *motion_;
  motion_.reset();
  dispatch(*device_, [&](auto& device) { moveOn(device, motion); });
}

void ParticleSet::clear() {
  ++uses_;
  motion_.reset();
  counter_.fillZero();
  bound_ = 0;
  nextId_ = 0;
}

void ParticleSet::save(const StateWriter& to) const {
  moved();
  to.put("count", bound_);
  to.put("next_id", nextId_);
  for (const auto& storage : storages_) storage->save(to, bound_);
}

void ParticleSet::restore(const StateReader& from) {
  ++uses_;
  motion_.reset();
  from.get("count", bound_);
  from.get("next_id", nextId_);
  makeRoom(bound_);
  const int count = static_cast<int>(bound_);
  device_->upload(counter_.data(), &count, sizeof(int));
  for (const auto& storage : storages_) storage->restore(from);
}

}  // namespace weir
