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

/// The shortest way from a to b in the periodic box; neither is farther from it than half its sides.
Vec3d between(const Vec3d& a, const Vec3d& b, const Vec3i& sides) {
  const auto shortest = [](double d, double side) {
    if (d > 0.5 * side) return d > 1.5 * side ? d - 2 * side : d - side;
    if (d < -0.5 * side) return d < -1.5 * side ? d + 2 * side : d + side;
    return d;
  };
  return {shortest(b.x - a.x, sides.x), shortest(b.y - a.y, sides.y), shortest(b.z - a.z, sides.z)};
}

/// All particles closer than `radius`, by cells of at least that size.
Lists neighborsOf(const std::vector<Vec3d>& positions, const Vec3i& sides, double radius,
                  CpuThreads& threads) {
  // Fewer than three cells along an axis would meet each other twice.
  const auto cellsAlong = [radius](int side) {
    const int cells = static_cast<int>(side / radius);
    return cells < 3 ? 1 : cells;
  };
  const Vec3i n{cellsAlong(sides.x), cellsAlong(sides.y), cellsAlong(sides.z)};
  const auto cellOf = [&](const Vec3d& p, int axis) {
    const double x = p[axis] / sides[axis];
    return std::min(n[axis] - 1, static_cast<int>((x - std::floor(x)) * n[axis]));
  };
  Lists members(static_cast<std::size_t>(n.x) * n.y * n.z), lists(positions.size());
  const auto memberList = [&](int x, int y, int z) -> std::vector<int>& {
    return members[static_cast<std::size_t>((wrapped(z, n.z) * n.y + wrapped(y, n.y)) * n.x +
                                            wrapped(x, n.x))];
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3d& p = positions[i];
    memberList(cellOf(p, 0), cellOf(p, 1), cellOf(p, 2)).push_back(static_cast<int>(i));
  }
  const auto reach = [&](int axis) { return n[axis] == 1 ? 0 : 1; };
  forAll(threads, positions.size(), [&](std::size_t i) {
    const Vec3d& p = positions[i];
    for (int z = -reach(2); z <= reach(2); ++z)
      for (int y = -reach(1); y <= reach(1); ++y)
        for (int x = -reach(0); x <= reach(0); ++x)
          for (const int j : memberList(cellOf(p, 0) + x, cellOf(p, 1) + y, cellOf(p, 2) + z)) {
            const Vec3d d = between(p, positions[static_cast<std::size_t>(j)], sides);
            if (static_cast<std::size_t>(j) != i && dot(d, d) < radius * radius) lists[i].push_back(j);
          }
  });
  return lists;
}

}  // namespace

RelaxedTile::RelaxedTile(double supportRatio, int side, int height, int sweeps, std::uint64_t seed,
                         CpuThreads& threads)
    : sides_{side, height, side} {
  WEIR_CHECK(std::min(side, height) >= 1 + 2 * supportRatio);
  constexpr double kJitter = 0.5;  // anywhere in its cell: no order is left
  std::uint64_t number = 0;
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < height; ++y)
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
    return static_cast<std::size_t>((wrapped(z, sides_.z) * sides_.y + wrapped(y, sides_.y)) * sides_.x +
                                    wrapped(x, sides_.x));
  };
  std::vector<Vec3d> moved(positions_.size());  // from the particles' nodes
  const auto nodeOf = [&](std::size_t i) {
    const auto k = static_cast<std::int64_t>(i);
    return Vec3d{double(k % sides_.x), double(k / sides_.x % sides_.y), double(k / sides_.x / sides_.y)};
  };
  for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = positions_[i] - nodeOf(i);
  for (int round = 0; round < kRounds; ++round)
    for (int z = 0; z < sides_.z; ++z)
      for (int y = 0; y < sides_.y; ++y)
        for (int x = 0; x < sides_.x; ++x)
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
    if (sweep % kListsFor == 0) lists = neighborsOf(positions_, sides_, supportRatio + kSkin, threads);
    forAll(threads, positions_.size(), [&](std::size_t i) {
      Vec3d push{};
      double sum = 1;
      for (const int j : lists[i]) {
        const Vec3d d = between(positions_[i], positions_[static_cast<std::size_t>(j)], sides_);
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
  const int i = wrapped(x, sides_.x), j = wrapped(y, sides_.y), k = wrapped(z, sides_.z);
  const Vec3d d = positions_[static_cast<std::size_t>((k * sides_.y + j) * sides_.x + i)] -
                  Vec3d{double(i), double(j), double(k)};
  return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
}

double calibrationOf(const RelaxedTile& tile, double supportRatio) {
  return std::numbers::pi * supportRatio * supportRatio * supportRatio / (15 * tile.meanSum());
}

}  // namespace weir
