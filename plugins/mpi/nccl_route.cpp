#include "plugins/mpi/nccl_route.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "framework/base/error.h"
#include "plugins/mpi/nccl_links.h"
#include "plugins/mpi/parcel_rounds.h"

namespace weir {

namespace {

/// Sizes go by MPI, bytes by NCCL.
class NcclTransport final : public ParcelTransport {
 public:
  NcclTransport(MpiRank& rank, NcclLinks& links) : rank_(rank), links_(links) {}

  void announce(int to, const Sizes& sizes) override {
    const auto bytes = std::as_bytes(std::span(sizes));
    rank_.post(MpiRank::kParcelSizes, to, Message(bytes.begin(), bytes.end()));
  }
  Sizes announced(int from) override {
    const Message message = rank_.receive(MpiRank::kParcelSizes, from);
    Sizes sizes(message.size() / sizeof(std::int64_t));
    std::memcpy(sizes.data(), message.data(), message.size());
    return sizes;
  }
  void exchange(std::vector<Batch> toRanks, std::vector<Batch>& fromRanks) override {
    links_.exchange(std::move(toRanks), fromRanks);
  }

 private:
  MpiRank& rank_;
  NcclLinks& links_;
};

class NcclRoute final : public ParcelRoute, public ParcelCarrier {
 public:
  NcclRoute(MpiRank& rank, Device& device, std::unique_ptr<NcclLinks> links, std::string version)
      : rank_(rank),
        device_(device),
        version_(std::move(version)),
        links_(std::move(links)),
        transport_(rank, *links_),
        rounds_(transport_, device, rank.rank(), rank.size()) {
    rank_.setCarrier(this);
  }
  ~NcclRoute() override {
    rank_.setCarrier(nullptr);
    links_->drop();
  }

  std::string description() const override { return "by NCCL " + version_; }

  void end() override {
    while (!links_->areIdle()) {
      rank_.lookForFailure();
      std::this_thread::yield();
    }
    device_.synchronize();
    rank_.sum(0);
    links_->close();
  }

  void post(int to, Parcel parcel) override { rounds_.post(to, std::move(parcel)); }
  std::vector<Parcel> receive(std::span<const int> from) override { return rounds_.receive(from); }
  void drop() noexcept override { links_->drop(); }

 private:
  MpiRank& rank_;
  Device& device_;
  std::string version_;
  std::unique_ptr<NcclLinks> links_;
  NcclTransport transport_;
  ParcelRounds rounds_;
};

class HostRoute final : public ParcelRoute {
 public:
  explicit HostRoute(std::string why) : why_(std::move(why)) {}
  std::string description() const override { return "by way of the hosts: " + why_; }
  void end() override {}

 private:
  std::string why_;
};

/// What a rank tells all others before NCCL is set up, or afterwards.
struct Offer {
  bool isReady = false;
  char why[240] = "";  // not
  GpuId gpu{};
  NcclUniqueId id{};  // of rank 0

  void refuse(const std::string& reason) {
    isReady = false;
    std::copy_n(reason.begin(), std::min(reason.size(), sizeof why - 1), why);
  }
};

/// Why not all can; empty if they can.
std::string objection(const std::vector<Offer>& offers) {
  for (std::size_t k = 0; k < offers.size(); ++k)
    if (!offers[k].isReady) return std::string(offers[k].why) + " (rank " + std::to_string(k) + ")";
  for (std::size_t k = 0; k < offers.size(); ++k)
    for (std::size_t other = 0; other < k; ++other)
      if (offers[k].gpu == offers[other].gpu)
        return "ranks " + std::to_string(other) + " and " + std::to_string(k) + " share a GPU";
  return {};
}

/// f() unless that fails, then why.
template <class F>
Offer offerOf(const F& f) {
  Offer offer;
  try {
    f(offer);
    offer.isReady = true;
  } catch (const Error& e) {
    offer.refuse(e.message());
  }
  return offer;
}

}  // namespace

std::unique_ptr<ParcelRoute> openNcclRoute(MpiRank& rank, Device& device) {
  if (device.kind() == DeviceKind::kCpu) return nullptr;
  if (rank.size() == 1) return std::make_unique<HostRoute>("there is one rank");
  std::shared_ptr<const NcclLibrary> nccl;
  const std::vector<Offer> offers = rank.allGather(offerOf([&](Offer& offer) {
    nccl = NcclLibrary::open();
    offer.gpu = gpuIdOf(device);
    if (rank.rank() == 0) offer.id = makeNcclId(*nccl);
  }));
  std::string why = objection(offers);
  if (!why.empty()) return std::make_unique<HostRoute>(why);
  std::unique_ptr<NcclLinks> links;
  const std::vector<Offer> ends = rank.allGather(offerOf([&](Offer& offer) {
    offer.gpu = gpuIdOf(device);
    links = makeNcclLinks(nccl, device, rank.rank(), rank.size(), offers[0].id);
  }));
  why = objection(ends);
  if (!why.empty()) return std::make_unique<HostRoute>(why);
  return std::make_unique<NcclRoute>(rank, device, std::move(links), nccl->version());
}

}  // namespace weir
