// What a library without kernels for CUDA says on a CUDA device, as a plugin that was built without nvcc is
// one.
#ifndef WEIR_HAS_CUDA

#include <gtest/gtest.h>

#include "framework/compute/dispatch.h"
#include "tests/support/expect_error.h"

namespace weir::test {
namespace {

/// A CUDA device as such a library sees it. Does nothing.
class SomeCuda final : public Device {
 public:
  SomeCuda() : Device(DeviceKind::kCuda, "cuda:0") {}
  std::string description() const override { return "a CUDA device"; }
  void* allocate(std::size_t) override { return nullptr; }
  void release(void*, std::size_t) noexcept override {}
  std::shared_ptr<void> lend(void*) override { return nullptr; }
  MemoryUse memoryUse() const override { return {}; }
  std::size_t availableMemory() const override { return 0; }
  void upload(void*, const void*, std::size_t) override {}
  void download(void*, const void*, std::size_t) override {}
  void copy(void*, const void*, std::size_t) override {}
  void fillBytes(void*, int, std::size_t) override {}
  void synchronize() override {}
};

TEST(Dispatch, WithoutKernelsForCudaItIsRefused) {
  SomeCuda cuda;
  bool called = false;
  const Error e = errorOf([&] { dispatch(static_cast<Device&>(cuda), [&](auto&) { called = true; }); });
  EXPECT_FALSE(called);
  EXPECT_EQ(e.kind(), ErrorKind::kSimulation);
  EXPECT_CONTAINS(e.what(), "no kernels for CUDA");
  EXPECT_CONTAINS(e.what(), "--device cpu");
}

}  // namespace
}  // namespace weir::test

#endif
