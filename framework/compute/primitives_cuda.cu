// Scan and sort on CUDA, through CUB; here alone, because its headers are slow to compile.
#include <cub/block/block_load.cuh>
#include <cub/block/block_reduce.cuh>
#include <cub/block/block_scan.cuh>
#include <cub/block/block_store.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "framework/base/check.h"
#include "framework/compute/parallel.h"

namespace weir {
namespace {

/// Calls run(scratch, bytes) as CUB wants it: first for the size of its scratch memory, then for the work.
template <class Run>
void runCub(CudaDevice& device, std::string_view name, const Run& run) {
  detail::beginLaunch(device, name);
  std::size_t bytes = 0;
  device.check(run(nullptr, bytes), name);
  // CUB takes a null pointer for the question again, so there is always a byte.
  Array<unsigned char> scratch(device, static_cast<std::int64_t>(std::max<std::size_t>(bytes, 1)));
  device.check(run(scratch.data(), bytes), name);
}

struct ScanCall {
  const int* in;
  int* out;
  std::int64_t size;
  unsigned char* scratch;
  std::size_t scratchBytes;
};

cudaError_t scan(const ScanCall& call, void* scratch, std::size_t& bytes, cudaStream_t stream) {
  return cub::DeviceScan::ExclusiveSum(scratch, bytes, call.in, call.out, static_cast<int>(call.size),
                                       stream);
}

/// CUB's kernels are its own, so a graph gets them by capturing them.
constexpr detail::CallKind kScan{[](const void* pointer, cudaStream_t stream) {
                                   const auto& call = *static_cast<const ScanCall*>(pointer);
                                   std::size_t bytes = call.scratchBytes;
                                   return scan(call, call.scratch, bytes, stream);
                                 },
                                 nullptr, nullptr};

// Few numbers are scanned in two kernels that overlap with those beside them. CUB's, of which the first only
// prepares the second, do not.
constexpr int kTile = 16 * detail::kCudaBlock;  // numbers that a block scans
constexpr int kMaxTiles = detail::kCudaBlock;

__global__ void __launch_bounds__(detail::kCudaBlock) sumTilesKernel(const int* in, int n, int* sums) {
  using Reduce = cub::BlockReduce<int, detail::kCudaBlock>;
  __shared__ typename Reduce::TempStorage memory;
  detail::waitForPriorKernel();
  int sum = 0;
  for (int k = 0; k < kTile; k += detail::kCudaBlock) {
    const int i = static_cast<int>(blockIdx.x) * kTile + k + static_cast<int>(threadIdx.x);
    sum += i < n ? in[i] : 0;
  }
  sum = Reduce(memory).Sum(sum);
  if (threadIdx.x == 0) sums[blockIdx.x] = sum;
  detail::triggerDependentKernel();
}

__global__ void __launch_bounds__(detail::kCudaBlock)
    scanTilesKernel(const int* in, int* out, int n, const int* sums) {
  using Reduce = cub::BlockReduce<int, detail::kCudaBlock>;
  using Scan = cub::BlockScan<int, detail::kCudaBlock>;
  using Load = cub::BlockLoad<int, detail::kCudaBlock, kTile / detail::kCudaBlock, cub::BLOCK_LOAD_TRANSPOSE>;
  using Store =
      cub::BlockStore<int, detail::kCudaBlock, kTile / detail::kCudaBlock, cub::BLOCK_STORE_TRANSPOSE>;
  __shared__ union {
    typename Reduce::TempStorage reduce;
    typename Scan::TempStorage scan;
    typename Load::TempStorage load;
    typename Store::TempStorage store;
  } memory;
  __shared__ int before;
  detail::waitForPriorKernel();
  const int begin = static_cast<int>(blockIdx.x) * kTile;
  int numbers[kTile / detail::kCudaBlock];
  const int ofOthers = threadIdx.x < blockIdx.x ? sums[threadIdx.x] : 0;
  Load(memory.load).Load(in + begin, numbers, n - begin, 0);
  __syncthreads();
  const int sum = Reduce(memory.reduce).Sum(ofOthers);
  if (threadIdx.x == 0) before = sum;
  __syncthreads();
  Scan(memory.scan).ExclusiveSum(numbers, numbers);
  for (int& number : numbers) number += before;
  __syncthreads();
  Store(memory.store).Store(out + begin, numbers, n - begin);
  detail::triggerDependentKernel();
}

int checkedSize(std::int64_t n) {
  WEIR_CHECK(n <= std::numeric_limits<int>::max());
  return static_cast<int>(n);
}

template <class Key>
void radixSort(CudaDevice& device, ArrayView<Key> keys, ArrayView<int> values, std::int64_t n) {
  constexpr std::string_view kName = "stableSortByKey";
  WEIR_CHECK(keys.size >= n);
  WEIR_CHECK(values.size >= n);
  if (n <= 1) return;
  const KernelScope scope(device.profiler(), kName);
  const int size = checkedSize(n);
  Array<Key> otherKeys(device, n);
  Array<int> otherValues(device, n);
  cub::DoubleBuffer<Key> keyBuffers(keys.data, otherKeys.data());
  cub::DoubleBuffer<int> valueBuffers(values.data, otherValues.data());
  runCub(device, kName, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, keyBuffers, valueBuffers, size, 0,
                                           static_cast<int>(sizeof(Key)) * 8, device.stream());
  });
  if (keyBuffers.Current() != keys.data) {
    device.copy(keys.data, keyBuffers.Current(), static_cast<std::size_t>(n) * sizeof(Key));
  }
  if (valueBuffers.Current() != values.data) {
    device.copy(values.data, valueBuffers.Current(), static_cast<std::size_t>(n) * sizeof(int));
  }
}

}  // namespace

void exclusiveScan(CudaDevice& device, ArrayView<const int> in, ArrayView<int> out, std::int64_t n) {
  constexpr std::string_view kName = "exclusiveScan";
  WEIR_CHECK(in.size >= n);
  WEIR_CHECK(out.size >= n);
  if (n <= 0) return;
  const KernelScope scope(device.profiler(), kName);
  if (n <= std::int64_t{kTile} * kMaxTiles) {
    const int size = checkedSize(n);
    const unsigned tiles = detail::blocksFor(n, kTile);
    Array<int> sums(device, tiles);
    detail::launch(device, kName, sumTilesKernel, tiles, in.data, size, sums.data());
    detail::launch(device, kName, scanTilesKernel, tiles, in.data, out.data, size, sums.data());
    return;
  }
  detail::beginLaunch(device, kName);
  ScanCall call{in.data, out.data, checkedSize(n), nullptr, 0};
  device.check(scan(call, nullptr, call.scratchBytes, nullptr), kName);
  // CUB takes a null pointer for the question again, so there is always a byte.
  Array<unsigned char> scratch(device,
                               static_cast<std::int64_t>(std::max<std::size_t>(call.scratchBytes, 1)));
  call.scratch = scratch.data();
  device.check(device.launches().submit(kScan, nullptr, call), kName);
}

void stableSortByKey(CudaDevice& device, ArrayView<std::uint32_t> keys, ArrayView<int> values,
                     std::int64_t n) {
  radixSort(device, keys, values, n);
}

void stableSortByKey(CudaDevice& device, ArrayView<std::uint64_t> keys, ArrayView<int> values,
                     std::int64_t n) {
  radixSort(device, keys, values, n);
}

}  // namespace weir
