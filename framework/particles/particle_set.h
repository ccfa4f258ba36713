// The particles of a fluid: a struct of arrays with a registry of named attributes.
//
// Sorting, removal, emission, export and rendering walk the registry, so an attribute that a module adds is
// permuted, carried and shown like the built-in ones: position [m], velocity [m/s] and id.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/compute/parallel.h"
#include "framework/graph/state.h"
#include "framework/particles/free_motion.h"
#include "framework/particles/particle_batch.h"

namespace weir {

enum class AttributeType { kFloat, kVec3, kInt };
inline constexpr int kAttributeTypes = 3;

struct AttributeInfo {
  std::string name;
  AttributeType type = AttributeType::kFloat;
  std::string unit;
  std::string doc;
  bool derived = false;  ///< made anew for every frame, so it does not travel with its particle in between
};

namespace detail {
/// Storage of one attribute without its type; see attribute_storage.h.
class AttributeStorage;
class Permutation;
struct SpareMemory;
}  // namespace detail

/// Some particles of a batch: order[k] for k < *kept, both on the device.
struct BatchSelection {
  ArrayView<const int> order;
  const int* kept = nullptr;
};

class ParticleSet {
 public:
  explicit ParticleSet(Device& device);
  ~ParticleSet();
  ParticleSet(ParticleSet&&) noexcept;
  ParticleSet& operator=(ParticleSet&&) noexcept;

  Device& device() const { return *device_; }

  /// Bytes on the device, with what is needed to put particles into another order: of an attribute, and of
  /// those that every set has, with scratch().
  static double memoryOfAttribute(double particles, AttributeType type, bool derived = false);
  static double memoryFor(double particles);

  /// Memory for a vector a particle, or so many bytes of anything, until the particles are put into another
  /// order or someone else uses it: so within a module's step and its part of one. It is the room in which
  /// velocities, say, are sorted; swapping it with theirs is how a module replaces all of them.
  Array<Vec3f>& scratch();
  /// How often someone has asked for it.
  std::uint64_t scratchUses() const { return scratchUses_; }
  /// Memory for four numbers a particle, or for at least so many elements; the search for neighbours and the
  /// solvers use it. As long as scratch(), and until the next search.
  Array<Vec4f>& wideScratch(std::int64_t least = 0);
  /// Another, for positions in the iterations of solvers. Once a solver has asked for it, the search on CUDA
  /// writes there, too (NeighborList::places); what stands in it lasts until someone asks for it again.
  Array<Vec4f>& places();
  bool hasPlaces() const { return places_.size() > 0; }
  /// Whoever sums over velocities of neighbours may ask for codes of motion (motion_code.h) once, at its
  /// reset. What writes positions and velocities last on CUDA leaves them then, in wideScratch() or places().
  void requestMotionCodes() { asksForMotionCodes_ = true; }
  bool motionCodesRequested() const { return asksForMotionCodes_; }
  void storeMotionCodes(ArrayView<const Vec4f> codes) { motionCodes_ = codes, motionCodesUse_ = uses_; }
  /// Empty if nobody has left them, or as soon as anyone may have changed motion or codes.
  ArrayView<const Vec4f> motionCodes() const {
    return motionCodesUse_ == uses_ ? motionCodes_ : ArrayView<const Vec4f>{};
  }
  /// How often someone has asked for it.
  std::uint64_t placesUses() const { return placesUses_; }
  /// Up to so many particles, attributes go into another order all at once, which takes a kernel less but
  /// memory for all of them twice.
  static constexpr std::int64_t kFew = 1 << 20;

  /// Adds an attribute with value 0 for all particles, now and when they are born; or finds the one of that
  /// name, which must have the same type (a scene Error otherwise). T is float, Vec3f or int. The reference
  /// lives as long as the set.
  template <class T>
  Array<T>& add(const AttributeInfo& info);
  /// An attribute that is known to be there (a WEIR_CHECK otherwise).
  template <class T>
  Array<T>& get(std::string_view name);
  template <class T>
  const Array<T>& get(std::string_view name) const;
  const AttributeInfo* find(std::string_view name) const;
  std::vector<AttributeInfo> attributes() const;

  Array<Vec3f>& positions() { return used(), *positions_; }
  Array<Vec3f>& velocities() { return used(), *velocities_; }
  Array<int>& ids() { return *ids_; }
  const Array<Vec3f>& positions() const { return moved(), *positions_; }
  const Array<Vec3f>& velocities() const { return moved(), *velocities_; }
  const Array<int>& ids() const { return *ids_; }

  /// The exact number stands on the device; the host knows an upper bound until the next refreshCount().
  Count count() const { return {bound_, counter_.data()}; }
  std::int64_t bound() const { return bound_; }
  /// Device memory that holds the number.
  int* counter() { return counter_.data(); }
  /// Fetches the exact number; waits for the device.
  std::int64_t refreshCount();

  /// How many particles there is room for: the size of every attribute's array.
  std::int64_t capacity() const { return positions_ != nullptr ? positions_->size() : 0; }
  /// There will be no more particles than this, so no room is made for more as long as that holds.
  void expectAtMost(std::int64_t particles) { most_ = particles; }

  /// All particles move. It is put off until someone asks for positions or velocities, or the particles are
  /// put into another order, which then moves them on its way.
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
    return {motion_.value_or(FreeMotion{}), std::as_const(*positions_).view(),
            std::as_const(*velocities_).view()};
  }

  /// Adds the particles of a batch behind the others; their ids go on from the last one given.
  void append(const ParticleBatch& batch) { append(batch, {}); }
  /// Only those that are selected. Ids are given to all. The host counts all until the next refreshCount().
  void append(const ParticleBatch& batch, const BatchSelection& selected);
  /// Particle order[k] becomes particle k, for k < count(). The order may leave particles out if the counter
  /// was lowered to fit.
  void permute(ArrayView<const int> order);
  void clear();

  /// All particles in their order, with all attributes that the set has at the time.
  void save(const StateWriter& to) const;
  void restore(const StateReader& from);

 private:
  friend class detail::Permutation;
  template <class Backend>
  void permuteOn(Backend& device, ArrayView<const int> order);
  template <class Backend>
  void appendOn(Backend& device, const ParticleBatch& batch, const BatchSelection& selected);
  template <class Backend>
  void moveOn(Backend& device, const FreeMotion& motion);
  /// Makes up for a motion that was put off.
  void moved() const {
    if (motion_) const_cast<ParticleSet*>(this)->moveNow();
  }
  void moveNow();
  /// Someone may change attributes or memory for all particles.
  void used() { ++uses_, moved(); }
  void makeRoom(std::int64_t particles);
  bool hasFew() const { return (most_ == kUnknown ? capacity() : most_) <= kFew; }
  detail::AttributeStorage* storage(std::string_view name) const;

  Device* device_;
  std::unique_ptr<detail::SpareMemory> spares_;
  std::vector<std::unique_ptr<detail::AttributeStorage>> storages_;
  Array<Vec4f> wideScratch_, places_;
  std::uint64_t scratchUses_ = 0, placesUses_ = 0;
  bool asksForMotionCodes_ = false;
  ArrayView<const Vec4f> motionCodes_;
  std::uint64_t uses_ = 0, motionCodesUse_ = 0;
  Array<Vec3f>* positions_ = nullptr;
  Array<Vec3f>* velocities_ = nullptr;
  Array<int>* ids_ = nullptr;
  Array<int> counter_;
  std::optional<FreeMotion> motion_;
  std::int64_t bound_ = 0;
  std::int64_t nextId_ = 0;
  static constexpr std::int64_t kUnknown = std::numeric_limits<std::int64_t>::max();
  std::int64_t most_ = kUnknown;
};

}  // namespace weir
