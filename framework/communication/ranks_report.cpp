#include "framework/communication/ranks_report.h"

#include <algorithm>
#include <vector>

namespace weir {

namespace {

Value meanAndMax(const std::vector<double>& ofRanks) {
  double sum = 0, max = 0;
  for (const double one : ofRanks) sum += one, max = std::max(max, one);
  Value v = Value::object();
  v["mean"] = sum / double(ofRanks.size());
  v["max"] = max;
  return v;
}

}  // namespace

Value meanAndMaxOfRanks(Communicator& ranks, double own) {
  return meanAndMax(ranks.allGather(own));
}

Value stepTimesOfRanks(Communicator& ranks, const RankTimes& times, std::int64_t steps) {
  const double perStep = 1e3 / double(std::max<std::int64_t>(steps, 1));
  const std::vector<RankTimes::Seconds> ofRanks = ranks.allGather(times.seconds());
  Value v = Value::object();
  for (std::size_t work = 0; work < kRankWorkNames.size(); ++work) {
    std::vector<double> ofWork;
    for (const RankTimes::Seconds& one : ofRanks) ofWork.push_back(perStep * one[work]);
    v[std::string(kRankWorkNames[work])] = meanAndMax(ofWork);
  }
  return v;
}

}  // namespace weir
