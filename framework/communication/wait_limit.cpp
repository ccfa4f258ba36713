#include "framework/communication/wait_limit.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <string>

#include "framework/base/text.h"

namespace weir {

std::optional<std::chrono::duration<double>> rankWaitLimit() {
  const char* const text = std::getenv("WEIR_RANK_TIMEOUT");
  if (text == nullptr) return std::nullopt;
  const std::string given = text;
  double seconds = 0;
  const auto [end, error] = std::from_chars(given.data(), given.data() + given.size(), seconds);
  const bool whole = error == std::errc() && end == given.data() + given.size();
  if (!whole || !std::isfinite(seconds) || !(seconds > 0))
    throw usageError("WEIR_RANK_TIMEOUT is " + printable(given), "a number of seconds above 0");
  return std::chrono::duration<double>(seconds);
}

Error waitedTooLong(int forRank, std::chrono::duration<double> limit) {
  const std::string seconds = std::to_string(std::lround(std::ceil(limit.count())));
  return simulationError("rank " + std::to_string(forRank) + " has not been heard of for " + seconds + " s",
                         {}, "look for what it waits for; or set WEIR_RANK_TIMEOUT to more, if it was busy");
}

}  // namespace weir
