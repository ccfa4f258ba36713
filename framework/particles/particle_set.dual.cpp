#include "framework/particles/particle_set.h"

#include <algorithm>

#include "framework/compute/eight.h"
#include "framework/particles/permutation.h"

namespace weir {

namespace {

struct Move {
  FreeMotion motion;
  ArrayView<Vec3f> positions, velocities;

  WEIR_HD void operator()(std::int64_t i) const {
    const Vec3f v = motion.velocity(velocities[i]);
    velocities[i] = v;
    positions[i] = motion.position(positions[i], v);
  }
};

struct ZeroFrom {
  ArrayView<std::uint32_t> words;
  int wordsInOne;
  Count first;
  WEIR_HD void operator()(std::int64_t k) const {
    std::uint32_t* const element = words.data + (first.get() + k) * wordsInOne;
    for (int word = 0; word < wordsInOne; ++word) element[word] = 0;
  }
};

struct AppendBatch {
  ArrayView<const Vec3f> newPositions;
  ParticleBatch::VelocityView newVelocities;
  ArrayView<const int> order;  // empty for all
  std::int64_t firstId;
  const int* count;
  ArrayView<Vec3f> positions, velocities;
  ArrayView<std::int64_t> ids;
  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = *count + k;
    const int from = order.size > 0 ? order[k] : static_cast<int>(k);
    positions[i] = newPositions[from];
    velocities[i] = newVelocities[from];
    ids[i] = firstId + from;
  }
};

template <class T>
struct AppendAttribute {
  ArrayView<const T> from;
  ArrayView<const int> order;  // empty for all
  const int* count;
  ArrayView<T> to;
  WEIR_HD void operator()(std::int64_t k) const { to[*count + k] = from[order.size > 0 ? order[k] : k]; }
};

#ifndef __CUDACC__

/// Column after column, so that a loop has nothing to ask.
struct PermuteRange {
  detail::Permute permute;

  void operator()(std::int64_t begin, std::int64_t end) const {
    const detail::Permute p = permute;
    const bool moves = p.unmoved.motion.dt != 0;
    for (int c = 0; c < p.used; ++c) {
      const detail::PermutedColumn column = p.columns[c];
      const auto fill = [&](auto* to, const auto& from) {
        for (std::int64_t k = begin; k < end; ++k) to[k] = from(p.order[k]);
      };
      auto* const vectors = reinterpret_cast<Vec3f*>(column.to);
      if (column.words == 1)
        fill(column.to, [&](int i) { return column.from[i]; });
      else if (column.words == detail::Permute::kWordsOfLong)
        fill(reinterpret_cast<std::uint64_t*>(column.to),
             [&](int i) { return reinterpret_cast<const std::uint64_t*>(column.from)[i]; });
      else if (column.words != detail::Permute::kWordsOfVector)
        for (std::int64_t k = begin; k < end; ++k) detail::Permute::copyWords(column, k, p.order[k]);
      else if (moves && c == p.position)
        fill(vectors, [&](int i) { return p.unmoved.position(i); });
      else if (moves && c == p.velocity)
        fill(vectors, [&](int i) { return p.unmoved.velocity(i); });
      else
        fill(vectors, [&](int i) { return reinterpret_cast<const Vec3f*>(column.from)[i]; });
    }
  }
};

#endif

struct Advance {
  int* count;
  Count amount;
  WEIR_HD void operator()(std::int64_t) const { *count += static_cast<int>(amount.get()); }
};

}  // namespace

template <class Backend>
void ParticleSet::zeroFromOn(Backend& device, ArrayView<std::uint32_t> words, int wordsInOne,
                             const Count& first, std::int64_t amount) {
  parallelFor(device, "zero", amount, ZeroFrom{words, wordsInOne, first});
}

template <class Backend>
void ParticleSet::appendOn(Backend& device, const ParticleBatch& batch, const BatchSelection& selected) {
  const bool isSelected = selected.kept != nullptr;
  const Count count{isSelected ? std::min(batch.count, selected.order.size) : batch.count, selected.kept};
  parallelFor(
      device, "append", count,
      AppendBatch{batch.positions.view(), batch.velocityView(), selected.order, nextId_, counter_.data(),
                  position_->values.view(), velocity_->values.view(), id_->values.view()});
  for (const BatchAttribute& brought : batch.attributes)
    std::visit(
        [&]<class T>(const Array<T>& values) {
          appendAttributeOn(device, brought.info, values, count, selected);
        },
        brought.values);
  countMoreOn(device, count);
}

template <class Backend>
void ParticleSet::countMoreOn(Backend& device, const Count& amount) {
  parallelFor(device, "advance count", 1, Advance{counter_.data(), amount});
}

template <class Backend, class T>
void ParticleSet::appendAttributeOn(Backend& device, const AttributeInfo& info, const Array<T>& values,
                                    const Count& count, const BatchSelection& selected) {
  WEIR_CHECK(values.size() >= count.bound);
  parallelFor(device, "append attribute", count,
              AppendAttribute<T>{values.view(), selected.order, counter_.data(), get<T>(info.name).write()});
}

template <class Backend>
void ParticleSet::permuteOn(Backend& device, ArrayView<const int> order) {
  for (detail::Permutation permutation(*this); permutation.isLeft(); permutation.finish())
#ifdef __CUDACC__
    parallelFor(device, "permute", count(), permutation.next(order));
#else
    forEachRange(device, "permute", count(), PermuteRange{permutation.next(order)});
#endif
}

template <class Backend>
void ParticleSet::moveOn(Backend& device, const FreeMotion& motion) {
  parallelFor(device, "move", count(), Move{motion, position_->values.view(), velocity_->values.view()});
}

template void ParticleSet::zeroFromOn(ThisBackend&, ArrayView<std::uint32_t>, int, const Count&,
                                      std::int64_t);
template void ParticleSet::countMoreOn(ThisBackend&, const Count&);
template void ParticleSet::moveOn(ThisBackend&, const FreeMotion&);

template void ParticleSet::permuteOn(ThisBackend&, ArrayView<const int>);
template void ParticleSet::appendOn(ThisBackend&, const ParticleBatch&, const BatchSelection&);

}  // namespace weir
