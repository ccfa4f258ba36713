#include "framework/graph/memory_estimate.h"

#include <fmt/format.h>

#include <algorithm>

#include "framework/base/text.h"

namespace weir {

std::string shortBytes(double bytes) {
  constexpr const char* kUnits[] = {"bytes", "KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  std::size_t unit = 0;
  for (; bytes >= 1024 && unit + 1 < std::size(kUnits); ++unit) bytes /= 1024;
  return fmt::format("{:.{}f} {}", bytes, unit == 0 || bytes >= 100 ? 0 : 1, kUnits[unit]);
}

MemoryNeeds MemoryEstimate::total() const {
  MemoryNeeds sum;
  for (const Entry& entry : entries_) {
    sum.device += entry.needs.device;
    sum.certain += entry.needs.certain;
    sum.host += entry.needs.host;
    sum.particles += entry.needs.particles;
  }
  return sum;
}

std::string MemoryEstimate::remedyFor(double available) const {
  // All who can give way do so by the same share. Whole layers and particles are not quite proportional, and
  // what is free changes.
  available *= 0.9;
  double fixed = 0, elastic = 0;
  for (const Entry& entry : entries_) (entry.needs.remedy ? elastic : fixed) += entry.needs.device;
  if (elastic == 0 || fixed >= available) return "fewer particles, smaller grids, or another machine";
  std::string text;
  for (const Entry& entry : entries_) {
    if (!entry.needs.remedy) continue;
    const std::string remedy = entry.needs.remedy((available - fixed) / elastic);
    if (remedy.empty()) continue;  // it follows another node
    text += (text.empty() ? "" : ", ") + remedy;
    if (entries_.size() > 1) text += " for " + inQuotes(entry.node);
  }
  return text;
}

Error MemoryEstimate::tooMuch(double needed, double available, const std::string& where) const {
  const MemoryNeeds all = total();
  std::string largest;
  double max = 0;
  for (const Entry& entry : entries_)
    if (entry.needs.device > max) max = entry.needs.device, largest = entry.node;
  return sceneError(
      fmt::format("the scene needs {} of memory {}, {} of them for '{}' with up to {:.4g} "
                  "particles in all; there are {}",
                  shortBytes(needed), where, shortBytes(max), largest, all.particles, shortBytes(available)),
      remedyFor(available));
}

std::string MemoryEstimate::check(double available, const std::string& device) const {
  if (!(available > 0)) return {};
  const MemoryNeeds all = total();
  if (!(all.certain <= available)) throw tooMuch(all.certain, available, "on " + device);
  if (all.device <= available) return {};
  return fmt::format(
      "the scene may need up to {} of memory on {}, if no particles are removed; there are {}; safe: {}",
      shortBytes(all.device), device, shortBytes(available), remedyFor(available));
}

void MemoryEstimate::checkHost(double available) const {
  const double needed = total().host;
  if (available > 0 && !(needed <= available)) throw tooMuch(needed, available, "in the host");
}

}  // namespace weir
