#include <algorithm>
#include <array>
#include <iterator>
#include <limits>
#include <numeric>
#include <vector>

#include "framework/base/error.h"
#include "framework/compute/dispatch.h"
#include "framework/particles/pack_layout.h"
#include "framework/particles/particle_set.h"

namespace weir {

using detail::PackedColumns;

/// The columns of a layout, as many at a time as a launch takes. f(columns)
template <class F>
void ParticleSet::forEachPacked(const PackLayout& layout, std::uint32_t* buffer, std::int64_t particles,
                                const F& f) {
  PackedColumns columns;
  for (const AttributeInfo& info : layout.attributes()) {
    const Storage found = storage(info.name);
    if (found == nullptr || found->info().type != info.type)
      throw simulationError("these particles have no attribute '" + info.name + "' of type " +
                                std::string(nameOf(info.type)) + ", which packed ones have",
                            PackLayout(*this).describe());
    const auto [words, wordsInOne] = found->words();
    columns.all[columns.used++] = {words.data, buffer, wordsInOne};
    buffer += particles * wordsInOne;
    if (columns.used < PackedColumns::kMax) continue;
    f(columns);
    columns.used = 0;
  }
  if (columns.used > 0) f(columns);
}

void ParticleSet::pack(const PackLayout& layout, ArrayView<const int> indices, Array<std::byte>& to) {
  settle();
  to.resizeDiscarding(layout.bytesOf(indices.size));
  if (indices.size == 0) return;
  forEachPacked(layout, reinterpret_cast<std::uint32_t*>(to.data()), indices.size, [&](const auto& columns) {
    dispatch(*device_, [&](auto& device) { packOn(device, columns, indices); });
  });
}

void ParticleSet::pack(const PackLayout& layout, std::int64_t first, std::int64_t count,
                       Array<std::byte>& to) {
  settle();
  to.resizeDiscarding(layout.bytesOf(count));
  if (count == 0) return;
  forEachPacked(layout, reinterpret_cast<std::uint32_t*>(to.data()), count, [&](const auto& columns) {
    for (int c = 0; c < columns.used; ++c) {
      const auto& [elements, packed, words] = columns.all[c];
      device_->copy(packed, elements + first * words, std::size_t(count * words) * sizeof(*packed));
    }
  });
}

void ParticleSet::unpack(const PackLayout& layout, ArrayView<const std::byte> from, std::int64_t particles,
                         const Count& first) {
  // Nothing is written to the buffer.
  auto* words = reinterpret_cast<std::uint32_t*>(const_cast<std::byte*>(from.data));
  forEachPacked(layout, words, particles, [&](const auto& columns) {
    dispatch(*device_, [&](auto& device) { unpackOn(device, columns, particles, first); });
  });
}

/// Attributes that do not come with them start as those of the newly born do.
void ParticleSet::zeroMissing(const PackLayout& layout, std::int64_t particles, const Count& first) {
  for (const Storage& storage : storages_) {
    const std::vector<AttributeInfo>& packed = layout.attributes();
    if (std::any_of(packed.begin(), packed.end(),
                    [&](const auto& info) { return info.name == storage->info().name; }))
      continue;
    const auto [words, wordsInOne] = storage->words();
    dispatch(*device_, [&](auto& device) { zeroFromOn(device, words, wordsInOne, first, particles); });
  }
}

void ParticleSet::checkFits(std::int64_t particles) const {
  if (particles > std::numeric_limits<int>::max())
    throw simulationError("the fluid would get more than 2,147,483,647 particles on one device",
                          "fewer particles, or more devices");
}

void ParticleSet::appendPacked(const PackLayout& layout, ArrayView<const std::byte> from) {
  const std::int64_t particles = layout.particlesIn(from.size);
  if (particles == 0) return;
  checkFits(bound_ + particles);
  settle();
  rearrange();
  makeRoom(bound_ + particles);
  const Count behind = count();
  zeroMissing(layout, particles, behind);
  unpack(layout, from, particles, behind);
  dispatch(*device_, [&](auto& device) { countMoreOn(device, particles); });
  bound_ += particles;
}

HaloRange ParticleSet::appendHalo(const PackLayout& layout, ArrayView<const std::byte> from) {
  const HaloRange range{halo_, layout.particlesIn(from.size)};
  if (range.count == 0) return range;
  // Where owned particles end is to be known on the host from here on.
  if (halo_ == 0) refreshCount();
  checkFits(bound_ + halo_ + range.count);
  settle();
  moveElements();
  makeRoom(bound_ + halo_ + range.count);
  const Count behind(bound_ + halo_);
  zeroMissing(layout, range.count, behind);
  unpack(layout, from, range.count, behind);
  halo_ += range.count;
  return range;
}

void ParticleSet::refreshHalo(const PackLayout& layout, ArrayView<const std::byte> from,
                              const HaloRange& range) {
  if (layout.particlesIn(from.size) != range.count || range.first < 0 || range.first + range.count > halo_)
    throw simulationError("found the attributes of " + std::to_string(layout.particlesIn(from.size)) +
                              " particles for " + std::to_string(range.count) + " of the halo, from " +
                              std::to_string(range.first) + " on",
                          "as many as there are, within a halo of " + std::to_string(halo_));
  if (range.count == 0) return;
  settle();
  unpack(layout, from, range.count, bound_ + range.first);
  for (const AttributeInfo& info : layout.attributes()) storage(info.name)->changed();
}

void ParticleSet::dropHalo() {
  if (halo_ > 0) rearrange();
}

void ParticleSet::remove(std::vector<int> indices) {
  if (indices.empty()) return;
  std::sort(indices.begin(), indices.end());
  const auto all = static_cast<int>(refreshCount()), kept = all - static_cast<int>(indices.size());
  const auto behind = std::lower_bound(indices.begin(), indices.end(), kept);
  const Array<int> to(*device_, std::vector<int>(indices.begin(), behind));
  std::vector<int> last(std::size_t(all - kept));
  std::iota(last.begin(), last.end(), kept);
  std::vector<int> staying;
  std::set_difference(last.begin(), last.end(), behind, indices.end(), std::back_inserter(staying));
  const Array<int> from(*device_, staying);

  settle();
  rearrange();
  PackedColumns columns;
  const auto move = [&] {
    dispatch(*device_, [&](auto& device) { moveOn(device, columns, from.view(), to.view()); });
    columns.used = 0;
  };
  for (const Storage& storage : storages_) {
    if (storage->info().derived) continue;
    const auto [words, wordsInOne] = storage->words();
    columns.all[columns.used++] = {words.data, nullptr, wordsInOne};
    if (columns.used == PackedColumns::kMax) move();
  }
  if (columns.used > 0) move();
  bound_ = kept;
  device_->upload(counter_.data(), &kept, sizeof(kept));
}

}  // namespace weir
