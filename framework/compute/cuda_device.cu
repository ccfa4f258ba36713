#include <cuda_runtime.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>

#include "framework/base/check.h"
#include "framework/base/error.h"
#include "framework/compute/allocation_fault.h"
#include "framework/compute/cuda_profiler.h"
#include "framework/compute/cuda_support.h"
#include "framework/compute/kernel_overlap.h"
#include "framework/compute/launch_queue.h"
#include "framework/compute/memory_pool.h"

namespace weir {
namespace {

std::string describeError(cudaError_t error) {
  return std::string(cudaGetErrorString(error)) + " (" + cudaGetErrorName(error) + ")";
}

/// Free memory of the current device, 0 if it does not say.
std::size_t freeMemory() {
  std::size_t free = 0, total = 0;
  if (cudaMemGetInfo(&free, &total) == cudaSuccess) return free;
  static_cast<void>(cudaGetLastError());
  return 0;
}

struct CopyCall {
  void* to;
  const void* from;
  std::size_t bytes;
};
constexpr detail::CallKind kCopy{
    [](const void* call, cudaStream_t stream) {
      const auto& c = *static_cast<const CopyCall*>(call);
      return cudaMemcpyAsync(c.to, c.from, c.bytes, cudaMemcpyDeviceToDevice, stream);
    },
    [](const void* call, cudaGraph_t graph, const cudaGraphNode_t* after, std::size_t afters,
       cudaGraphNode_t* node) {
      const auto& c = *static_cast<const CopyCall*>(call);
      return cudaGraphAddMemcpyNode1D(node, graph, after, afters, c.to, c.from, c.bytes,
                                      cudaMemcpyDeviceToDevice);
    },
    [](const void* call, cudaGraphExec_t graph, cudaGraphNode_t node) {
      const auto& c = *static_cast<const CopyCall*>(call);
      return cudaGraphExecMemcpyNodeSetParams1D(graph, node, c.to, c.from, c.bytes, cudaMemcpyDeviceToDevice);
    }};

struct FillCall {
  void* to;
  std::int64_t byte;
  std::size_t bytes;

  cudaMemsetParams parameters() const {
    const bool words = bytes % sizeof(int) == 0;
    cudaMemsetParams p{};
    p.dst = to;
    p.value = static_cast<unsigned>(byte & 0xff) * (words ? 0x01010101u : 1u);
    p.elementSize = words ? sizeof(int) : 1;
    p.width = bytes / p.elementSize;
    p.height = 1;
    return p;
  }
};
constexpr detail::CallKind kFill{
    [](const void* call, cudaStream_t stream) {
      const auto& c = *static_cast<const FillCall*>(call);
      return cudaMemsetAsync(c.to, static_cast<int>(c.byte), c.bytes, stream);
    },
    [](const void* call, cudaGraph_t graph, const cudaGraphNode_t* after, std::size_t afters,
       cudaGraphNode_t* node) {
      const cudaMemsetParams p = static_cast<const FillCall*>(call)->parameters();
      return cudaGraphAddMemsetNode(node, graph, after, afters, &p);
    },
    [](const void* call, cudaGraphExec_t graph, cudaGraphNode_t node) {
      const cudaMemsetParams p = static_cast<const FillCall*>(call)->parameters();
      return cudaGraphExecMemsetNodeSetParams(graph, node, &p);
    }};

/// What is uploaded within a batch, unless it is large, travels in the parameters of kernels: a copy from the
/// host's memory would end the batch.
template <int kWords>
struct Piece {
  unsigned words[kWords];  // of 4 bytes
};

template <int kWords>
__global__ void storeWordsKernel(unsigned* to, int words, const __grid_constant__ Piece<kWords> from) {
  detail::waitForPriorKernel();
  if (static_cast<int>(threadIdx.x) < words) to[threadIdx.x] = from.words[threadIdx.x];
}

template <int kWords>
cudaError_t storePieces(detail::LaunchQueue& queue, void* to, const void* fromHost, std::size_t bytes) {
  cudaError_t error = cudaSuccess;
  for (std::size_t begin = 0; begin < bytes && error == cudaSuccess; begin += sizeof(Piece<kWords>)) {
    Piece<kWords> piece{};
    const std::size_t size = std::min(sizeof piece, bytes - begin);
    std::memcpy(piece.words, static_cast<const char*>(fromHost) + begin, size);
    error = detail::submitKernel(queue, storeWordsKernel<kWords>, {1, kWords, 0, {true}},
                                 reinterpret_cast<unsigned*>(static_cast<char*>(to) + begin),
                                 static_cast<int>(size / sizeof(unsigned)), piece);
  }
  return error;
}

// Within a graph, kernels overlap, and what else fills or copies does not.
constexpr unsigned kFillBlock = 256;  // threads

__global__ void fillKernel(uint4* to, std::int64_t pieces, int wordsLeft, unsigned word) {
  detail::waitForPriorKernel();
  const std::int64_t i = std::int64_t{blockIdx.x} * kFillBlock + threadIdx.x;
  if (i < pieces)
    to[i] = make_uint4(word, word, word, word);
  else if (i - pieces < wordsLeft)
    reinterpret_cast<unsigned*>(to + pieces)[i - pieces] = word;
  detail::triggerDependentKernel();
}

constexpr std::size_t kFewWords = 256;  // that one block copies

__global__ void copyWordsKernel(unsigned* to, const unsigned* from, int words) {
  detail::waitForPriorKernel();
  if (static_cast<int>(threadIdx.x) < words) to[threadIdx.x] = from[threadIdx.x];
  detail::triggerDependentKernel();
}

/// Shows whether this build holds code that the device can run.
__global__ void probeKernel() {}

}  // namespace

struct CudaDevice::Impl {
  explicit Impl(int deviceIndex) : index(deviceIndex) {}
  ~Impl() {
    if (makeCurrent() != cudaSuccess) static_cast<void>(cudaGetLastError());
    if (stream == nullptr) return;
    static_cast<void>(cudaStreamSynchronize(stream));
    launches.reset();
    static_cast<void>(cudaStreamDestroy(std::exchange(stream, nullptr)));
  }

  cudaError_t makeCurrent() const { return cudaSetDevice(index); }

  // Plain allocations, not stream-ordered ones: the pool already recycles without waiting, and a captured
  // graph may use such memory freely.
  void* systemAllocate(std::size_t bytes) const {
    void* memory = nullptr;
    if (makeCurrent() == cudaSuccess && bytes <= freeMemory() && cudaMalloc(&memory, bytes) == cudaSuccess) {
      return memory;
    }
    static_cast<void>(cudaGetLastError());
    return nullptr;
  }

  // An idle block may still be in use by kernels that were launched before it was released.
  void systemFree(void* memory) const {
    static_cast<void>(makeCurrent());
    if (launches) static_cast<void>(launches->flush());
    static_cast<void>(cudaStreamSynchronize(stream));
    static_cast<void>(cudaFree(memory));
  }

  int index;
  int multiprocessors = 0;
  cudaStream_t stream = nullptr;
  std::unique_ptr<detail::LaunchQueue> launches;
  MemoryPool pool{withFault([this](std::size_t bytes) { return systemAllocate(bytes); }),
                  [this](void* memory, std::size_t) { systemFree(memory); }};
};

CudaDevice::CudaDevice(int index)
    : Device(DeviceKind::kCuda, "cuda:" + std::to_string(index)), impl_(std::make_unique<Impl>(index)) {
  const auto require = [&](cudaError_t error) {
    if (error == cudaSuccess) return;
    static_cast<void>(cudaGetLastError());
    throw usageError("device '" + name() + "' cannot be used: " + describeError(error));
  };
  require(impl_->makeCurrent());
  require(cudaStreamCreateWithFlags(&impl_->stream, cudaStreamNonBlocking));
  impl_->launches = std::make_unique<detail::LaunchQueue>(impl_->stream);
  require(cudaDeviceGetAttribute(&impl_->multiprocessors, cudaDevAttrMultiProcessorCount, index));
  probeKernel<<<1, 1, 0, impl_->stream>>>();
  require(cudaGetLastError());
  require(cudaStreamSynchronize(impl_->stream));
  profiler_ = std::make_unique<CudaProfiler>(index, impl_->stream);
}

CudaDevice::~CudaDevice() {
  profiler_.reset();  // its events go before the stream that they stand on
}

std::string CudaDevice::description() const {
  cudaDeviceProp properties{};
  check(cudaGetDeviceProperties(&properties, impl_->index), "cudaGetDeviceProperties");
  return std::string(properties.name) + ", " + std::to_string(properties.totalGlobalMem >> 30) + " GiB";
}

void* CudaDevice::allocate(std::size_t bytes) {
  void* memory = impl_->pool.allocate(bytes);
  if (memory == nullptr && bytes > 0) {
    check(impl_->makeCurrent(), "allocate");
    throw simulationError("out of memory on " + name() + ": " + describeBytes(bytes) + " were asked for, " +
                              describeBytes(freeMemory()) + " are free",
                          {}, "use fewer particles, which means a larger spacing, or run on the CPU");
  }
  return memory;
}

void CudaDevice::release(void* memory, std::size_t bytes) noexcept {
  impl_->pool.release(memory, bytes);
}

std::shared_ptr<void> CudaDevice::lend(void* memory) {
  return impl_->pool.lend(memory);
}

std::size_t CudaDevice::availableMemory() const {
  if (impl_->makeCurrent() != cudaSuccess) static_cast<void>(cudaGetLastError());
  const std::size_t free = freeMemory();
  const MemoryUse use = memoryUse();
  return free > 0 ? free + (use.reserved - use.inUse) : 0;
}

MemoryUse CudaDevice::memoryUse() const {
  return impl_->pool.use();
}

// From pageable memory the runtime stages the bytes before it returns, so `fromHost` may change afterwards.
void CudaDevice::upload(void* to, const void* fromHost, std::size_t bytes) {
  if (bytes == 0) return;
  check(impl_->makeCurrent(), "upload");
  // Where hundreds of solids stand is 100 KiB; the parameters of a kernel have room for 4.
  constexpr std::size_t kFew = 1 << 10, kMax = 1 << 18;
  if (impl_->launches->gathering() && bytes <= kMax && bytes % sizeof(unsigned) == 0) {
    auto* const store = bytes <= kFew ? storePieces<kFew / sizeof(unsigned)> : storePieces<960>;
    check(store(*impl_->launches, to, fromHost, bytes), "upload");
    return;
  }
  check(cudaMemcpyAsync(to, fromHost, bytes, cudaMemcpyHostToDevice, stream()), "upload");
}

void CudaDevice::download(void* toHost, const void* from, std::size_t bytes) {
  ++blockingReadbacks_;
  if (bytes == 0) return;
  check(impl_->makeCurrent(), "download");
  check(cudaMemcpyAsync(toHost, from, bytes, cudaMemcpyDeviceToHost, stream()), "download");
  check(cudaStreamSynchronize(impl_->stream), "download");
}

void CudaDevice::copy(void* to, const void* from, std::size_t bytes) {
  if (bytes == 0) return;
  check(impl_->makeCurrent(), "copy");
  constexpr std::size_t kWord = sizeof(unsigned);
  if (impl_->launches->gathering() && bytes <= kFewWords * kWord && bytes % kWord == 0) {
    check(detail::submitKernel(launches(), copyWordsKernel, {1, kFewWords, 0, {true}},
                               static_cast<unsigned*>(to), static_cast<const unsigned*>(from),
                               static_cast<int>(bytes / kWord)),
          "copy");
    return;
  }
  check(launches().submit(kCopy, nullptr, CopyCall{to, from, bytes}), "copy");
}

void CudaDevice::fillBytes(void* to, int byte, std::size_t bytes) {
  if (bytes == 0) return;
  check(impl_->makeCurrent(), "fillBytes");
  constexpr std::size_t kPiece = sizeof(uint4), kWord = sizeof(unsigned);
  const bool whole = reinterpret_cast<std::uintptr_t>(to) % kPiece == 0 && bytes % kWord == 0;
  if (impl_->launches->gathering() && whole) {
    const auto pieces = static_cast<std::int64_t>(bytes / kPiece);
    const int wordsLeft = static_cast<int>(bytes % kPiece / kWord);
    const auto blocks = static_cast<unsigned>((pieces + wordsLeft + kFillBlock - 1) / kFillBlock);
    check(
        detail::submitKernel(launches(), fillKernel, {blocks, kFillBlock, 0, {true}}, static_cast<uint4*>(to),
                             pieces, wordsLeft, static_cast<unsigned>(byte & 0xff) * 0x01010101u),
        "fillBytes");
    return;
  }
  check(launches().submit(kFill, nullptr, FillCall{to, byte, bytes}), "fillBytes");
}

void CudaDevice::synchronize() {
  check(impl_->makeCurrent(), "synchronize");
  check(cudaStreamSynchronize(stream()), "synchronize");
}

void CudaDevice::beginBatch() {
  impl_->launches->begin();
}

void CudaDevice::endBatch() {
  check(impl_->makeCurrent(), "step");
  checkBatch(impl_->launches->end());
}

void CudaDevice::dropBatch() noexcept {
  impl_->launches->drop();
}

CUstream_st* CudaDevice::stream() const {
  static_cast<CudaProfiler&>(*profiler_).noteWork();
  checkBatch(impl_->launches->flush());
  return impl_->stream;
}
detail::LaunchQueue& CudaDevice::launches() const {
  auto& profiler = static_cast<CudaProfiler&>(*profiler_);
  profiler.noteWork();
  impl_->launches->setAsker(profiler.currentScope());
  return *impl_->launches;
}
int CudaDevice::index() const {
  return impl_->index;
}
int CudaDevice::multiprocessors() const {
  return impl_->multiprocessors;
}

void CudaDevice::check(int cudaError, std::string_view what) const {
  if (cudaError != cudaSuccess) fail(cudaError, what, profiler_->currentPath());
}

void CudaDevice::checkBatch(int cudaError) const {
  if (cudaError == cudaSuccess) return;
  const auto& profiler = static_cast<const CudaProfiler&>(*profiler_);
  fail(cudaError, "step", profiler.pathOf(impl_->launches->failedAsker()));
}

void CudaDevice::fail(int cudaError, std::string_view what, const std::string& path) const {
  std::string message = describeError(static_cast<cudaError_t>(cudaError)) + " on " + name() + " in '";
  message.append(what).append("'");
  if (!path.empty()) message += ", at " + path;
  // What kernels do wrong shows up when somebody waits for them.
  const char* hint = path.empty() ? "run it with WEIR_CUDA_SERIAL=1, which names the module that failed" : "";
  throw simulationError(std::move(message), {}, hint).inNode(path.substr(0, path.find('/')));
}

bool builtWithCuda() {
  return true;
}

detail::CudaProbe detail::probeCuda() {
  int devices = 0;
  const cudaError_t error = cudaGetDeviceCount(&devices);
  if (error == cudaSuccess && devices > 0) return {devices, {}};
  static_cast<void>(cudaGetLastError());
  return {0, "there is no CUDA device: " + describeError(error == cudaSuccess ? cudaErrorNoDevice : error)};
}

namespace {

class CudaReadbackSlot final : public detail::ReadbackSlot {
 public:
  CudaReadbackSlot(CudaDevice& device, std::size_t size)
      : device_(device), index_(device.index()), size_(size) {
    makeCurrent();
    device_.check(cudaEventCreateWithFlags(&arrived_, cudaEventDisableTiming), "readback");
    const cudaError_t error = cudaMallocHost(&bytes_, size);
    if (error != cudaSuccess) static_cast<void>(cudaEventDestroy(arrived_));
    device_.check(error, "readback");
  }

  ~CudaReadbackSlot() override {
    static_cast<void>(cudaSetDevice(index_));
    static_cast<void>(cudaEventSynchronize(arrived_));  // a copy may still be on its way
    static_cast<void>(cudaFreeHost(bytes_));
    static_cast<void>(cudaEventDestroy(arrived_));
  }

  void start(const void* from) override {
    makeCurrent();
    device_.check(cudaMemcpyAsync(bytes_, from, size_, cudaMemcpyDeviceToHost, device_.stream()), "readback");
    device_.check(cudaEventRecord(arrived_, device_.stream()), "readback");
  }

  bool ready() override {
    makeCurrent();
    const cudaError_t state = cudaEventQuery(arrived_);
    if (state != cudaErrorNotReady) {
      device_.check(state, "readback");
      return true;
    }
    static_cast<void>(cudaGetLastError());  // "not ready" must not show up as the error of the next launch
    return false;
  }

  void wait() override {
    makeCurrent();
    device_.check(cudaEventSynchronize(arrived_), "readback");
  }

  const void* bytes() const override { return bytes_; }

 private:
  void makeCurrent() const { device_.check(cudaSetDevice(index_), "readback"); }

  CudaDevice& device_;
  int index_;
  std::size_t size_;
  cudaEvent_t arrived_ = nullptr;
  void* bytes_ = nullptr;
};

}  // namespace

std::unique_ptr<detail::ReadbackSlot> detail::makeCudaReadbackSlot(CudaDevice& device, std::size_t bytes) {
  return std::make_unique<CudaReadbackSlot>(device, bytes);
}

}  // namespace weir
