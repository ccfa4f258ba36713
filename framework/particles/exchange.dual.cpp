// Particles leave a set and come to one: packing, unpacking, and removal.
#include "framework/compute/parallel.h"
#include "framework/particles/pack_layout.h"
#include "framework/particles/particle_set.h"

namespace weir {

namespace {

using detail::PackedColumns;

/// A word may be read from where the next particle's stands; so neighbouring threads have neighbouring words.
struct Pack {
  PackedColumns columns;
  ArrayView<const int> indices;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = indices[k];
    for (int c = 0; c < columns.used; ++c) {
      const PackedColumns::Column& column = columns.all[c];
      for (int w = 0; w < column.words; ++w)
        column.packed[k * column.words + w] = column.elements[i * column.words + w];
    }
  }
};

struct Unpack {
  PackedColumns columns;
  Count first;  // where they go

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = first.get() + k;
    for (int c = 0; c < columns.used; ++c) {
      const PackedColumns::Column& column = columns.all[c];
      for (int w = 0; w < column.words; ++w)
        column.elements[i * column.words + w] = column.packed[k * column.words + w];
    }
  }
};

struct Move {
  PackedColumns columns;
  ArrayView<const int> from, to;

  WEIR_HD void operator()(std::int64_t k) const {
    const std::int64_t i = from[k], j = to[k];
    for (int c = 0; c < columns.used; ++c) {
      const PackedColumns::Column& column = columns.all[c];
      for (int w = 0; w < column.words; ++w)
        column.elements[j * column.words + w] = column.elements[i * column.words + w];
    }
  }
};

}  // namespace

template <class Backend>
void ParticleSet::packOn(Backend& device, const PackedColumns& columns, ArrayView<const int> indices) {
  parallelFor(device, "pack", indices.size, Pack{columns, indices});
}

template <class Backend>
void ParticleSet::unpackOn(Backend& device, const PackedColumns& columns, std::int64_t amount,
                           const Count& first) {
  parallelFor(device, "unpack", amount, Unpack{columns, first});
}

template <class Backend>
void ParticleSet::moveOn(Backend& device, const PackedColumns& columns, ArrayView<const int> from,
                         ArrayView<const int> to) {
  parallelFor(device, "fill places", from.size, Move{columns, from, to});
}

template void ParticleSet::packOn(ThisBackend&, const PackedColumns&, ArrayView<const int>);
template void ParticleSet::unpackOn(ThisBackend&, const PackedColumns&, std::int64_t, const Count&);
template void ParticleSet::moveOn(ThisBackend&, const PackedColumns&, ArrayView<const int>,
                                  ArrayView<const int>);

}  // namespace weir
