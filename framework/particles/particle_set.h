// The particles of a fluid: a struct of arrays with a registry of named attributes.
//
// Sorting, removal, emission, export and rendering walk the registry, so an attribute that a module adds is
// permuted, carried and shown like the built-in ones: position [m], velocity [m/s] and id. Attributes are
// read and written by handles (attribute.h), scratch memory is leased (lease.h), and what the algorithms of a
// step leave for each other stands in one table (by_products.h).
//
// Where several sets share the particles of a fluid, each owns some, and has copies of others' behind these,
// its halo, so that sums over neighbours find them: [0, owned) and [owned, owned + halo). Everything that is
// said of the particles of a set is about those that it owns: count(), emission, removal, state, exports,
// pictures and measurements. Particles migrate and halos are exchanged as packed bytes (pack_layout.h).
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/base/api.h"
#include "framework/compute/parallel.h"
#include "framework/graph/state.h"
#include "framework/particles/attribute.h"
#include "framework/particles/by_products.h"
#include "framework/particles/free_motion.h"
#include "framework/particles/lease.h"
#include "framework/particles/particle_batch.h"

namespace WEIR_API weir {

class PackLayout;

namespace detail {
class Permutation;

/// Attributes on their way to or from a buffer, as words of 4 bytes.
struct PackedColumns {
  static constexpr int kMax = 8;  // in one launch
  struct Column {
    std::uint32_t* elements = nullptr;
    std::uint32_t* packed = nullptr;
    int words = 0;  // in an element
  };
  Column all[kMax];
  int used = 0;
};
}  // namespace detail

/// Particles of a halo, which begins at 0.
struct HaloRange {
  std::int64_t first = 0, count = 0;
};

/// Some particles of a batch: order[k] for k < *kept, both on the device.
struct BatchSelection {
  ArrayView<const int> order;
  const int* kept = nullptr;
};

class ParticleSet {
 public:
  explicit ParticleSet(Device& device);
  ~ParticleSet();
  ParticleSet(const ParticleSet&) = delete;
  ParticleSet& operator=(const ParticleSet&) = delete;

  Device& device() const { return *device_; }

  /// Bytes on the device, with what is needed to put particles into another order: of an attribute, and of
  /// those that every set has, with the room for vectors.
  static double memoryOfAttribute(double particles, AttributeType type, bool derived = false);
  static double memoryFor(double particles);

  /// Scratch memory: a vector a particle. It is the room in which attributes are put into another order, and
  /// swapping it with velocities is how a module replaces all of them (Attribute::swap).
  Lease<Vec3f> leaseVectors();
  /// Four numbers a particle, in a room that is also the next one's.
  Lease<Vec4f> leaseWide();
  /// At least that many elements of that room for what is not by particle, so that they may be put into
  /// another order meanwhile.
  Lease<Vec4f> leaseUnordered(std::int64_t min);
  /// Four numbers a particle in another room, for solvers. Once it has been leased, the search on CUDA leaves
  /// places there, too (kPlaces).
  Lease<Vec4f> leasePlaces();
  bool hasPlaces() const { return places_.size() > 0; }

  /// What was found on the way through a step.
  ByProducts& byProducts() { return byProducts_; }
  const ByProducts& byProducts() const { return byProducts_; }

  /// Up to that many particles, attributes go into another order all at once, which takes a kernel less but
  /// memory for all of them twice.
  static constexpr std::int64_t kFew = 1 << 20;

  /// Adds an attribute with value 0 for all particles, now and when they are born; or finds the one of that
  /// name, which must have the same type (a scene Error otherwise). T is one of AttributeTypes.
  template <class T>
  Attribute<T> add(const AttributeInfo& info) {
    return handleOf<T>(addStorage(info, AttributeTraits<T>::kType));
  }
  /// An attribute that is known to be there (a WEIR_CHECK otherwise).
  template <class T>
  Attribute<T> get(std::string_view name) {
    return handleOf<T>(storage(name));
  }
  template <class T>
  Attribute<const T> get(std::string_view name) const {
    return handleOf<T>(storage(name));
  }
  const AttributeInfo* find(std::string_view name) const;
  /// What is shown, exported and saved.
  std::vector<AttributeInfo> attributes() const;
  /// The same and the internal ones.
  std::vector<AttributeInfo> allAttributes() const;

  Attribute<Vec3f> positions() { return handleOf<Vec3f>(position_); }
  Attribute<Vec3f> velocities() { return handleOf<Vec3f>(velocity_); }
  Attribute<std::int64_t> ids() { return handleOf<std::int64_t>(id_); }
  Attribute<const Vec3f> positions() const { return handleOf<Vec3f>(position_); }
  Attribute<const Vec3f> velocities() const { return handleOf<Vec3f>(velocity_); }
  Attribute<const std::int64_t> ids() const { return handleOf<std::int64_t>(id_); }

  /// Of the owned particles. The exact number stands on the device; the host knows an upper bound until the
  /// next refreshCount().
  Count count() const { return {bound_, counter_.data()}; }
  std::int64_t bound() const { return bound_; }
  /// Device memory that holds the number.
  int* counter() { return counter_.data(); }
  /// Fetches the exact number; waits for the device.
  std::int64_t refreshCount();

  /// How many particles there is room for: the size of every attribute's array.
  std::int64_t capacity() const { return position_ != nullptr ? position_->values.size() : 0; }
  /// There will be no more particles than this, so no room is made for more as long as that holds.
  void expectAtMost(std::int64_t particles) { maxParticles_ = particles; }

  /// All particles move. It is put off until somebody reads or writes positions or velocities, or the
  /// particles are put into another order, which then moves them on its way.
  void move(const FreeMotion& motion);
  /// What particles have, and how they are to move yet; dt is 0 where they are not.
  struct PendingMotion {
    FreeMotion motion;
    ArrayView<const Vec3f> positions, velocities;

    WEIR_HD Vec3f velocity(std::int64_t i) const { return motion.velocity(velocities[i]); }
    WEIR_HD Vec3f position(std::int64_t i) const { return motion.position(positions[i], velocity(i)); }
  };
  bool hasPendingMotion() const { return motion_.has_value(); }
  PendingMotion pendingMotion() const {
    return {motion_.value_or(FreeMotion{}), std::as_const(position_->values).view(),
            std::as_const(velocity_->values).view()};
  }

  /// Adds the particles of a batch behind the others, with its attributes; their ids go on from the last one
  /// given. Throws a scene Error if an attribute of the batch has the name of another one that is of another
  /// type, or derived, or one that every particle has.
  void append(const ParticleBatch& batch) { append(batch, {}); }
  /// Only those that are selected. Ids are given to all. The host counts all until the next refreshCount().
  void append(const ParticleBatch& batch, const BatchSelection& selected);
  /// The id of the next one that is appended. Sets that share a fluid append the same batches, each a
  /// selection of its own, or tell each other where ids go on, so that no two particles have the same. Ids
  /// never go back (a WEIR_CHECK).
  std::int64_t nextId() const { return nextId_; }
  void continueIdsFrom(std::int64_t id);
  /// Particle order[k] becomes particle k, for k < count(). The order may leave particles out if the counter
  /// was lowered to fit.
  void permute(ArrayView<const int> order);
  void clear();

  /// Copies of others' particles that stand behind the owned ones. They are gone as soon as the owned ones
  /// are put into another order, become more or are removed.
  std::int64_t haloCount() const { return halo_; }
  /// The owned particles and the halo.
  Count countWithHalo() const { return halo_ == 0 ? count() : Count(bound_ + halo_); }
  /// Writes the particles at these indices (on the device), in this order, into `to`, which gets the size for
  /// them. All packing throws a simulation Error if the set lacks an attribute of the layout.
  void pack(const PackLayout& layout, ArrayView<const int> indices, Array<std::byte>& to);
  /// The same for `count` particles from `first` on.
  void pack(const PackLayout& layout, std::int64_t first, std::int64_t count, Array<std::byte>& to);
  /// Adds packed particles (on the device, as all buffers) behind the owned ones, as owned: they keep the ids
  /// that they bring. What the layout lacks is 0.
  void appendPacked(const PackLayout& layout, ArrayView<const std::byte> from);
  /// Adds them behind the halo, and says which they are there. Waits for the device if they are the first.
  HaloRange appendHalo(const PackLayout& layout, ArrayView<const std::byte> from);
  /// Replaces attributes of particles of the halo, which stay where they are; these must have been packed in
  /// the order in which they came (a simulation Error if they are not as many).
  void refreshHalo(const PackLayout& layout, ArrayView<const std::byte> from, const HaloRange& range);
  void dropHalo();
  /// Takes out owned particles, as those that have migrated; `indices` are in any order, each once. The last
  /// ones take their places.
  void remove(std::vector<int> indices);

  /// All particles in their order, with all attributes that the set has at the time.
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

 private:
  friend class detail::Permutation;
  friend class detail::AttributeStorage;
  template <class Backend>
  void permuteOn(Backend& device, ArrayView<const int> order);
  template <class Backend>
  void appendOn(Backend& device, const ParticleBatch& batch, const BatchSelection& selected);
  template <class Backend, class T>
  void appendAttributeOn(Backend& device, const AttributeInfo& info, const Array<T>& values,
                         const Count& count, const BatchSelection& selected);
  template <class Backend>
  void moveOn(Backend& device, const FreeMotion& motion);
  template <class Backend>
  void zeroFromOn(Backend& device, ArrayView<std::uint32_t> words, int wordsInOne, const Count& first,
                  std::int64_t amount);
  template <class Backend>
  void packOn(Backend& device, const detail::PackedColumns& columns, ArrayView<const int> indices);
  template <class Backend>
  void unpackOn(Backend& device, const detail::PackedColumns& columns, std::int64_t amount,
                const Count& first);
  template <class Backend>
  void countMoreOn(Backend& device, const Count& amount);
  template <class Backend>
  void moveOn(Backend& device, const detail::PackedColumns& columns, ArrayView<const int> from,
              ArrayView<const int> to);

  template <class F>
  void forEachPacked(const PackLayout& layout, std::uint32_t* buffer, std::int64_t particles, const F& f);
  void unpack(const PackLayout& layout, ArrayView<const std::byte> from, std::int64_t particles,
              const Count& first);
  void zeroMissing(const PackLayout& layout, std::int64_t particles, const Count& first);
  void checkFits(std::int64_t particles) const;

  /// Makes up for a motion that was put off.
  void settle();
  void addAttributesOf(const ParticleBatch& batch);
  /// All attributes are about to be in another place: nobody may hold scratch memory.
  void moveElements();
  /// The same for owned particles that will be in another order, or more, or fewer. Drops the halo.
  void rearrange();
  Lease<Vec4f> lendWide(std::int64_t size, bool byParticle);
  void makeRoom(std::int64_t particles);
  bool hasFew() const { return (maxParticles_ == kUnknown ? capacity() : maxParticles_) <= kFew; }

  using Storage = std::shared_ptr<detail::AttributeStorage>;
  Storage storage(std::string_view name) const;
  Storage addStorage(const AttributeInfo& info, AttributeType type);
  template <class T>
  static Attribute<T> handleOf(const std::shared_ptr<detail::AttributeStorage>& storage) {
    auto typed = std::dynamic_pointer_cast<detail::TypedStorage<T>>(storage);
    WEIR_CHECK(typed);
    return handleOf(typed);
  }
  template <class T>
  static Attribute<T> handleOf(const std::shared_ptr<detail::TypedStorage<T>>& storage) {
    return Attribute<T>(storage);
  }

  Device* device_;
  detail::SpareMemory spares_;
  std::vector<Storage> storages_;
  std::shared_ptr<detail::TypedStorage<Vec3f>> position_, velocity_;
  std::shared_ptr<detail::TypedStorage<std::int64_t>> id_;
  Array<Vec4f> wide_, places_;
  std::shared_ptr<detail::Room> vectorRoom_, wideRoom_, placesRoom_;
  ByProducts byProducts_;
  Array<int> counter_;
  std::optional<FreeMotion> motion_;
  std::int64_t bound_ = 0;
  std::int64_t halo_ = 0;  // only where bound_ is exact
  std::int64_t nextId_ = 0;
  static constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::max();
  std::int64_t maxParticles_ = kUnknown;
};

}  // namespace weir
