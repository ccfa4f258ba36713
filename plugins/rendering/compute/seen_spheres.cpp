#include "plugins/rendering/compute/seen_spheres.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace weir::rendering {

namespace {

template <class T>
Message messageOf(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {bytes.begin(), bytes.end()};
}

template <class T>
std::vector<T> valuesIn(const Message& message) {
  std::vector<T> values(message.size() / sizeof(T));
  if (!values.empty()) std::memcpy(values.data(), message.data(), message.size());
  return values;
}

/// Brings `own` to rank 0, which adds what others have in the order of ranks.
template <class T, class Add>
std::vector<T> broughtTogether(Communicator& ranks, std::vector<T> own, const Add& add) {
  if (ranks.rank() > 0) ranks.post(0, messageOf(own));
  for (int from = 1; ranks.rank() == 0 && from < ranks.size(); ++from)
    add(own, valuesIn<T>(ranks.receive(from)));
  return own;
}

}  // namespace

std::vector<SeenSphere> nearestOf(std::span<const SeenSphere> earlier, std::span<const SeenSphere> later) {
  std::vector<SeenSphere> nearest;
  nearest.reserve(earlier.size() + later.size());
  auto a = earlier.begin();
  for (const SeenSphere& b : later) {
    while (a != earlier.end() && a->sample < b.sample) nearest.push_back(*a++);
    const bool both = a != earlier.end() && a->sample == b.sample;
    const bool stays = both && std::pair(a->depthBits, b.view) < std::pair(b.depthBits, a->view);
    nearest.push_back(stays ? *a : b);
    if (both) ++a;
  }
  nearest.insert(nearest.end(), a, earlier.end());
  return nearest;
}

std::vector<SeenSphere> nearestOfRanks(Communicator& ranks, std::vector<SeenSphere> own) {
  return broughtTogether(ranks, std::move(own),
                         [](auto& all, const auto& more) { all = nearestOf(all, more); });
}

std::vector<std::uint32_t> nearestOfRanks(Communicator& ranks, std::vector<std::uint32_t> own) {
  return broughtTogether(ranks, std::move(own), [](auto& all, const auto& more) {
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = std::min(all[i], more[i]);
  });
}

}  // namespace weir::rendering
