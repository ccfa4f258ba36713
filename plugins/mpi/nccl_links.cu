#include "plugins/mpi/nccl_links.h"

#include <cuda_runtime.h>

#include <chrono>
#include <cstring>
#include <deque>
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

/// Of the current device.
class Event {
 public:
  explicit Event(const CudaDevice& device) : device_(&device) {
    device.check(cudaEventCreateWithFlags(&event_, cudaEventDisableTiming), kWhat);
  }
  ~Event() {
    if (event_ != nullptr) static_cast<void>(cudaEventDestroy(event_));
  }
  Event(Event&& other) noexcept : device_(other.device_), event_(std::exchange(other.event_, nullptr)) {}
  Event& operator=(Event&&) = delete;

  void record(cudaStream_t stream) { device_->check(cudaEventRecord(event_, stream), kWhat); }
  /// What the stream is asked for from now on comes after it.
  void letWait(cudaStream_t stream) const { device_->check(cudaStreamWaitEvent(stream, event_, 0), kWhat); }
  bool hasPassed() const {
    const cudaError_t state = cudaEventQuery(event_);
    if (state != cudaErrorNotReady) device_->check(state, kWhat);
    if (state != cudaSuccess) static_cast<void>(cudaGetLastError());
    return state == cudaSuccess;
  }

 private:
  const CudaDevice* device_;
  cudaEvent_t event_ = nullptr;
};

/// What is sent or received in one go.
struct Transfer {
  int peer;
  void* bytes;
  std::size_t size;
};

/// A communicator with its stream.
class NcclLink {
 public:
  NcclLink(const NcclLibrary& nccl, CudaDevice& device, const NcclUniqueId& id, int rank, int ranks)
      : nccl_(nccl), device_(device) {
    int least = 0, greatest = 0;
    device_.check(cudaDeviceGetStreamPriorityRange(&least, &greatest), kWhat);
    check(nccl_, nccl_.ncclCommInitRank(&comm_, ranks, id, rank), "ncclCommInitRank");
    device_.check(cudaStreamCreateWithPriority(&stream_, cudaStreamNonBlocking, greatest), kWhat);
  }
  ~NcclLink() {
    drop();
    if (stream_ != nullptr) static_cast<void>(cudaStreamDestroy(stream_));
  }
  NcclLink(const NcclLink&) = delete;
  NcclLink& operator=(const NcclLink&) = delete;

  cudaStream_t stream() const { return stream_; }

  void exchange(const std::vector<Transfer>& sent, const std::vector<Transfer>& received) {
    check(nccl_, nccl_.ncclGroupStart(), "ncclGroupStart");
    NcclResult result = kNcclSuccess;
    for (const Transfer& t : sent)
      if (result == kNcclSuccess) result = nccl_.ncclSend(t.bytes, t.size, kNcclInt8, t.peer, comm_, stream_);
    for (const Transfer& t : received)
      if (result == kNcclSuccess) result = nccl_.ncclRecv(t.bytes, t.size, kNcclInt8, t.peer, comm_, stream_);
    const NcclResult ended = nccl_.ncclGroupEnd();
    check(nccl_, result, sent.empty() ? "ncclRecv" : "ncclSend");
    check(nccl_, ended, "ncclGroupEnd");
  }

  /// Keeps arrays until what the stream was asked for so far is done.
  void keep(NcclLinks::Batch arrays) {
    Event passed(device_);
    passed.record(stream_);
    kept_.emplace_back(std::move(passed), std::move(arrays));
  }
  bool isIdle() {
    while (!kept_.empty() && kept_.front().first.hasPassed()) kept_.pop_front();
    return kept_.empty();
  }

  void close() { check(nccl_, nccl_.ncclCommDestroy(std::exchange(comm_, nullptr)), "ncclCommDestroy"); }
  void drop() noexcept {
    if (comm_ != nullptr) static_cast<void>(nccl_.ncclCommAbort(std::exchange(comm_, nullptr)));
  }

 private:
  const NcclLibrary& nccl_;
  CudaDevice& device_;
  NcclCommunicator comm_ = nullptr;
  cudaStream_t stream_ = nullptr;
  std::deque<std::pair<Event, NcclLinks::Batch>> kept_;
};

class CudaNcclLinks final : public NcclLinks {
 public:
  CudaNcclLinks(std::shared_ptr<const NcclLibrary> nccl, CudaDevice& device, int rank, int ranks,
                const NcclIds& ids)
      : nccl_(std::move(nccl)),
        device_(device),
        rank_(rank),
        ranks_(ranks),
        marked_(current(device)),
        asked_(device),
        up_(*nccl_, device, ids[0], rank, ranks),
        down_(*nccl_, device, ids[1], rank, ranks) {
    warmUp();
  }
  ~CudaNcclLinks() override { drop(); }

  void mark() override { current(device_), marked_.record(device_.stream()); }

  void send(std::vector<Batch> toRanks) override {
    current(device_);
    areIdle();
    sendBy(up_, std::span(toRanks).subspan(std::size_t(rank_) + 1), rank_ + 1);
    sendBy(down_, std::span(toRanks).first(std::size_t(rank_)), 0);
  }

  void receive(int from, std::span<Array<std::byte>> into) override {
    current(device_);
    std::vector<Transfer> received;
    for (Array<std::byte>& one : into)
      if (!one.empty()) received.push_back({from, one.data(), std::size_t(one.size())});
    if (received.empty()) return;
    NcclLink& link = from < rank_ ? up_ : down_;
    // The device may still be at work for whoever had this memory before.
    asked_.record(device_.stream());
    asked_.letWait(link.stream());
    link.exchange({}, received);
    asked_.record(link.stream());
    asked_.letWait(device_.stream());
  }

  bool areIdle() override {
    current(device_);
    const bool up = up_.isIdle(), down = down_.isIdle();
    return up && down;
  }

  void close() override {
    current(device_);
    up_.close(), down_.close();
  }

  void drop() noexcept override {
    constexpr std::chrono::seconds kMax{1};
    const auto start = std::chrono::steady_clock::now();
    try {
      while (!areIdle() && std::chrono::steady_clock::now() - start < kMax)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } catch (const Error&) {  // of the device, by which the run ends anyway
    }
    up_.drop(), down_.drop();
  }

 private:
  static CudaDevice& current(CudaDevice& device) {
    device.check(cudaSetDevice(device.index()), kWhat);
    return device;
  }

  void sendBy(NcclLink& link, std::span<Batch> batches, int firstRank) {
    std::vector<Transfer> sent;
    Batch arrays;
    for (std::size_t k = 0; k < batches.size(); ++k)
      for (Array<std::byte>& one : batches[k]) {
        if (one.empty()) continue;
        sent.push_back({firstRank + static_cast<int>(k), one.data(), std::size_t(one.size())});
        arrays.push_back(std::move(one));
      }
    if (sent.empty()) return;
    marked_.letWait(link.stream());
    link.exchange(sent, {});
    link.keep(std::move(arrays));
  }

  /// The first exchange of each two ranks sets up their connection, on both hosts at once.
  void warmUp() {
    Array<std::byte> bytes(device_, ranks_ + 1);
    bytes.fillZero();
    device_.synchronize();
    std::vector<Transfer> lower, higher, toAny;
    for (int peer = 0; peer < ranks_; ++peer)
      if (peer != rank_) (peer < rank_ ? lower : higher).push_back({peer, bytes.data() + peer, 1});
    const auto fromHere = [&](std::vector<Transfer> peers) {
      for (Transfer& t : peers) t.bytes = bytes.data() + ranks_;
      return peers;
    };
    up_.exchange(fromHere(higher), lower);
    device_.check(cudaStreamSynchronize(up_.stream()), kWhat);
    down_.exchange(fromHere(lower), higher);
    device_.check(cudaStreamSynchronize(down_.stream()), kWhat);
  }

  std::shared_ptr<const NcclLibrary> nccl_;
  CudaDevice& device_;
  int rank_, ranks_;
  Event marked_, asked_;
  NcclLink up_, down_;  // to higher ranks, and to lower ones
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

NcclIds makeNcclIds(const NcclLibrary& nccl) {
  NcclIds ids{};
  for (NcclUniqueId& id : ids) check(nccl, nccl.ncclGetUniqueId(&id), "ncclGetUniqueId");
  return ids;
}

std::unique_ptr<NcclLinks> makeNcclLinks(std::shared_ptr<const NcclLibrary> nccl, Device& device, int rank,
                                         int ranks, const NcclIds& ids) {
  return std::make_unique<CudaNcclLinks>(std::move(nccl), static_cast<CudaDevice&>(device), rank, ranks, ids);
}

}  // namespace weir
