#include "nodes/particles/particle_set.h"
#include "nodes/particles/attribute_storage.h"

namespace weir {

namespace {

template <class T>
struct GatherElements {
  ArrayView<const T> from;
  ArrayView<const int> order;
  ArrayView<T> to;
  WEIR_HD void operator()(std::int64_t k) const { to[k] = from[order[k]]; }
};

template <class T>
struct ZeroBehind {
  ArrayView<T> values;
  const int* count;
  WEIR_HD void operator()(std::int64_t k) const { values[*count + k] = T{}; }
};

struct AppendBatch {
  ArrayView<const Vec3f> newPositions, newVelocities;
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
void TypedStorage<T>::permuteOn(Backend& device, Count count, ArrayView<const int> order) {
  spare_.resize(values.size());
  parallelFor(device, "permute", count, GatherElements<T>{values.view(), order, spare_.view()});
  values.swap(spare_);
}

template <class T>
template <class Backend>
void TypedStorage<T>::zeroBehindOn(Backend& device, const int* count, std::int64_t amount) {
  parallelFor(device, "zero", amount, ZeroBehind<T>{values.view(), count});
}

template void TypedStorage<float>::permuteOn(ThisBackend&, Count, ArrayView<const int>);
template void TypedStorage<Vec3f>::permuteOn(ThisBackend&, Count, ArrayView<const int>);
template void TypedStorage<int>::permuteOn(ThisBackend&, Count, ArrayView<const int>);
template void TypedStorage<float>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);
template void TypedStorage<Vec3f>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);
template void TypedStorage<int>::zeroBehindOn(ThisBackend&, const int*, std::int64_t);

}  // namespace detail

template <class Backend>
void ParticleSet::appendOn(Backend& device, const ParticleBatch& batch, const BatchSelection& selected) {
  const Count count{batch.count, selected.kept};
  parallelFor(
      device, "append", count,
      AppendBatch{batch.positions.view(), batch.velocities.view(), selected.order, static_cast<int>(nextId_),
                  counter_.data(), positions_->view(), velocities_->view(), ids_->view()});
  parallelFor(device, "advance count", 1, Advance{counter_.data(), count});
}

template void ParticleSet::appendOn(ThisBackend&, const ParticleBatch&, const BatchSelection&);

}  // namespace weir
