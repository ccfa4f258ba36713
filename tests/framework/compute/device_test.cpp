#include "framework/compute/dispatch.h"

#include <algorithm>
#include <cstring>
#include <thread>

#include "framework/base/check.h"
#include "framework/compute/array.h"
#include "framework/compute/frame_copy.h"
#include "framework/compute/host_copy.h"
#include "framework/compute/memory_pool.h"
#include "framework/compute/readback.h"
#include "tests/framework/compute/kernels.h"
#include "tests/support/devices.h"
#include "tests/support/variable_for.h"

namespace weir::test {
namespace {

using DeviceTest = OnDevice;
WEIR_ON_EVERY_DEVICE(DeviceTest);

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// The usage error of openDevice.
Error openError(const std::string& spec, int threads = 0) {
  try {
    openDevice(spec, threads);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "'" << spec << "' was opened";
  return usageError("");
}

TEST(OpenDevice, RefusesWhatIsNoDevice) {
  for (const char* spec :
       {"", "gpu", "CPU", "cuda:", "cuda:-1", "cuda:1x", "cuda: 1", "cuda:99999999999999", "cpu:0"}) {
    const Error error = openError(spec);
    EXPECT_EQ(error.kind(), ErrorKind::kUsage) << spec;
    EXPECT_TRUE(contains(error.what(), "'" + std::string(spec) + "'")) << error.what();
    EXPECT_TRUE(contains(error.allowed(), "auto")) << error.allowed();
    EXPECT_TRUE(contains(error.allowed(), "cpu")) << error.allowed();
  }
}

TEST(OpenDevice, RefusesCudaDevicesThatAreNotThere) {
  const Error far = openError("cuda:1234");
  EXPECT_EQ(far.kind(), ErrorKind::kUsage);
  EXPECT_TRUE(contains(far.what(), "cuda:1234")) << far.what();
  if (availableDevices().size() > 1) return;
  const Error error = openError("cuda");
  EXPECT_EQ(error.kind(), ErrorKind::kUsage);
  EXPECT_TRUE(contains(error.what(), "CUDA")) << error.what();
}

TEST(OpenDevice, RefusesANegativeNumberOfThreads) {
  EXPECT_EQ(openError("cpu", -1).kind(), ErrorKind::kUsage);
}

TEST(OpenDevice, AutoTakesCudaWhereItWorks) {
  EXPECT_EQ(openDevice("auto")->name(), availableDevices().size() > 1 ? "cuda:0" : "cpu");
}

TEST(OpenDevice, TakesTheNumberOfThreads) {
  const std::unique_ptr<Device> device = openDevice("cpu", 3);
  EXPECT_EQ(static_cast<CpuDevice&>(*device).threads(), 3);
  EXPECT_GE(CpuDevice().threads(), 1);
}

TEST(ListDevices, StartsWithTheCpuAndNamesWhatOpens) {
  const std::vector<DeviceInfo> devices = listDevices();
  ASSERT_FALSE(devices.empty());
  EXPECT_EQ(devices[0].name, "cpu");
  EXPECT_EQ(devices.size() > 1, availableDevices().size() > 1);
  for (const DeviceInfo& info : devices) EXPECT_FALSE(info.description.empty());
}

TEST_P(DeviceTest, DescribesItself) {
  EXPECT_TRUE(contains(device->description(), "GiB")) << device->description();
  EXPECT_EQ(device->name(), GetParam() == "cpu" ? "cpu" : "cuda:0");
}

TEST_P(DeviceTest, CopiesBytesInOrder) {
  const std::vector<int> values{3, 1, 4, 1, 5, 9, 2, 6};
  Array<int> a(*device, values), b(*device, 8);
  device->copy(b.data(), a.data(), 8 * sizeof(int));
  a.fillZero();
  EXPECT_EQ(b.toHost(), values);
  EXPECT_EQ(a.toHost(), std::vector<int>(8, 0));
  EXPECT_EQ(b.toHost(3), (std::vector<int>{3, 1, 4}));
  EXPECT_EQ(device->blockingReadbacks(), 3u);
  device->fillBytes(b.data(), 0xff, 4 * sizeof(int));
  EXPECT_EQ(b.toHost(), (std::vector<int>{-1, -1, -1, -1, 5, 9, 2, 6}));
  device->synchronize();
}

TEST_P(DeviceTest, ArraysKeepTheirContentsWhenTheyGrow) {
  Array<int> array(*device, std::vector<int>{1, 2, 3});
  array.resize(100000);
  EXPECT_EQ(array.toHost(3), (std::vector<int>{1, 2, 3}));
  Array<int> moved = std::move(array);
  EXPECT_EQ(moved.size(), 100000);
  EXPECT_EQ(moved.toHost(3), (std::vector<int>{1, 2, 3}));
  EXPECT_TRUE(Array<int>(*device).toHost().empty());
}

TEST_P(DeviceTest, MemoryIsAlignedCountedAndReused) {
  void* a = device->allocate(1000);
  void* b = device->allocate(1);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a) % 256, 0u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(b) % 256, 0u);
  const MemoryUse two = device->memoryUse();
  EXPECT_EQ(two.inUse, 1024u + 256u);
  EXPECT_EQ(two.allocations, 2u);
  device->release(a, 1000);
  EXPECT_EQ(device->memoryUse().inUse, 256u);
  EXPECT_EQ(device->memoryUse().reserved, two.reserved);
  EXPECT_EQ(device->allocate(990), a);
  EXPECT_EQ(device->memoryUse().allocations, 2u);
  EXPECT_EQ(device->memoryUse().peak, two.inUse);
  device->release(a, 990);
  device->release(b, 1);
  EXPECT_EQ(device->memoryUse().inUse, 0u);
  EXPECT_EQ(device->allocate(0), nullptr);
  device->release(nullptr, 0);
}

TEST_P(DeviceTest, MemoryThatIsLentIsGivenToNobody) {
  constexpr std::size_t kBytes = 5000;
  void* memory = device->allocate(kBytes);
  std::shared_ptr<void> loan = device->lend(memory);
  const std::shared_ptr<void> another = device->lend(memory);
  EXPECT_EQ(loan.get(), memory);
  device->release(memory, kBytes);
  EXPECT_GE(device->memoryUse().inUse, kBytes);
  loan.reset();
  void* other = device->allocate(kBytes);
  EXPECT_NE(other, memory);
  device->release(other, kBytes);
}

TEST_P(DeviceTest, MemoryThatWasLentIsUsedAgain) {
  constexpr std::size_t kBytes = 5000;
  void* memory = device->allocate(kBytes);
  const std::size_t inUse = device->memoryUse().inUse;
  std::shared_ptr<void> loan = device->lend(memory);
  device->release(memory, kBytes);
  loan.reset();
  EXPECT_LT(device->memoryUse().inUse, inUse);
  EXPECT_EQ(device->allocate(kBytes), memory);
  loan = device->lend(memory);
  loan.reset();  // lent and given back before it is released
  EXPECT_EQ(device->memoryUse().inUse, inUse);
  device->release(memory, kBytes);
  EXPECT_LT(device->memoryUse().inUse, inUse);
}

TEST_P(DeviceTest, RunningOutOfMemoryNamesTheSize) {
  for (const std::size_t bytes : {std::size_t{1} << 50, ~std::size_t{0}}) {
    try {
      device->allocate(bytes);
      FAIL() << "got " << bytes << " bytes";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kSimulation);
      EXPECT_TRUE(contains(error.what(), std::to_string(bytes))) << error.what();
      EXPECT_TRUE(contains(error.what(), "free")) << error.what();
    }
  }
  // The device still works.
  EXPECT_EQ(Array<int>(*device, std::vector<int>{7}).toHost()[0], 7);
}

TEST_P(DeviceTest, GoesOnAfterABlockThatCouldNotBeHad) {
  constexpr std::size_t kSmall = 1000, kLarge = 100000;
  const VariableFor fault("WEIR_TEST_FAIL_ALLOCATION", "2");
  const std::unique_ptr<Device> own = openDevice(GetParam());
  void* first = own->allocate(kSmall);
  EXPECT_THROW(own->allocate(kLarge), Error);
  EXPECT_EQ(own->memoryUse().allocations, 1u);
  void* second = own->allocate(kLarge);
  EXPECT_NE(second, nullptr);
  own->release(first, kSmall);
  own->release(second, kLarge);
  EXPECT_EQ(own->memoryUse().inUse, 0u);
}

TEST_P(DeviceTest, ReadbackComesWithoutABlockingRead) {
  Array<std::int64_t> values(*device, 200000);
  dispatch(*device, [&](auto& d) { writeSquares(d, 200000, values.view()); });
  Readback<std::int64_t> readback(*device);
  EXPECT_FALSE(readback.pending());
  EXPECT_EQ(readback.poll(), std::nullopt);
  EXPECT_TRUE(readback.request(values.data() + 1000));
  EXPECT_TRUE(readback.pending());
  EXPECT_FALSE(readback.request(values.data() + 5)) << "one request at a time";
  // What is written after the request does not show.
  values.fillZero();
  std::optional<std::int64_t> got;
  while (!got.has_value()) got = readback.poll();
  EXPECT_EQ(*got, 1000001);
  EXPECT_FALSE(readback.pending());
  EXPECT_EQ(readback.poll(), std::nullopt);
  EXPECT_TRUE(readback.request(values.data() + 7));
  EXPECT_EQ(readback.wait(), 0);
  EXPECT_EQ(device->blockingReadbacks(), 0u);
}

TEST_P(DeviceTest, HostCopiesAreOfTheMomentTheyWereAskedFor) {
  Array<std::int64_t> values(*device, 200000);
  dispatch(*device, [&](auto& d) { writeSquares(d, 200000, values.view()); });
  HostCopy<std::int64_t> copy(*device);
  copy.resize(300000);
  copy.start(0, values.data() + 100000, 100000);
  copy.start(100000, values.data(), 200000);
  copy.start(300000, values.data(), 0);
  values.fillZero();
  std::vector<std::int64_t> got;
  std::thread([&] {
    const std::span<const std::int64_t> arrived = copy.wait();
    got.assign(arrived.begin(), arrived.end());
  }).join();
  ASSERT_EQ(got.size(), 300000u);
  EXPECT_TRUE(std::equal(got.begin(), got.begin() + 100000, got.begin() + 200000));
  EXPECT_EQ(got[101000], 1000001);
  EXPECT_EQ(device->blockingReadbacks(), 0u);
  copy.resize(2);
  copy.start(0, values.data(), 2);
  EXPECT_EQ(copy.wait()[1], 0);
  EXPECT_EQ(copy.wait().size(), 2u);
  EXPECT_THROW(copy.start(1, values.data(), 2), InternalError);
}

TEST_P(DeviceTest, AHostCopyMayDieOnItsWay) {
  Array<std::int64_t> values(*device, 1000000);
  values.fillZero();
  HostCopy<std::int64_t> copy(*device);
  EXPECT_TRUE(copy.wait().empty());
  copy.resize(1000000);
  copy.start(0, values.data(), 1000000);
}

TEST_P(DeviceTest, FrameCopiesAreReadByAnotherDevice) {
  constexpr std::int64_t kMany = 3'000'000;
  Array<std::int64_t> values(*device, kMany);
  FrameCopy<std::int64_t> copy(*device);
  const auto readElsewhere = [&] {
    std::vector<std::int64_t> got;
    std::thread([&] {
      const std::unique_ptr<Device> reader = openDevice(GetParam());
      Array<std::int64_t> room(*reader), read(*reader);
      const ArrayView<const std::int64_t> seen = copy.on(*reader, room);
      read.resize(seen.size);
      reader->copy(read.data(), seen.data, static_cast<std::size_t>(seen.size) * sizeof(std::int64_t));
      got = read.toHost();
    }).join();
    return got;
  };
  EXPECT_TRUE(readElsewhere().empty());
  const auto expectSquares = [&](std::int64_t count) {
    dispatch(*device, [&](auto& d) { writeSquares(d, kMany, values.view()); });
    copy.start(values, count);
    values.fillZero();
    const std::vector<std::int64_t> got = readElsewhere();
    ASSERT_EQ(got.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(copy.size(), count);
    dispatch(*device, [&](auto& d) { writeSquares(d, kMany, values.view()); });
    const std::vector<std::int64_t> wanted = values.toHost(count);
    EXPECT_EQ(got, wanted);
  };
  for (const std::int64_t count : {std::int64_t{1000}, kMany, std::int64_t{7}}) expectSquares(count);
  EXPECT_THROW(copy.start(values, kMany + 1), InternalError);
  const std::unique_ptr<Device> fewThreads = openDevice("cpu", 2);
  Array<std::int64_t> room(*fewThreads);
  if (device->kind() == DeviceKind::kCuda) {
    EXPECT_THROW(copy.on(*fewThreads, room), InternalError);
    // With more than half of the device in use, the next copy that needs memory goes to the host.
    const Array<char> max(*device, static_cast<std::int64_t>(device->availableMemory() * 3 / 5));
    const std::size_t before = device->memoryUse().inUse;
    FrameCopy<std::int64_t> late(*device);
    late.start(values, kMany);
    EXPECT_EQ(device->memoryUse().inUse, before);
    copy = std::move(late);
    expectSquares(kMany);
  } else {
    EXPECT_EQ(copy.on(*fewThreads, room).size, 7);
  }
}

TEST_P(DeviceTest, AReadbackMayDieWhileItIsPending) {
  Array<std::int64_t> values(*device, 1000000);
  values.fillZero();
  Readback<std::int64_t> readback(*device);
  EXPECT_TRUE(readback.request(values.data()));
}

#ifndef WEIR_HAS_CUDA
TEST(CudaDevice, SaysThatTheBuildHasNone) {
  EXPECT_FALSE(builtWithCuda());
  EXPECT_THROW(CudaDevice(0), Error);
}
#endif

TEST(MemoryPool, WastesAtMostAnEighth) {
  EXPECT_EQ(MemoryPool::sizeClass(0), 0u);
  EXPECT_EQ(MemoryPool::sizeClass(~std::size_t{0}), 0u);
  for (std::size_t bytes = 1; bytes < (std::size_t{1} << 40); bytes += bytes / 3 + 1) {
    const std::size_t size = MemoryPool::sizeClass(bytes);
    EXPECT_GE(size, bytes);
    EXPECT_EQ(size % 256, 0u);
    EXPECT_LE(size - bytes, std::max<std::size_t>(255, bytes / 8)) << bytes;
    EXPECT_EQ(MemoryPool::sizeClass(size), size);
  }
}

/// A system with little memory, for the pool.
struct SmallSystem {
  std::size_t left;
  int blocks = 0;

  MemoryPool pool() {
    return {[this](std::size_t bytes) -> void* {
              if (bytes > left) return nullptr;
              left -= bytes;
              ++blocks;
              return ::operator new(bytes);
            },
            [this](void* memory, std::size_t bytes) {
              left += bytes;
              --blocks;
              ::operator delete(memory);
            }};
  }
};

TEST(MemoryPool, GivesIdleBlocksBackBeforeItGivesUp) {
  SmallSystem system{10000};
  {
    MemoryPool pool = system.pool();
    void* a = pool.allocate(6144);
    pool.release(a, 6144);
    EXPECT_EQ(system.blocks, 1);
    void* b = pool.allocate(8192);
    ASSERT_NE(b, nullptr);
    EXPECT_EQ(system.blocks, 1);
    EXPECT_EQ(pool.use().reserved, 8192u);
    EXPECT_EQ(pool.allocate(8192), nullptr);
    pool.release(b, 8192);
  }
  EXPECT_EQ(system.blocks, 0);
  EXPECT_EQ(system.left, 10000u);
}

TEST(MemoryPool, ForgetsBlocksThatNobodyWantsAnyMore) {
  SmallSystem system{1000000};
  MemoryPool pool = system.pool();
  pool.release(pool.allocate(6144), 6144);
  for (int i = 0; i < 5000; ++i) pool.release(pool.allocate(256), 256);
  EXPECT_EQ(system.blocks, 2) << "a steady state gives nothing back";
  void* kept = pool.allocate(256);
  pool.release(pool.allocate(512), 512);
  EXPECT_EQ(system.blocks, 2) << "the next growth does";
  EXPECT_EQ(pool.use().reserved, 256u + 512u);
  pool.release(kept, 256);
}

}  // namespace
}  // namespace weir::test
