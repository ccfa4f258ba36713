#include "apps/weir/bench/copy_bandwidth.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "framework/compute/array.h"

namespace weir::app {

namespace {

constexpr std::int64_t kBytes = std::int64_t{256} << 20;
constexpr int kRepetitions = 12;  // of which the first ones warm up

struct Copy {
  std::byte* to;
  const std::byte* from;
};

void copyRange(void* context, std::int64_t begin, std::int64_t end) {
  const Copy& copy = *static_cast<const Copy*>(context);
  std::memcpy(copy.to + begin, copy.from + begin, static_cast<std::size_t>(end - begin));
}

void copyOnce(Device& device, Copy copy) {
  constexpr std::int64_t kGrain = std::int64_t{1} << 20;
  if (device.kind() == DeviceKind::kCpu)
    static_cast<CpuBackend&>(device).forRanges(kBytes, kGrain, copyRange, &copy);
  else
    device.copy(copy.to, copy.from, kBytes);
  device.synchronize();
}

}  // namespace

double copyBandwidth(Device& device) {
  Array<std::byte> from(device, kBytes), to(device, kBytes);
  device.fillBytes(from.data(), 1, kBytes);
  device.synchronize();
  double min = 0;
  for (int k = 0; k < kRepetitions; ++k) {
    const auto start = std::chrono::steady_clock::now();
    copyOnce(device, {to.data(), from.data()});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    min = k == 0 ? seconds : std::min(min, seconds);
  }
  return 2.0 * kBytes / min;
}

}  // namespace weir::app
