#include "nodes/particles/particle_set.h"

#include "framework/compute/wide_access.h"
#include "nodes/particles/attribute_storage.h"

namespace weir {

namespace {

/// All attributes at once, so that the order is read but once.
struct Permute {
  static constexpr int kMost = 8;  // columns in one launch

  ArrayView<const int> order;
  detail::PermutedColumn columns[kMost];
  int used = 0;
  // Where particles are to move on their way; `position` and `velocity` are columns, or none.
  ParticleSet::Unmoved unmoved;
  int position = -1, velocity = -1;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = order[k];
    for (int c = 0; c < used; ++c) {
      const detail::PermutedColumn& column = columns[c];
      if (column.words == 1)
        column.to[k] = column.from[i];
      else if (c == position || c == velocity)
        storeInTwo(reinterpret_cast<Vec3f*>(column.to)[k], moved(i, c));
      else
        storeInTwo(reinterpret_cast<Vec3f*>(column.to)[k],
                   loadInTwo(reinterpret_cast<const Vec3f*>(column.from)[i]));
    }
  }

  WEIR_HD Vec3f moved(std::int64_t i, int c) const {
    const Vec3f v = unmoved.motion.velocity(loadInTwo(unmoved.velocities[i]));
    return c == velocity ? v : unmoved.motion.position(loadInTwo(unmoved.positions[i]), v);
  }
};

struct Move {
  FreeMotion motion;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = motion.velocity(velocities[i]);
    velocities[i] = v;
    positions[i] = motion.position(positions[i], v);
  }
};

template <class T>
struct ZeroBehind {
  ArrayView<T> values;
  const int* count;
  WEIR_HD void operator()(std::int64_t k) const { values[*count + k] = T{}; }
};

struct AppendBatch {
  ArrayView<const Vec3f> newPositions;
  ParticleBatch::VelocityView newVelocities;
  ArrayView<const int> order;  // empty for all
  int firstId;
  const int* count;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<int> ids;
  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = *count + k;
    const int from = order.size > 0 ? order[k] : static_cast<int>(k);
    positions[i] = newPositions[from];
    velocities[i] = newVelocities[from];
    ids[i] = firstId + from;
  }
};

struct Advance {
  int* count;
  Count amount;
  WEIR_HD void operator()(std::int64_t) const { *count += static_cast<int>(amount.get()); }
};

}  // namespace

namespace detail {

template <class T>
template <class Backend>
void TypedStorage<T>::zeroBehindOn(Backend& device, const int* count, std::int64_t amount) {
  parallelFor(device, "zero", amount, ZeroBehind<T>{values.view(), count});
}

template void TypedStorage<float>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);
template void TypedStorage<Vec3f>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);
template void TypedStorage<int>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);

}  // namespace detail

template <class Backend>
void ParticleSet::appendOn(Backend& device, const ParticleBatch& batch, const BatchSelection& selected) {
  const Count count{batch.count, selected.kept};
  parallelFor(
      device, "append", count,
      AppendBatch{batch.positions.view(), batch.velocityView(), selected.order, static_cast<int>(nextId_),
                  counter_.data(), positions_->view(), velocities_->view(), ids_->view()});
  parallelFor(device, "advance count", 1, Advance{counter_.data(), count});
}

template <class Backend>
void ParticleSet::permuteOn(Backend& device, ArrayView<const int> order) {
  std::vector<detail::AttributeStorage*> left;
  for (const auto& storage : storages_)
    if (!storage->info().derived) left.push_back(storage.get());
  // Where there are many particles, one attribute of each type at a time: the next of the type goes to where
  // the last one was.
  const std::size_t atOnce = hasFew() ? Permute::kMost : 1;
  while (!left.empty()) {
    Permute permute{order, {}, 0, unmoved()};
    std::size_t used[kAttributeTypes] = {};
    std::vector<std::pair<detail::AttributeStorage*, std::size_t>> begun;
    std::erase_if(left, [&](detail::AttributeStorage* storage) {
      std::size_t& spare = used[static_cast<int>(storage->info().type)];
      if (permute.used == Permute::kMost || spare == atOnce) return false;
      if (isToMove() && storage->info().name == "position") permute.position = permute.used;
      if (isToMove() && storage->info().name == "velocity") permute.velocity = permute.used;
      permute.columns[permute.used++] = storage->beginPermutation(spare);
      begun.emplace_back(storage, spare++);
      return true;
    });
    parallelFor(device, "permute", count(), permute);
    for (const auto& [storage, spare] : begun) storage->finishPermutation(spare);
  }
  motion_.reset();
}

template <class Backend>
void ParticleSet::moveOn(Backend& device, const FreeMotion& motion) {
  parallelFor(device, "move", count(), Move{motion, positions_->view(), velocities_->view()});
}

template void ParticleSet::moveOn(ThisBackend&, const FreeMotion&);

template void ParticleSet::permuteOn(ThisBackend&, ArrayView<const int>);
template void ParticleSet::appendOn(ThisBackend&, const ParticleBatch&, const BatchSelection&);

}  // namespace weir
