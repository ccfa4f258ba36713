// Where the time of ranks goes: seconds of the host, by what they do together.
//
//   TimedRanks timed(ranks);                       // in place of the communicator
//   const RankTimes::Scope scope(timed.times(), RankWork::kMigration);
//
// What is exchanged outside of a scope counts as sums. Waiting for other ranks is included, and so is waiting
// for the device where a scope does that; what a device does beside the host is not seen.
#pragma once

#include <array>
#include <chrono>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "framework/communication/communicator.h"

namespace weir {

enum class RankWork { kCutting, kMigration, kHalo, kRefresh, kSums, kGathering };
inline constexpr int kRankWorks = 6;
/// In the order of the enumeration.
inline constexpr std::array<std::string_view, kRankWorks> kRankWorkNames{"cutting", "migration", "halo",
                                                                         "refresh", "sums",      "gathering"};

class RankTimes {
 public:
  /// Seconds, in the order of the enumeration.
  using Seconds = std::array<double, kRankWorks>;

  const Seconds& seconds() const { return seconds_; }
  void clear() { seconds_ = {}; }

  /// While it lives, time passes for this work, unless it does for another already.
  class Scope {
   public:
    Scope(RankTimes& times, RankWork work)
        : times_(times), work_(work), isOuter_(!std::exchange(times.isInScope_, true)) {}
    ~Scope() {
      if (!isOuter_) return;
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin_;
      times_.seconds_[static_cast<std::size_t>(work_)] += passed.count();
      times_.isInScope_ = false;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    RankTimes& times_;
    RankWork work_;
    bool isOuter_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  };

 private:
  Seconds seconds_{};
  bool isInScope_ = false;
};

/// A communicator whose waits are timed.
class TimedRanks final : public Communicator {
 public:
  explicit TimedRanks(Communicator& ranks) : ranks_(ranks) {}

  RankTimes& times() { return times_; }

  int rank() const override { return ranks_.rank(); }
  int size() const override { return ranks_.size(); }
  int sizeHere() const override { return ranks_.sizeHere(); }
  void post(int to, Message message) override { ranks_.post(to, std::move(message)); }
  Message receive(int from) override {
    const RankTimes::Scope scope(times_, RankWork::kSums);
    return ranks_.receive(from);
  }
  void postParcel(int to, Parcel parcel) override { ranks_.postParcel(to, std::move(parcel)); }
  std::vector<Parcel> receiveParcels(std::span<const int> from, Device& device) override {
    const RankTimes::Scope scope(times_, RankWork::kSums);
    return ranks_.receiveParcels(from, device);
  }

 private:
  Communicator& ranks_;
  RankTimes times_;
};

}  // namespace weir
