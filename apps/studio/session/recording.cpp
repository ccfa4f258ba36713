#include "apps/studio/session/recording.h"

namespace weir::studio {

namespace {

constexpr std::int64_t kPlace = 160;

}  // namespace

std::int64_t bytesOf(const Packet& packet) {
  return packet ? static_cast<std::int64_t>(packet->size()) + kPlace : 0;
}

std::int64_t bytesOf(const RunState& state) {
  if (!state) return 0;
  std::int64_t bytes = kPlace;
  for (const auto& [path, array] : *state)
    bytes += static_cast<std::int64_t>(path.size() + array.data.size()) + kPlace;
  return bytes;
}

}  // namespace weir::studio
