#include "plugins/mpi/nccl_links.h"

#include <cuda_runtime.h>

#include <chrono>
#include <cstring>
#include <span>
#include <string>
#include <thread>
#include <utility>

#include "framework/base/error.h"

namespace weir {

namespace {

constexpr const char* kWhat = "exchange between GPUs";

void check(const NcclLibrary& nccl, NcclResult result, const char* what) {
  if (result != kNcclSuccess)
    throw simulationError(std::string("NCCL: ") + nccl.ncclGetErrorString(result) + ", in '" + what + "'");
}

/// What is sent or received in one go.
struct Transfer {
  int peer;
  void* bytes;
  std::size_t size;
};

/// Those with bytes.
std::vector<Transfer> transfersOf(std::span<NcclLinks::Batch> byRank) {
  std::vector<Transfer> transfers;
  for (std::size_t peer = 0; peer < byRank.size(); ++peer)
    for (Array<std::byte>& one : byRank[peer])
      if (!one.empty()) transfers.push_back({static_cast<int>(peer), one.data(), std::size_t(one.size())});
  return transfers;
}

class CudaNcclLinks final : public NcclLinks {
 public:
  CudaNcclLinks(std::shared_ptr<const NcclLibrary> nccl, CudaDevice& device, int rank, int ranks,
                const NcclUniqueId& id)
      : nccl_(std::move(nccl)), device_(device) {
    makeCurrent();
    check(*nccl_, nccl_->ncclCommInitRank(&comm_, ranks, id, rank), "ncclCommInitRank");
  }
  ~CudaNcclLinks() override { drop(); }

  /// The first exchange of each two ranks sets up their connection, on both hosts at once.
  void warmUp(int rank, int ranks) {
    Array<std::byte> bytes(device_, ranks + 1);
    bytes.fillZero();
    std::vector<Transfer> sent, received;
    for (int peer = 0; peer < ranks; ++peer) {
      if (peer == rank) continue;
      sent.push_back({peer, bytes.data() + ranks, 1});
      received.push_back({peer, bytes.data() + peer, 1});
    }
    exchange(sent, received);
    device_.synchronize();
  }

  // What was sent may be used again, as that is in the device's order, too.
  void exchange(std::vector<Batch> toRanks, std::vector<Batch>& fromRanks) override {
    exchange(transfersOf(toRanks), transfersOf(fromRanks));
  }

  bool areIdle() override {
    makeCurrent();
    const cudaError_t state = cudaStreamQuery(device_.stream());
    if (state != cudaErrorNotReady) device_.check(state, kWhat);
    if (state != cudaSuccess) static_cast<void>(cudaGetLastError());
    return state == cudaSuccess;
  }

  void close() override {
    makeCurrent();
    check(*nccl_, nccl_->ncclCommDestroy(std::exchange(comm_, nullptr)), "ncclCommDestroy");
  }

  void drop() noexcept override {
    constexpr std::chrono::seconds kMax{1};
    const auto start = std::chrono::steady_clock::now();
    try {
      while (!areIdle() && std::chrono::steady_clock::now() - start < kMax)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } catch (const Error&) {  // of the device, by which the run ends anyway
    }
    if (comm_ != nullptr) static_cast<void>(nccl_->ncclCommAbort(std::exchange(comm_, nullptr)));
  }

 private:
  void makeCurrent() const { device_.check(cudaSetDevice(device_.index()), kWhat); }

  /// As one group, in which NCCL sends and receives at the same time.
  void exchange(const std::vector<Transfer>& sent, const std::vector<Transfer>& received) {
    if (sent.empty() && received.empty()) return;
    makeCurrent();
    const cudaStream_t stream = device_.stream();
    check(*nccl_, nccl_->ncclGroupStart(), "ncclGroupStart");
    NcclResult result = kNcclSuccess;
    for (const Transfer& t : sent)
      if (result == kNcclSuccess) result = nccl_->ncclSend(t.bytes, t.size, kNcclInt8, t.peer, comm_, stream);
    for (const Transfer& t : received)
      if (result == kNcclSuccess) result = nccl_->ncclRecv(t.bytes, t.size, kNcclInt8, t.peer, comm_, stream);
    const NcclResult ended = nccl_->ncclGroupEnd();
    check(*nccl_, result, "ncclSend or ncclRecv");
    check(*nccl_, ended, "ncclGroupEnd");
  }

  std::shared_ptr<const NcclLibrary> nccl_;
  CudaDevice& device_;
  NcclCommunicator comm_ = nullptr;
};

}  // namespace

GpuId gpuIdOf(const Device& device) {
  const auto& cuda = static_cast<const CudaDevice&>(device);
  cudaDeviceProp properties{};
  cuda.check(cudaGetDeviceProperties(&properties, cuda.index()), kWhat);
  GpuId id;
  static_assert(sizeof(properties.uuid) == sizeof(id));
  std::memcpy(id.data(), &properties.uuid, sizeof(id));
  return id;
}

NcclUniqueId makeNcclId(const NcclLibrary& nccl) {
  NcclUniqueId id{};
  check(nccl, nccl.ncclGetUniqueId(&id), "ncclGetUniqueId");
  return id;
}

std::unique_ptr<NcclLinks> makeNcclLinks(std::shared_ptr<const NcclLibrary> nccl, Device& device, int rank,
                                         int ranks, const NcclUniqueId& id) {
  auto links =
      std::make_unique<CudaNcclLinks>(std::move(nccl), static_cast<CudaDevice&>(device), rank, ranks, id);
  links->warmUp(rank, ranks);
  return links;
}

}  // namespace weir
