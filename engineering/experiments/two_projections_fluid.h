// The fluid of two_projections.cpp, which says what a step is: pairs, the operator and its adjoint, solves,
// steps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace two_projections {

using Settings = std::map<std::string, double>;
using Values = std::vector<double>;
constexpr double kPi = std::numbers::pi, kGravity = 9.8, kDensity = 1000;

struct Vec {
  double x = 0, y = 0, z = 0;
  double& operator[](int k) { return k == 0 ? x : k == 1 ? y : z; }
  double operator[](int k) const { return k == 0 ? x : k == 1 ? y : z; }
  Vec& operator+=(const Vec& b) { return *this = {x + b.x, y + b.y, z + b.z}; }
  Vec& operator-=(const Vec& b) { return *this = {x - b.x, y - b.y, z - b.z}; }
};
inline Vec operator+(Vec a, const Vec& b) {
  return a += b;
}
inline Vec operator-(Vec a, const Vec& b) {
  return a -= b;
}
inline Vec operator*(double s, const Vec& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline double dot(const Vec& a, const Vec& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline double length(const Vec& a) {
  return std::sqrt(dot(a, a));
}
inline Vec each(const Vec& a, const Vec& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
using Vecs = std::vector<Vec>;

struct Matrix {  // rows
  Vec x, y, z;
  Vec operator*(const Vec& r) const { return {dot(x, r), dot(y, r), dot(z, r)}; }
  Matrix mirrored(const Vec& s) const { return {s.x * each(x, s), s.y * each(y, s), s.z * each(z, s)}; }
  void addProduct(const Vec& a, const Vec& b) { x += a.x * b, y += a.y * b, z += a.z * b; }
};
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Of a symmetric matrix of moments, made regular where neighbours are few or lie in a plane.
inline Matrix inverse(Matrix m) {
  constexpr double kLeastDeterminant = 0.1, kLeastTrace = 0.25;  // where all is there, both are about 1
  const double third = (m.x.x + m.y.y + m.z.z) / 3, det = dot(m.x, cross(m.y, m.z));
  const double flat = std::max(0.0, 1 - det / (third * third * third + 1e-12) / kLeastDeterminant);
  const double more = 0.5 * flat * std::max(third, 0.3) + std::max(0.0, kLeastTrace - third);
  m.x.x += more, m.y.y += more, m.z.z += more;
  const double scale = 1 / dot(m.x, cross(m.y, m.z));
  return {scale * cross(m.y, m.z), scale * cross(m.z, m.x), scale * cross(m.x, m.y)};
}

enum class Face { kPeriodic, kMirror };

class Fluid {
 public:
  explicit Fluid(const Settings& settings)
      : s(settings), d(s.at("d")), H(s.at("ratio") * d), V0(d * d * d), dt(s.at("dt")) {}

  Settings s;
  double d, H, V0, dt, calibration = 1;
  std::array<Face, 3> faces{Face::kPeriodic, Face::kPeriodic, Face::kPeriodic};
  Vec low, high;
  bool open = false;            // above
  double offset = 0, rise = 0;  // of the images above, along x: Lees and Edwards
  Vecs x, v;
  Values lambda, q;
  std::vector<Matrix> N;  // of images, too
  long iterations = 0;
  double lifted = 0;  // by corrections of positions, J/kg

  struct Image {
    int of;
    Vec sign, shift, speed;
  };
  std::vector<Image> images;  // the particles first
  std::vector<int> start, neighbor;
  Vecs r;
  Values a, w;  // a, and V0·W

  void findNeighbors() {
    findImages();
    const double reach = H + s["skin"] * d;
    const Vec from = low - Vec{2 * reach, 2 * reach, 2 * reach};
    std::map<std::array<int, 3>, std::vector<int>> cells;
    const auto cell = [&](const Vec& p) {
      return std::array{int((p.x - from.x) / reach), int((p.y - from.y) / reach),
                        int((p.z - from.z) / reach)};
    };
    for (std::size_t k = 0; k < all.size(); ++k) cells[cell(all[k])].push_back(int(k));
    start.assign(1, 0), neighbor.clear();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto c = cell(x[i]);
      for (int n = 0; n < 27; ++n)
        if (const auto found = cells.find({c[0] + n % 3 - 1, c[1] + n / 3 % 3 - 1, c[2] + n / 9 - 1});
            found != cells.end())
          for (const int k : found->second)
            if (k != int(i) && length(all[std::size_t(k)] - x[i]) < reach) neighbor.push_back(k);
      start.push_back(int(neighbor.size()));
    }
    r.resize(neighbor.size()), a.resize(neighbor.size()), w.resize(neighbor.size());
  }

  /// r, a, λ and N at x, by the lists that there are.
  void findMoments() {
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = each(images[k].sign, x[std::size_t(images[k].of)]) + images[k].shift;
    const double scale = V0 * calibration * 15 / (kPi * H * H * H);
    lambda.resize(x.size()), N.resize(all.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      Matrix moments;
      lambda[i] = scale;
      for (int o = start[i]; o < start[i + 1]; ++o) {
        r[o] = all[neighbor[o]] - x[i];
        const double far = length(r[o]) + 1e-12, t = std::max(0.0, 1 - far / H);
        w[o] = scale * t * t * t;
        a[o] = scale * 3 / H * t * t / far;
        lambda[i] += w[o];
        moments.addProduct(a[o] * r[o], r[o]);
      }
      N[i] = moments;
    }
    for (int k = 0; k < int(s["spread"]); ++k) spread();
    for (std::size_t i = 0; i < x.size(); ++i) N[i] = inverse(N[i]);
    mirror(N);
  }

  /// Moments become their means over neighbours, weighted by 1 − r/H.
  void spread() {
    mirror(N);
    std::vector<Matrix> means(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      double weights = 1;
      means[i] = N[i];
      for (int o = start[i]; o < start[i + 1]; ++o) {
        const double weight = std::max(0.0, 1 - length(r[o]) / H);
        const Matrix& m = N[neighbor[o]];
        weights += weight;
        means[i].x += weight * m.x, means[i].y += weight * m.y, means[i].z += weight * m.z;
      }
      means[i] = {1 / weights * means[i].x, 1 / weights * means[i].y, 1 / weights * means[i].z};
    }
    std::copy(means.begin(), means.end(), N.begin());
  }

  /// D·u, or −dλ/dt with `plain`.
  Values divergence(const Vecs& u, bool plain, bool moving = false) {
    const Vecs of = withImages(u, moving);
    Values sums(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (plain) {
        for (int o = start[i]; o < start[i + 1]; ++o) sums[i] += a[o] * dot(r[o], of[neighbor[o]] - u[i]);
        continue;
      }
      const Matrix g = moment(i, of, u[i]);
      sums[i] = dot(N[i].x, g.x) + dot(N[i].y, g.y) + dot(N[i].z, g.z);
    }
    return sums;
  }

  /// Dᵀp, or Jᵀp with `plain`: how pressure pushes.
  Vecs push(const Values& p, bool plain) const {
    Vecs sums(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec own;
      for (int o = start[i]; o < start[i + 1]; ++o) {
        const Vec e = a[o] * r[o];
        own += e;
        sums[i] -= p[images[neighbor[o]].of] * (plain ? e : N[neighbor[o]] * e);
      }
      sums[i] -= p[i] * (plain ? own : N[i] * own);
    }
    return sums;
  }

  Values diagonal(bool plain) const {
    Values sums(x.size(), 1e-300);
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec own;
      for (int o = start[i]; o < start[i + 1]; ++o) {
        const Vec e = plain ? a[o] * r[o] : N[i] * (a[o] * r[o]);
        own += e;
        sums[i] += dot(e, e);
      }
      sums[i] += dot(own, own);
    }
    return sums;
  }

  /// A·p ≥ b, p ≥ 0, complementary, A = D·Dᵀ or J·Jᵀ: conjugate gradients in the free ones, a few times.
  void solve(Values& p, const Values& b, bool plain, double tolerance) {
    const Values diagonals = diagonal(plain);
    std::vector<char> is(x.size());
    Values residual(x.size()), direction(x.size()), z(x.size());
    constexpr int kRounds = 6, kMost = 200;
    for (int round = 0; round < kRounds; ++round) {
      const Values Ap = divergence(push(p, plain), plain);
      double left = 0, rz = 0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        residual[i] = b[i] - Ap[i];
        is[i] = p[i] > 0 || residual[i] > 0;
        direction[i] = z[i] = is[i] ? residual[i] / diagonals[i] : 0;
        left += is[i] ? residual[i] * residual[i] : 0;
        rz += z[i] * residual[i];
      }
      for (int k = 0; k < kMost && std::sqrt(left / double(x.size())) > (k == 0 ? 1 : 0.3) * tolerance; ++k) {
        const Values Ad = divergence(push(direction, plain), plain);
        ++iterations;
        double curvature = 0, next = 0;
        for (std::size_t i = 0; i < x.size(); ++i) curvature += direction[i] * Ad[i];
        if (!(curvature > 0)) break;
        left = 0;
        for (std::size_t i = 0; i < x.size(); ++i) {
          if (!is[i]) continue;
          p[i] += rz / curvature * direction[i];
          residual[i] -= rz / curvature * Ad[i];
          z[i] = residual[i] / diagonals[i];
          left += residual[i] * residual[i];
          next += z[i] * residual[i];
        }
        for (std::size_t i = 0; i < x.size(); ++i) direction[i] = is[i] ? z[i] + next / rz * direction[i] : 0;
        rz = next;
      }
      bool clamped = false;
      for (double& one : p) clamped |= one < 0, one = std::max(one, 0.0);
      if (!clamped && round > 0) break;
    }
  }

  /// A·p = b + c where the mean of p is given, c being found: the cube expands at the rate c.
  void solveWithMean(Values& p, const Values& b, double mean, double tolerance) {
    const auto toMean = [](Values& of, double m) {
      for (double one : Values(of)) m -= one / double(of.size());
      for (double& one : of) one += m;
    };
    toMean(p, mean);
    Values residual = divergence(push(p, false), false), direction;
    for (std::size_t i = 0; i < x.size(); ++i) residual[i] = b[i] - residual[i];
    toMean(residual, 0);
    direction = residual;
    const auto square = [](const Values& of) {
      double sum = 0;
      for (double one : of) sum += one * one;
      return sum;
    };
    double rr = square(residual);
    for (int k = 0; k < 400 && std::sqrt(rr / double(x.size())) > tolerance; ++k) {
      const Values Ad = divergence(push(direction, false), false);
      double curvature = 0;
      for (std::size_t i = 0; i < x.size(); ++i) curvature += direction[i] * Ad[i];
      for (std::size_t i = 0; i < x.size(); ++i)
        p[i] += rr / curvature * direction[i], residual[i] -= rr / curvature * Ad[i];
      toMean(residual, 0);
      const double next = square(residual);
      for (std::size_t i = 0; i < x.size(); ++i) direction[i] = residual[i] + next / rr * direction[i];
      rr = next;
    }
  }

  void smooth() {
    const Vecs of = withImages(v, true);
    std::vector<Matrix> L(all.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Matrix g = moment(i, of, v[i]);  // Σ a·r⊗Δv
      for (int k = 0; k < 3; ++k) {
        const Vec row = N[i] * Vec{g.x[k], g.y[k], g.z[k]};
        (k == 0 ? L[i].x : k == 1 ? L[i].y : L[i].z) = row;
      }
    }
    mirror(L);
    for (std::size_t i = 0; i < x.size(); ++i) {
      Vec change;
      for (int o = start[i]; o < start[i + 1]; ++o)
        change += w[o] * (of[neighbor[o]] - of[i] - 0.5 * (L[i] * r[o] + L[neighbor[o]] * r[o]));
      v[i] += s["filter"] * change;
    }
  }

  /// From lists and moments at x, and v with what accelerates it. `mean` is a pressure, see solveWithMean.
  void project(double mean = -1) {
    if (s["filter"] > 0) smooth();
    Values b = divergence(v, false, true);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double room = std::max(0.0, 1 - lambda[i]);
      b[i] = -b[i] - room / s["relax"] - std::max(0.0, room - s["free"]) / dt;
    }
    q.resize(x.size());
    if (mean >= 0)
      solveWithMean(q, b, mean * dt / kDensity, s["tolerance"]);
    else
      solve(q, b, false, s["tolerance"]);
    const Vecs change = push(q, false);
    for (std::size_t i = 0; i < x.size(); ++i) v[i] += change[i];
  }

  /// Lists and moments anew, and positions towards λ ≤ 1.
  void correct() {
    const double before = height();
    findNeighbors();
    for (int k = 0; k < int(s["sweeps"]); ++k) {
      findMoments();
      Values multipliers = diagonal(true);
      for (std::size_t i = 0; i < x.size(); ++i)
        multipliers[i] = s["jacobi"] * std::max(0.0, lambda[i] - 1) / multipliers[i];
      const Vecs move = push(multipliers, true);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += move[i];
    }
    findMoments();
    lifted += kGravity * (height() - before);
  }

  void step() {
    for (Vec& one : v) one.y -= kGravity * dt;
    if (s["plain"] > 0) return plainStep();
    project();
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * v[i];
    keepInside();
    correct();
  }

  /// With gravity already in v.
  void plainStep() {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += dt * v[i];
    keepInside();
    findNeighbors();
    const Vecs predicted = x;
    Vecs move(x.size());
    Values multipliers(x.size());
    constexpr int kNewton = 6;
    constexpr double kCompression = 1e-4;
    for (int k = 0; k < kNewton; ++k) {
      findMoments();
      Values b = divergence(move, true);  // of what has moved, which is found anew from here
      double over = 0;
      for (std::size_t i = 0; i < x.size(); ++i)
        b[i] += lambda[i] - 1, over += std::max(0.0, lambda[i] - 1) / double(x.size());
      if (k > 0 && over < kCompression) break;
      solve(multipliers, b, true, 0.1 * kCompression);
      move = push(multipliers, true);
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = predicted[i] + move[i];
    }
    for (std::size_t i = 0; i < x.size(); ++i) v[i] += (1 / dt) * move[i];
    keepInside();
  }

  void keepInside() {
    const double gap = 0.05 * d;
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double over = faces[1] == Face::kPeriodic ? std::floor((x[i].y - low.y) / (high.y - low.y)) : 0;
      x[i] -= over * Vec{offset, high.y - low.y, 0};
      v[i].x -= over * rise;
      for (int k = 0; k < 3; ++k) {
        if (faces[std::size_t(k)] == Face::kPeriodic) {
          x[i][k] -= (high[k] - low[k]) * std::floor((x[i][k] - low[k]) / (high[k] - low[k]));
          continue;
        }
        if (x[i][k] < low[k] + gap) x[i][k] = low[k] + gap, v[i][k] = std::max(0.0, v[i][k]);
        if (!(k == 1 && open) && x[i][k] > high[k] - gap)
          x[i][k] = high[k] - gap, v[i][k] = std::min(0.0, v[i][k]);
      }
    }
  }

  double height() const {
    double sum = 0;
    for (const Vec& p : x) sum += p.y / double(x.size());
    return sum;
  }
  double kinetic() const {
    double sum = 0;
    for (const Vec& u : v) sum += dot(u, u) / 2 / double(x.size());
    return sum;
  }
  double energy() const { return kinetic() + kGravity * height(); }
  double nearest() const {
    double least = H;
    for (const Vec& one : r) least = std::min(least, length(one));
    return least / d;
  }

 private:
  Vecs all;  // positions of images

  /// Images above first, as those are moved along x.
  void findImages() {
    const double reach = H + s["skin"] * d;
    images.clear(), all = x;
    for (std::size_t i = 0; i < x.size(); ++i) images.push_back({int(i), {1, 1, 1}, {}, {}});
    for (const int axis : {1, 0, 2}) {
      const double size = high[axis] - low[axis];
      const auto add = [&](Image g, double sign, double shift, double up) {
        g.sign[axis] *= sign, g.shift[axis] = sign * g.shift[axis] + shift;
        g.shift.x += up * offset, g.speed.x += up * rise;
        const Vec p = each(g.sign, x[std::size_t(g.of)]) + g.shift;
        if (p[axis] < low[axis] - reach || p[axis] > high[axis] + reach) return;
        images.push_back(g), all.push_back(p);
      };
      for (std::size_t k = 0, count = images.size(); k < count; ++k) {
        const Image g = images[k];
        if (faces[std::size_t(axis)] == Face::kMirror) {
          add(g, -1, 2 * low[axis], 0);
          if (!(axis == 1 && open)) add(g, -1, 2 * high[axis], 0);
          continue;
        }
        for (int n = 1; (n - 2) * size < reach; ++n)
          for (const int side : {-n, n}) add(g, 1, side * size, axis == 1 ? side : 0);
      }
    }
  }
  Vecs withImages(const Vecs& u, bool moving) const {
    Vecs of(images.size());
    for (std::size_t k = 0; k < of.size(); ++k) {
      of[k] = each(images[k].sign, u[std::size_t(images[k].of)]);
      // Images speed by how far up they are, whatever the shear is at this time.
      if (moving && rise != 0) of[k].x += std::round(images[k].shift.y / (high.y - low.y)) * rise;
    }
    return of;
  }
  void mirror(std::vector<Matrix>& of) const {
    for (std::size_t k = x.size(); k < of.size(); ++k)
      of[k] = of[std::size_t(images[k].of)].mirrored(images[k].sign);
  }
  /// Σ_j a·r⊗(u_j − u).
  Matrix moment(std::size_t i, const Vecs& of, const Vec& u) const {
    Matrix sum;
    for (int o = start[i]; o < start[i + 1]; ++o) sum.addProduct(a[o] * r[o], of[neighbor[o]] - u);
    return sum;
  }
};

}  // namespace two_projections
