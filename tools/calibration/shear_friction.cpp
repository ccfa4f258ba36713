// Measures the inner friction of the fluid's packing, shear stress over pressure in steady shear, or its
// stiffness and loss in a small swinging shear; both without walls.
//
//   weir_shear_friction [NAME=VALUE…]
//
//   ratio       H/d                                            1.5
//   exponent    n of the kernel (1 − r/H)^n; the spiky one: 3  3
//   wendland    2 or 4: Wendland's kernel C2 or C4 in its place  0
//   rate        of shear, 1/s                                  20
//   strain      largest, of a swinging shear; 0: steady shear  0
//   period      of the swing, s                                1
//   pressure    Pa; the calibration follows it                 2000
//   modulus     K, Pa                                          1e6
//   step        s                                              5e-4
//   iterations  a step                                         8
//   smoothing   0 to 1: share of the mean over neighbours, weighted by W, in each particle's Ḃ
//   shifting    particles move by shifting·d²·V0·Σ∇W at the end of a step
//   relief      0 to 1: share of the stress's deviator that a force takes back, see below
//   memory      s, of the deviators that it takes back         0
//   spread      how often deviators are replaced by their means over neighbours, weighted by W  0
//   seeds       runs to take the mean of                       3
//
// Particles, one in each d³ = 1 cm³ of water, are in a periodic cube of 10 spacings, whose images above and
// below move along (Lees and Edwards, The computer simulation of transport processes under extreme
// conditions, 1972). A step is that of SemiImplicitSolver in double precision: predict, find neighbours,
// iterate Eq. 14. The stress is the virial one of the pairs, from a shear of 1.5 to one of 5:
// σ = −(1/V)·½·Σ_ij K·V0²·(Ḃ_i + Ḃ_j)·|W'|/r·(r ⊗ r)/2.
// Agitation is the root of the mean square of velocities beside those of the shear.
//
// A swing, γ = strain·sin(2πt/period) after 0.3 s at rest, moves all particles with it. Over two periods
// the parts of the stress in phase with γ and with dγ/dt, over strain and pressure, are the storage and the
// loss modulus: what makes waves too fast, and what damps them. A fluid without viscosity has neither.
//
// With `relief`, S_i being a particle's part of σ and m_i = ⅓·Σ_j V0·|W'|·r, velocities change by
// relief·(dt/ρ0)·Σ_j V0·(D_i + D_j)·|W'|/r·r_ij, where D_i is the deviator of −S_i/m_i: of a uniform D that
// is the force of the stress −D.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "framework/base/random.h"
#include "framework/base/vec.h"

namespace weir {
namespace {

using Settings = std::map<std::string, double>;
using Tensor = std::array<double, 6>;  // xx, yy, zz, xy, xz, yz

constexpr int kSide = 10;
constexpr double kSpacing = 0.01, kVolume = kSpacing * kSpacing * kSpacing, kDensity = 1000;
constexpr double kBegin = 1.5, kEnd = 5;  // of shear
constexpr double kRest = 0.3;             // s, before a swing
constexpr int kSwings = 2;

Tensor squareOf(const Vec3d& r, double weight) {
  return {weight * r.x * r.x, weight * r.y * r.y, weight * r.z * r.z,
          weight * r.x * r.y, weight * r.x * r.z, weight * r.y * r.z};
}
Vec3d times(const Tensor& t, const Vec3d& r) {
  return {t[0] * r.x + t[3] * r.y + t[4] * r.z, t[3] * r.x + t[1] * r.y + t[5] * r.z,
          t[4] * r.x + t[5] * r.y + t[2] * r.z};
}
void add(Tensor& to, const Tensor& t) {
  for (std::size_t k = 0; k < to.size(); ++k) to[k] += t[k];
}

struct Kernel {
  double radius, exponent;
  int wendland;
  /// Roots and products are quicker than powers.
  static double power(double t, double n) {
    if (n == 3) return t * t * t;
    return n == 2 ? t * t : n == 1.5 ? t * std::sqrt(t) : n == 2.5 ? t * t * std::sqrt(t) : std::pow(t, n);
  }
  double value(double r) const {
    if (r >= radius) return 0;
    const double q = r / radius, t = 1 - q;
    if (wendland == 2) return t * t * t * t * (1 + 4 * q);
    if (wendland == 4) return std::pow(t, 6) * (1 + 6 * q + 35.0 / 3 * q * q);
    return power(t, exponent);
  }
  double slope(double r) const {
    if (r >= radius) return 0;
    const double q = r / radius, t = 1 - q;
    if (wendland == 2) return 20 / radius * q * t * t * t;
    if (wendland == 4) return 56.0 / 3 / radius * q * (1 + 5 * q) * std::pow(t, 5);
    return exponent / radius * power(t, exponent - 1);
  }
};

struct Result {
  // The first four over the pressure: shear stress, or moduli of pairs and relief together.
  double pairs = 0, relieved = 0, storage = 0, loss = 0, agitation = 0, neighbors = 0;
};

class ShearedFluid {
 public:
  ShearedFluid(Settings settings, std::uint64_t seed)
      : s_(std::move(settings)),
        kernel_{s_["ratio"] * kSpacing, s_["exponent"], static_cast<int>(s_["wendland"])} {
    for (int i = 0; i < kSide * kSide * kSide; ++i) {
      constexpr double kJitter = 0.35;
      const auto k = static_cast<std::uint64_t>(3 * i);
      positions_.push_back(kSpacing * Vec3d{i % kSide + 0.5 + kJitter * noise(seed, k),
                                            i / kSide % kSide + 0.5 + kJitter * noise(seed, k + 1),
                                            i / kSide / kSide + 0.5 + kJitter * noise(seed, k + 2)});
    }
    relax();
    for (const Vec3d& p : positions_) velocities_.push_back({rateAt(0) * (p.y - kLength / 2), 0, 0});
    displacement_.resize(positions_.size());
    derivative_.resize(positions_.size());
    stress_.resize(positions_.size());
    deviator_.resize(positions_.size());
  }

  Result run() {
    const double end = swings() ? kRest + kSwings * s_["period"] : kEnd / s_["rate"];
    const double begin = swings() ? kRest : kBegin / s_["rate"];
    double pressure = 0, shear = 0, relieved = 0, inPhase = 0, outOfPhase = 0, agitation = 0, pairs = 0;
    int measured = 0;
    for (int k = 0; s_["step"] * k < end; ++k) {
      time_ = s_["step"] * k;
      predict();
      findNeighbors();
      solve();
      Tensor mean{};
      findStress(mean);
      const double p = -(mean[0] + mean[1] + mean[2]) / 3;
      const double taken = s_["relief"] > 0 ? relieve() : 0;
      time_ += s_["step"];
      if (time_ > begin) {
        ++measured;
        pressure += p;
        shear += mean[3];
        relieved += taken;
        inPhase += (mean[3] + taken) * std::sin(phase(time_));
        outOfPhase += (mean[3] + taken) * std::cos(phase(time_));
        for (std::size_t i = 0; i < positions_.size(); ++i) {
          const Vec3d v = velocities_[i] - Vec3d{rateAt(time_) * (positions_[i].y - kLength / 2), 0, 0};
          agitation += dot(v, v) / static_cast<double>(positions_.size());
          pairs += static_cast<double>(lists_[i].size()) / static_cast<double>(positions_.size());
        }
      }
      // Pressure is kept by the calibration, so that there is always one particle per d³.
      constexpr double kFollow = 0.1;
      factor_ *= 1 + kFollow * std::clamp(1 - p / s_["pressure"], -1.0, 1.0) * s_["pressure"] / s_["modulus"];
      if (s_["shifting"] > 0) shift();
    }
    const double half = swings() ? pressure * s_["strain"] / 2 : 1;
    return {shear / pressure,
            relieved / pressure,
            inPhase / half,
            outOfPhase / half,
            std::sqrt(agitation / measured),
            pairs / measured};
  }

 private:
  static constexpr double kLength = kSide * kSpacing;
  struct Neighbor {
    int index;
    Vec3d image;  // from the particle itself
  };

  bool swings() { return s_["strain"] > 0; }
  double phase(double time) { return 2 * std::numbers::pi * (time - kRest) / s_["period"]; }
  double rateAt(double time) {
    if (!swings()) return s_["rate"];
    return time < kRest ? 0 : s_["strain"] * 2 * std::numbers::pi / s_["period"] * std::cos(phase(time));
  }

  Vec3d way(std::size_t i, const Neighbor& n) const {
    return positions_[static_cast<std::size_t>(n.index)] + n.image - positions_[i];
  }

  /// Of the nearest image.
  Vec3d imageOf(const Vec3d& way) const {
    const double up = -std::round(way.y / kLength);
    const double along = up * offset_;
    return {along - kLength * std::round((way.x + along) / kLength), up * kLength,
            -kLength * std::round(way.z / kLength)};
  }

  void findNeighbors() {
    lists_.assign(positions_.size(), {});
    for (std::size_t i = 0; i < positions_.size(); ++i)
      for (std::size_t j = i + 1; j < positions_.size(); ++j) {
        // Whether images along the other two axes are near enough at all.
        const double up = std::abs(positions_[j].y - positions_[i].y);
        const double aside = std::abs(positions_[j].z - positions_[i].z);
        if (std::min(up, std::abs(kLength - up)) >= kernel_.radius ||
            std::min(aside, std::abs(kLength - aside)) >= kernel_.radius)
          continue;
        const Vec3d image = imageOf(positions_[j] - positions_[i]);
        const Vec3d r = positions_[j] + image - positions_[i];
        if (dot(r, r) >= kernel_.radius * kernel_.radius) continue;
        lists_[i].push_back({static_cast<int>(j), image});
        lists_[j].push_back({static_cast<int>(i), -1 * image});
      }
  }

  /// Σ_j |W'|/r·r_ij for all particles, not normalised.
  std::vector<Vec3d> slopes() const {
    std::vector<Vec3d> sums(positions_.size());
    for (std::size_t i = 0; i < sums.size(); ++i)
      for (const Neighbor& n : lists_[i]) {
        const Vec3d r = way(i, n);
        sums[i] += kernel_.slope(length(r)) / length(r) * r;
      }
    return sums;
  }

  /// Down the sum of W over all pairs; then the calibration with which the mean density is that of rest.
  void relax() {
    constexpr int kSweeps = 300, kListsFor = 10;
    constexpr double kStep = 0.12, kMomentum = 0.85, kFarthest = 0.02 * kSpacing;
    std::vector<Vec3d> moves(positions_.size());
    for (int k = 0; k < kSweeps; ++k) {
      if (k % kListsFor == 0) findNeighbors();
      const std::vector<Vec3d> up = slopes();
      for (std::size_t i = 0; i < moves.size(); ++i) {
        moves[i] = kMomentum * moves[i] - kStep * kSpacing * kernel_.radius / kernel_.exponent / 3 * up[i];
        if (const double far = length(moves[i]); far > kFarthest) moves[i] *= kFarthest / far;
        positions_[i] += moves[i];
      }
    }
    findNeighbors();
    double sum = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      sum += kernel_.value(0);
      for (const Neighbor& n : lists_[i]) sum += kernel_.value(length(way(i, n)));
    }
    factor_ = static_cast<double>(positions_.size()) / sum;
  }

  void predict() {
    const double rise = rateAt(time_ + s_["step"]) * kLength;  // m/s, of the image above
    const double faster = rise / kLength - rateAt(time_);
    offset_ += rise * s_["step"];
    offset_ -= kLength * std::floor(offset_ / kLength);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      Vec3d& p = positions_[i];
      velocities_[i].x += faster * (p.y - kLength / 2);
      p += s_["step"] * velocities_[i];
      const double over = std::floor(p.y / kLength);
      p.y -= over * kLength;
      p.x -= over * offset_;
      velocities_[i].x -= over * rise;
      p.x -= kLength * std::floor(p.x / kLength);
      p.z -= kLength * std::floor(p.z / kLength);
    }
  }

  void findDerivatives() {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      double sum = kernel_.value(0);
      for (const Neighbor& n : lists_[i]) sum += kernel_.value(length(way(i, n)));
      derivative_[i] = std::max(factor_ * sum - 1, 0.0);
    }
    if (!(s_["smoothing"] > 0)) return;
    const std::vector<double> own = derivative_;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      double weights = kernel_.value(0), sum = weights * own[i];
      for (const Neighbor& n : lists_[i]) {
        const double w = kernel_.value(length(way(i, n)));
        weights += w;
        sum += w * own[static_cast<std::size_t>(n.index)];
      }
      derivative_[i] += s_["smoothing"] * (sum / weights - own[i]);
    }
  }

  void solve() {
    const double stiffness = s_["modulus"] / kDensity * s_["step"] * s_["step"] * factor_;
    const std::vector<Vec3d> predicted = positions_;
    std::fill(displacement_.begin(), displacement_.end(), Vec3d{});
    for (int k = 0; k < static_cast<int>(s_["iterations"]); ++k) {
      findDerivatives();
      for (std::size_t i = 0; i < positions_.size(); ++i) {
        Vec3d push{};
        double divisor = 1;
        for (const Neighbor& n : lists_[i]) {
          const Vec3d r = way(i, n);
          const double a = stiffness * kernel_.slope(length(r)) / length(r);
          push -= (derivative_[i] + derivative_[static_cast<std::size_t>(n.index)]) * a * r;
          divisor += 2 * a;
        }
        displacement_[i] += (1 / divisor) * (push - displacement_[i]);
      }
      for (std::size_t i = 0; i < positions_.size(); ++i) positions_[i] = predicted[i] + displacement_[i];
    }
    findDerivatives();
    for (std::size_t i = 0; i < positions_.size(); ++i) velocities_[i] += (1 / s_["step"]) * displacement_[i];
  }

  void findStress(Tensor& mean) {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      stress_[i] = {};
      for (const Neighbor& n : lists_[i]) {
        const Vec3d r = way(i, n);
        const double sum = derivative_[i] + derivative_[static_cast<std::size_t>(n.index)];
        add(stress_[i],
            squareOf(r, -0.5 * s_["modulus"] * factor_ * sum * kernel_.slope(length(r)) / length(r)));
      }
      for (std::size_t k = 0; k < mean.size(); ++k)
        mean[k] += stress_[i][k] / static_cast<double>(positions_.size());
    }
  }

  /// Replaces each tensor by the mean over its neighbours, weighted by W.
  void spread(std::vector<Tensor>& of) const {
    std::vector<Tensor> means(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
      double weights = kernel_.value(0);
      for (std::size_t k = 0; k < of[i].size(); ++k) means[i][k] = weights * of[i][k];
      for (const Neighbor& n : lists_[i]) {
        const double w = kernel_.value(length(way(i, n)));
        weights += w;
        for (std::size_t k = 0; k < of[i].size(); ++k)
          means[i][k] += w * of[static_cast<std::size_t>(n.index)][k];
      }
      for (double& t : means[i]) t /= weights;
    }
    of = std::move(means);
  }

  /// Changes velocities, and returns the shear stress of the force that does.
  double relieve() {
    const double share = s_["step"] / (s_["step"] + s_["memory"]);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      double m = 0;
      for (const Neighbor& n : lists_[i]) {
        const double r = length(way(i, n));
        m += factor_ * kernel_.slope(r) * r / 3;
      }
      const double p = -(stress_[i][0] + stress_[i][1] + stress_[i][2]) / 3;
      for (std::size_t k = 0; k < stress_[i].size(); ++k)
        stress_[i][k] = -(stress_[i][k] + (k < 3 ? p : 0)) / m;
    }
    for (int k = 0; k < static_cast<int>(s_["spread"]); ++k) spread(stress_);
    for (std::size_t i = 0; i < positions_.size(); ++i)
      for (std::size_t k = 0; k < stress_[i].size(); ++k)
        deviator_[i][k] += share * (stress_[i][k] - deviator_[i][k]);
    double shear = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      Vec3d force{};
      for (const Neighbor& n : lists_[i]) {
        const Vec3d r = way(i, n);
        Tensor both = deviator_[i];
        add(both, deviator_[static_cast<std::size_t>(n.index)]);
        const Vec3d one = s_["relief"] * factor_ * kernel_.slope(length(r)) / length(r) * times(both, r);
        force += one;
        shear += 0.5 * one.x * r.y / static_cast<double>(positions_.size());
      }
      velocities_[i] += s_["step"] / kDensity * force;
    }
    return shear;
  }

  void shift() {
    const std::vector<Vec3d> up = slopes();
    for (std::size_t i = 0; i < positions_.size(); ++i)
      positions_[i] -= s_["shifting"] * kSpacing * kSpacing * factor_ * up[i];
  }

  Settings s_;
  Kernel kernel_;
  double factor_ = 1, offset_ = 0;  // λ = factor·Σ(1 − r/H)^n; m, of the image above
  double time_ = 0;                 // s
  std::vector<Vec3d> positions_, velocities_, displacement_;
  std::vector<double> derivative_;  // Ḃ
  std::vector<Tensor> stress_, deviator_;
  std::vector<std::vector<Neighbor>> lists_;
};

}  // namespace
}  // namespace weir

int main(int count, char** arguments) {
  weir::Settings settings{{"ratio", 1.5},   {"exponent", 3}, {"rate", 20},      {"pressure", 2000},
                          {"modulus", 1e6}, {"step", 5e-4},  {"iterations", 8}, {"smoothing", 0},
                          {"shifting", 0},  {"relief", 0},   {"memory", 0},     {"seeds", 3},
                          {"wendland", 0},  {"strain", 0},   {"period", 1},     {"spread", 0}};
  for (int k = 1; k < count; ++k) {
    const std::string word = arguments[k];
    const auto equal = word.find('=');
    const auto known = settings.find(word.substr(0, equal));
    char* end = nullptr;
    if (equal != std::string::npos && known != settings.end())
      known->second = std::strtod(word.c_str() + equal + 1, &end);
    if (end == nullptr || *end != '\0' || end == word.c_str() + equal + 1) {
      fmt::print(stderr, "found \"{}\"; allowed: NAME=NUMBER with a NAME of", word);
      for (const auto& [name, value] : settings) fmt::print(stderr, " {} ({:g})", name, value);
      fmt::print(stderr, "\n");
      return 2;
    }
  }
  weir::Result mean;
  const int seeds = std::max(1, static_cast<int>(settings["seeds"]));
  for (int seed = 1; seed <= seeds; ++seed) {
    const weir::Result one = weir::ShearedFluid(settings, static_cast<std::uint64_t>(seed)).run();
    mean.pairs += one.pairs / seeds;
    mean.relieved += one.relieved / seeds;
    mean.storage += one.storage / seeds;
    mean.loss += one.loss / seeds;
    mean.agitation += one.agitation / seeds;
    mean.neighbors += one.neighbors / seeds;
  }
  if (settings["strain"] > 0) {
    fmt::print("moduli over pressure: storage {:.4f}, loss {:.4f}; agitation {:.3f} m/s; {:.1f} neighbours\n",
               mean.storage, mean.loss, mean.agitation, mean.neighbors);
    return 0;
  }
  fmt::print("shear stress over pressure {:.4f}, of pairs {:.4f}; agitation {:.3f} m/s; {:.1f} neighbours\n",
             mean.pairs + mean.relieved, mean.pairs, mean.agitation, mean.neighbors);
}
