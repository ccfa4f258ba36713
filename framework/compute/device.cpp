#include "framework/compute/device.h"

#include <charconv>
#include <cstring>

#include <fmt/format.h>

#include "framework/base/error.h"
#include "framework/base/value.h"
#include "framework/compute/cuda_support.h"
#include "framework/compute/device_count.h"
#include "framework/compute/dispatch.h"
#include "framework/compute/readback.h"

namespace weir {
namespace {

/// What may be written for a device on this machine, for messages.
std::string allowedDevices() {
  std::vector<std::string> names{"auto", "cpu"};
  const int count = detail::probeCuda().devices;
  if (count > 0) names.emplace_back("cuda");
  for (int i = 0; i < count; ++i) names.push_back(fmt::format("cuda:{}", i));
  return joinNames(names);
}

/// N of "cuda:N", 0 of "cuda", -1 of anything else.
int cudaIndex(std::string_view spec) {
  if (spec == "cuda") return 0;
  constexpr std::string_view kPrefix = "cuda:";
  if (!spec.starts_with(kPrefix)) return -1;
  const std::string_view digits = spec.substr(kPrefix.size());
  int index = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  return error == std::errc() && end == digits.data() + digits.size() ? index : -1;
}

std::unique_ptr<Device> openCuda(std::string_view spec, int index) {
  const detail::CudaProbe probe = detail::probeCuda();
  if (probe.devices == 0) {
    throw usageError(fmt::format("device '{}' cannot be used: {}", spec, probe.reason), allowedDevices());
  }
  if (index >= probe.devices) {
    throw usageError(fmt::format("device '{}' does not exist: this machine has {} CUDA device{}", spec,
                                 probe.devices, probe.devices == 1 ? "" : "s"),
                     allowedDevices());
  }
  return std::make_unique<CudaDevice>(index);
}

/// The first CUDA device that works, otherwise null.
std::unique_ptr<Device> firstWorkingCuda() {
  const int count = detail::probeCuda().devices;
  for (int index = 0; index < count; ++index) {
    try {
      return std::make_unique<CudaDevice>(index);
    } catch (const Error&) {
      // "auto" takes what works; listDevices says why this one does not.
    }
  }
  return nullptr;
}

class CpuReadbackSlot final : public detail::ReadbackSlot {
 public:
  explicit CpuReadbackSlot(std::size_t size) : bytes_(size) {}
  void start(const void* from) override { std::memcpy(bytes_.data(), from, bytes_.size()); }
  bool ready() override { return true; }
  void wait() override {}
  const void* bytes() const override { return bytes_.data(); }

 private:
  std::vector<std::byte> bytes_;
};

class CpuHostCopyMemory final : public detail::HostCopyMemory {
 public:
  void reserve(std::size_t bytes) override { bytes_ = std::make_unique_for_overwrite<std::byte[]>(bytes); }
  void start(std::size_t at, const void* from, std::size_t bytes) override {
    std::memcpy(bytes_.get() + at, from, bytes);
  }
  void wait() override {}
  const void* bytes() const override { return bytes_.get(); }

 private:
  std::unique_ptr<std::byte[]> bytes_;
};

/// What the CPU was asked for is done when the call returns.
class CpuMoment final : public detail::Moment {
 public:
  void set() override {}
  void letWait(Device&) override {}
};

}  // namespace

Device::Device(DeviceKind kind, std::string name) : kind_(kind), name_(std::move(name)) {}
Device::~Device() = default;

int cudaDeviceCount() {
  return detail::probeCuda().devices;
}

std::vector<DeviceInfo> listDevices() {
  std::vector<DeviceInfo> devices{{"cpu", CpuDevice().description()}};
  const int count = detail::probeCuda().devices;
  for (int index = 0; index < count; ++index) {
    const std::string name = fmt::format("cuda:{}", index);
    try {
      devices.push_back({name, CudaDevice(index).description()});
    } catch (const Error& error) {
      devices.push_back({name, "cannot be used: " + error.message()});
    }
  }
  return devices;
}

std::unique_ptr<Device> openDevice(std::string_view spec, int threads) {
  if (threads < 0) {
    throw usageError(fmt::format("{} is not a valid number of threads", threads),
                     "0 (one for every core) or more");
  }
  if (spec == "cpu") return std::make_unique<CpuDevice>(threads);
  if (spec == "auto") {
    std::unique_ptr<Device> cuda = firstWorkingCuda();
    return cuda != nullptr ? std::move(cuda) : std::make_unique<CpuDevice>(threads);
  }
  const int index = cudaIndex(spec);
  if (index < 0) throw usageError(fmt::format("'{}' is not a device", spec), allowedDevices());
  return openCuda(spec, index);
}

void detail::throwNoCudaKernels() {
  throw simulationError("this has no kernels for CUDA: it was built without nvcc", "--device cpu",
                        "build the plugin again on a machine with nvcc to run it on CUDA");
}

std::unique_ptr<detail::ReadbackSlot> detail::makeReadbackSlot(Device& device, std::size_t bytes) {
  if (device.kind() == DeviceKind::kCpu) return std::make_unique<CpuReadbackSlot>(bytes);
  return makeCudaReadbackSlot(static_cast<CudaDevice&>(device), bytes);
}

std::unique_ptr<detail::HostCopyMemory> detail::makeHostCopyMemory(Device& device) {
  if (device.kind() == DeviceKind::kCpu) return std::make_unique<CpuHostCopyMemory>();
  return makeCudaHostCopyMemory(static_cast<CudaDevice&>(device));
}

std::unique_ptr<detail::Moment> detail::makeMoment(Device& device) {
  if (device.kind() == DeviceKind::kCpu) return std::make_unique<CpuMoment>();
  return makeCudaMoment(static_cast<CudaDevice&>(device));
}

bool detail::hasRoomBeside(const Device& device, std::size_t bytes) {
  if (device.kind() == DeviceKind::kCpu) return true;
  const std::size_t available = device.availableMemory();
  return bytes <= available && available - bytes >= device.memoryUse().inUse;
}

}  // namespace weir
