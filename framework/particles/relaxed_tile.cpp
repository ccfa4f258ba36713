#include "framework/particles/relaxed_tile.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/base/check.h"
#include "framework/base/random.h"
#include "framework/compute/cpu_threads.h"

namespace weir {

namespace {

using Lists = std::vector<std::vector<int>>;

/// `f(i)` for all particles, on all threads.
template <class F>
void forAll(CpuThreads& threads, std::size_t count, const F& f) {
  constexpr std::size_t kChunk = 128;
  struct Task {
    const F& f;
    std::size_t count;
  } task{f, count};
  const auto run = [](void* context, std::int64_t chunk) {
    const Task& t = *static_cast<Task*>(context);
    const std::size_t begin = static_cast<std::size_t>(chunk) * kChunk;
    for (std::size_t i = begin; i < std::min(begin + kChunk, t.count); ++i) t.f(i);
  };
  threads.run(static_cast<std::int64_t>((count + kChunk - 1) / kChunk), run, &task);
}

int wrapped(std::int64_t k, int side) {
  const auto m = static_cast<int>(k % side);
  return m < 0 ? m + side : m;
}

/// The shortest way from a to b in the periodic cube; neither is farther from it than half its side.
Vec3d between(const Vec3d& a, const Vec3d& b, double side) {
  const auto shortest = [side](double d) {
    if (d > 0.5 * side) return d > 1.5 * side ? d - 2 * side : d - side;
    if (d < -0.5 * side) return d < -1.5 * side ? d + 2 * side : d + side;
    return d;
  };
  return {shortest(b.x - a.x), shortest(b.y - a.y), shortest(b.z - a.z)};
}

/// All particles closer than `radius`, by cells of at least that size.
Lists neighborsOf(const std::vector<Vec3d>& positions, int side, double radius, CpuThreads& threads) {
  // Fewer than three cells along an axis would meet each other twice.
  const int cells = static_cast<int>(side / radius);
  const bool all = cells < 3;
  const int n = all ? 1 : cells;
  const auto cellOf = [&](double x) {
    return std::min(n - 1, static_cast<int>((x / side - std::floor(x / side)) * n));
  };
  Lists members(static_cast<std::size_t>(n) * n * n), lists(positions.size());
  const auto memberList = [&](int x, int y, int z) -> std::vector<int>& {
    return members[static_cast<std::size_t>((wrapped(z, n) * n + wrapped(y, n)) * n + wrapped(x, n))];
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d& p = positions[i];
    memberList(cellOf(p.x), cellOf(p.y), cellOf(p.z)).push_back(static_cast<int>(i));
  }
  const int reach = all ? 0 : 1;
  forAll(threads, positions.size(), [&](std::size_t i) {
    const Vec3d& p = positions[i];
    for (int z = -reach; z <= reach; ++z)
      for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x)
          for (const int j : memberList(cellOf(p.x) + x, cellOf(p.y) + y, cellOf(p.z) + z)) {
            const Vec3d d = between(p, positions[static_cast<std::size_t>(j)], side);
            if (static_cast<std::size_t>(j) != i && dot(d, d) < radius * radius) lists[i].push_back(j);
          }
  });
  return lists;
}

}  // namespace

RelaxedTile::RelaxedTile(double supportRatio, int side, int sweeps, std::uint64_t seed, CpuThreads& threads)
    : side_(side) {
  WEIR_CHECK(side >= 1 + 2 * supportRatio);
  constexpr double kJitter = 0.5;  // anywhere in its cell: no order is left
  std::uint64_t number = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x, number += 3)
        positions_.push_back({x + kJitter * noise(seed, number), y + kJitter * noise(seed, number + 1),
                              z + kJitter * noise(seed, number + 2)});
  relax(supportRatio, sweeps, threads);
  assignToNodes();
}

void RelaxedTile::assignToNodes() {
  // Neighbouring nodes exchange their particles while that makes the squares of the displacements less.
  constexpr int kRounds = 8;
  const auto index = [&](int x, int y, int z) {
    return static_cast<std::size_t>((wrapped(z, side_) * side_ + wrapped(y, side_)) * side_ +
                                    wrapped(x, side_));
  };
  std::vector<Vec3d> moved(positions_.size());  // from the particles' nodes
  const auto nodeOf = [&](std::size_t i) {
    const auto k = static_cast<std::int64_t>(i);
    return Vec3d{double(k % side_), double(k / side_ % side_), double(k / side_ / side_)};
  };
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = positions_[i] - nodeOf(i);
  for (int round = 0; round < kRounds; ++round)
    for (int z = 0; z < side_; ++z)
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          for (int near = 0; near < 27; ++near) {
            const Vec3d way{double(near % 3 - 1), double(near / 3 % 3 - 1), double(near / 9 - 1)};
            Vec3d &a = moved[index(x, y, z)],
                  &b = moved[index(x + near % 3 - 1, y + near / 3 % 3 - 1, z + near / 9 - 1)];
            const Vec3d otherA = b + way, otherB = a - way;
            if (dot(otherA, otherA) + dot(otherB, otherB) < dot(a, a) + dot(b, b)) a = otherA, b = otherB;
          }
  for (std::size_t i = 0; i < moved.size(); ++i) positions_[i] = nodeOf(i) + moved[i];
}

void RelaxedTile::relax(double supportRatio, int sweeps, CpuThreads& threads) {
  // Gradient descent with momentum. Lists hold for a while because a sweep moves nobody farther than
  // kFarthest.
  constexpr double kStep = 0.04, kMomentum = 0.85, kSkin = 0.4, kFarthest = 0.02;
  constexpr int kListsFor = static_cast<int>(kSkin / (2 * kFarthest));
  std::vector<Vec3d> moves(positions_.size());
  std::vector<double> sums(positions_.size());
  Lists lists;
  for (int sweep = 0; sweep <= sweeps; ++sweep) {
    if (sweep % kListsFor == 0) lists = neighborsOf(positions_, side_, supportRatio + kSkin, threads);
    forAll(threads, positions_.size(), [&](std::size_t i) {
      Vec3d push{};
      double sum = 1;
      for (const int j : lists[i]) {
        const Vec3d d = between(positions_[i], positions_[static_cast<std::size_t>(j)], side_);
        const double squared = dot(d, d);
        if (squared >= supportRatio * supportRatio || squared == 0) continue;
        const double r = std::sqrt(squared), rest = 1 - r / supportRatio;
        sum += rest * rest * rest;
        push -= 3 * rest * rest / (supportRatio * r) * d;
      }
      sums[i] = sum;
      moves[i] = kMomentum * moves[i] + kStep * 2 * push;
      if (const double far = length(moves[i]); far > kFarthest) moves[i] *= kFarthest / far;
    });
    if (sweep < sweeps)
      for (std::size_t i = 0; i < moves.size(); ++i) positions_[i] += moves[i];
  }
  meanSum_ = 0;
  for (const double sum : sums) meanSum_ += sum / static_cast<double>(sums.size());
}

Vec3f RelaxedTile::displacement(std::int64_t x, std::int64_t y, std::int64_t z) const {
  const int i = wrapped(x, side_), j = wrapped(y, side_), k = wrapped(z, side_);
  const Vec3d d = positions_[static_cast<std::size_t>((k * side_ + j) * side_ + i)] -
                  Vec3d{double(i), double(j), double(k)};
  return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

double calibrationOf(const RelaxedTile& tile, double supportRatio) {
  return std::numbers::pi * supportRatio * supportRatio * supportRatio / (15 * tile.meanSum());
}

}  // namespace weir
