// CudaDevice in builds without CUDA: the class links everywhere, and says why it cannot be constructed.
#ifndef WEIR_HAS_CUDA

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/compute/cuda_support.h"

namespace weir {

struct CudaDevice::Impl {};

CudaDevice::CudaDevice(int index) : Device(DeviceKind::kCuda, "cuda:" + std::to_string(index)) {
  throw usageError("device '" + name() + "' cannot be used: " + detail::probeCuda().reason);
}

CudaDevice::~CudaDevice() = default;

// No object exists that these could be called on.
namespace {
[[noreturn]] void unreachable() {
  throw InternalError("a CUDA device in a build without CUDA");
}
}  // namespace

std::string CudaDevice::description() const {
  unreachable();
}
void* CudaDevice::allocate(std::size_t) {
  unreachable();
}
void CudaDevice::release(void*, std::size_t) noexcept {}
std::shared_ptr<void> CudaDevice::lend(void*) {
  return nullptr;
}
MemoryUse CudaDevice::memoryUse() const {
  unreachable();
}
std::size_t CudaDevice::availableMemory() const {
  unreachable();
}
void CudaDevice::upload(void*, const void*, std::size_t) {
  unreachable();
}
void CudaDevice::download(void*, const void*, std::size_t) {
  unreachable();
}
void CudaDevice::copy(void*, const void*, std::size_t) {
  unreachable();
}
void CudaDevice::fillBytes(void*, int, std::size_t) {
  unreachable();
}
void CudaDevice::synchronize() {
  unreachable();
}
void CudaDevice::beginBatch() {
  unreachable();
}
void CudaDevice::endBatch() {
  unreachable();
}
void CudaDevice::dropBatch() noexcept {}
CUstream_st* CudaDevice::stream() const {
  unreachable();
}
detail::LaunchQueue& CudaDevice::launches() const {
  unreachable();
}
int CudaDevice::index() const {
  unreachable();
}
int CudaDevice::multiprocessors() const {
  unreachable();
}
void CudaDevice::check(int, std::string_view) const {
  unreachable();
}

bool builtWithCuda() {
  return false;
}

detail::CudaProbe detail::probeCuda() {
  return {0, "this build of Weir has no CUDA back end"};
}

std::unique_ptr<detail::ReadbackSlot> detail::makeCudaReadbackSlot(CudaDevice&, std::size_t) {
  unreachable();
}

std::unique_ptr<detail::HostCopyMemory> detail::makeCudaHostCopyMemory(CudaDevice&) {
  unreachable();
}

std::unique_ptr<detail::Moment> detail::makeCudaMoment(CudaDevice&) {
  unreachable();
}

void detail::copyBetween(CudaDevice&, void*, const CudaDevice&, const void*, std::size_t) {
  unreachable();
}

}  // namespace weir

#endif
