// Bytes that go from one device to another of the same kind, on another thread.
#include "framework/compute/parcel.h"
#include "framework/compute/dispatch.h"

#include <numeric>
#include <thread>

#include "framework/compute/device_count.h"
#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"

namespace weir::test {
namespace {

using ParcelTest = OnDevice;
WEIR_ON_EVERY_DEVICE(ParcelTest);

/// Devices of that kind: the same one once more, and another GPU where there is one.
std::vector<std::unique_ptr<Device>> readersFor(const Device& sender) {
  std::vector<std::unique_ptr<Device>> readers;
  readers.push_back(openDevice(sender.name()));
  if (sender.kind() == DeviceKind::kCuda && cudaDeviceCount() > 1) readers.push_back(openDevice("cuda:1"));
  return readers;
}

TEST_P(ParcelTest, BringsWhatTheSenderHasWrittenBefore) {
  constexpr std::int64_t kCount = 1 << 20;
  for (const std::unique_ptr<Device>& reader : readersFor(*device)) {
    Array<std::byte> written(*device, kCount * std::int64_t{sizeof(std::int64_t)});
    dispatch(*device, [&](auto& d) {
      writeSquares(d, kCount, {reinterpret_cast<std::int64_t*>(written.data()), kCount});
    });
    const Parcel parcel(std::move(written));
    EXPECT_EQ(parcel.size(), kCount * std::int64_t{sizeof(std::int64_t)});
    Array<std::int64_t> read(*reader, kCount);
    std::jthread([&] { parcel.copyTo(*reader, read.data()); }).join();
    const std::vector<std::int64_t> values = read.toHost();
    for (std::int64_t i = 0; i < kCount; ++i) ASSERT_EQ(values[std::size_t(i)], i * i + 1) << reader->name();
  }
}

TEST_P(ParcelTest, MayBeEmpty) {
  const Parcel parcel(Array<std::byte>(*device, 0));
  EXPECT_EQ(parcel.size(), 0);
  parcel.copyTo(*device, nullptr);
  EXPECT_TRUE(parcel.toHost().empty());
}

}  // namespace
}  // namespace weir::test
