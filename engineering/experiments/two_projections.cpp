// A prototype of two projections (engineering/jelly.md): velocities are made free of divergence by an
// operator that is exact for linear fields, and positions go back to λ ≤ 1 beside them. In double precision,
// on one core.
//
//   g++ -std=c++20 -O3 -march=native -ffast-math engineering/experiments/two_projections.cpp -o
//   two_projections
//   ./two_projections [NAME=VALUE…]     settings and their defaults: see main
//
// With r = x_j − x_i, a_ij = V0·|W'|/r, N_i = (Σ_j a·r⊗r)⁻¹, a step is
//
//   v ← v + dt·g + filter·Σ_j V0·W·(v_j − v_i − ½·(L_i + L_j)·r),    L_i = Σ_j a·(v_j − v_i)⊗(N_i·r)
//   v ← v + Dᵀq,  q ≥ 0,  D·v ≥ −s,  complementary;                 D_i v = Σ_j a·(v_j − v_i)·N_i·r
//   x ← x + dt·v;  `sweeps` times  x ← x + Jᵀℓ,  ℓ_i = jacobi·max(λ_i − 1, 0)/(J·Jᵀ)_ii,  J being D with N =
//   1
//
// (with `spread`, the sums in N are replaced by their means over neighbours, so many times) and
// with s = (1 − λ)/relax where λ < 1, and all that is beyond `free` of it at once. q is dt·p/ρ0. With plain=1
// it is instead what SemiImplicitSolver does with K → ∞: x* = x + dt·v goes to the nearest x with λ ≤ 1,
// along Jᵀℓ, ℓ ≥ 0, and v follows. Walls are mirrors: each particle has images behind them, whose velocities
// and tensors are mirrored, too, so a tank is a half of a periodic box and D sees its walls exactly.
//
// test=0: the first mode of a tank, by potential flow; speed=0: still water. test=1: a periodic
// cube that swings (weir_shear_friction); its mean pressure is given, as the cube may expand. test=2: a dam
// breaks.
#include "two_projections_fluid.h"

namespace {

using namespace two_projections;

Vecs jittered(int nx, int ny, int nz, double d, double by, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> noise(0.5 - by, 0.5 + by);
  Vecs all;
  for (int k = 0; k < nx * ny * nz; ++k) {
    const double x = k % nx + noise(random), y = k / nx % ny + noise(random), z = k / nx / ny + noise(random);
    all.push_back(d * Vec{x, y, z});
  }
  return all;
}

/// A periodic cube of 10³ particles in the least Σ W, and the calibration with which its mean λ is 1.
Fluid relaxedCube(const Settings& s) {
  constexpr int kSide = 10, kSweeps = 300, kListsFor = 5;
  Fluid cube(s);
  cube.s["skin"] = 0.3;
  cube.high = kSide * cube.d * Vec{1, 1, 1};
  cube.x = jittered(kSide, kSide, kSide, cube.d, 0.35, unsigned(s.at("seed")));
  cube.v.resize(cube.x.size());
  Vecs moves(cube.x.size());
  for (int k = 0; k <= kSweeps; ++k) {
    if (k % kListsFor == 0) cube.keepInside(), cube.findNeighbors();
    cube.findMoments();
    if (k == kSweeps) break;
    const Vecs up = cube.push(Values(cube.x.size(), 1.0), true);
    for (std::size_t i = 0; i < moves.size(); ++i) {
      moves[i] = 0.85 * moves[i] + 0.018 * cube.d * cube.d * up[i];
      if (const double far = length(moves[i]) / cube.d; far > 0.02) moves[i] = 0.02 / far * moves[i];
      cube.x[i] += moves[i];
    }
  }
  double sum = 0;
  for (const double one : cube.lambda) sum += one;
  cube.calibration = double(cube.x.size()) / sum;
  const auto pairs = std::count_if(cube.a.begin(), cube.a.end(), [](double one) { return one > 0; });
  std::printf("calibration %.4f, %.1f neighbours\n", cube.calibration, double(pairs) / double(cube.x.size()));
  cube.s = s;
  cube.findNeighbors(), cube.findMoments();
  return cube;
}

/// At rest, as the plain step leaves it once velocities are damped.
Fluid settledTank(const Settings& s, double long_, double depth, double wide, bool ends) {
  Fluid tank(s);
  tank.calibration = relaxedCube(s).calibration;
  tank.faces = {ends ? Face::kMirror : Face::kPeriodic, Face::kMirror, Face::kPeriodic};
  tank.open = true;
  tank.high = {long_, 4 * depth, wide};
  tank.x = jittered(int(std::lround(long_ / tank.d)), int(std::lround(depth / tank.d)),
                    int(std::lround(wide / tank.d)), tank.d, 0.2, unsigned(s.at("seed")));
  tank.v.resize(tank.x.size());
  for (double t = 0, end = s.at("settle"); t < end; t += tank.dt) {
    for (Vec& one : tank.v) one = (t < 0.8 * end ? 0.95 : 0.7) * (one - Vec{0, kGravity * tank.dt, 0});
    tank.plainStep();
  }
  for (Vec& one : tank.v) one = {};
  tank.findNeighbors(), tank.findMoments();
  tank.iterations = 0;
  return tank;
}

struct Mode {
  double k, depth;
  Vec operator()(const Vec& p) const {
    return 1 / std::sinh(k * depth) *
           Vec{-std::sin(k * p.x) * std::cosh(k * p.y), std::cos(k * p.x) * std::sinh(k * p.y), 0};
  }
  double period() const { return 2 * kPi / std::sqrt(kGravity * k * std::tanh(k * depth)); }
};

void report(const Fluid& f, double time, double begin, double amplitude, const Mode& mode) {
  double noise = 0, fastest = 0, over = 0, most = 0;
  std::vector<double> along;
  for (std::size_t i = 0; i < f.x.size(); ++i) {
    const Vec u = f.v[i] - amplitude * mode(f.x[i]);
    noise += dot(u, u) / double(f.x.size());
    fastest = std::max(fastest, length(f.v[i]));
    over += std::max(0.0, f.lambda[i] - 1) / double(f.x.size());
    most = std::max(most, f.lambda[i]);
    along.push_back(f.x[i].x);
  }
  std::sort(along.begin(), along.end());
  std::printf(
      "t %.3f: amplitude %+.4f, beside it %.4f, fastest %.3f m/s; energy %+.5f, kinetic %.5f, lifted %.4f "
      "J/kg; "
      "mean height %.4f, front %.3f m; compressed %.3f %%, most %.2f %%, nearest %.2f d\n",
      time, amplitude, std::sqrt(noise), fastest, f.energy() - begin, f.kinetic(), f.lifted, f.height(),
      along[along.size() * 995 / 1000], 100 * over, 100 * (most - 1), f.nearest());
  std::fflush(stdout);
}

/// Runs, and returns the times and amplitudes of the mode.
std::vector<std::array<double, 2>> runTank(Fluid& f, const Mode& mode) {
  std::vector<std::array<double, 2>> found;
  const double begin = f.energy();
  const int steps = int(std::lround(f.s["duration"] / f.dt)), every = std::max(1, int(steps / f.s["lines"]));
  double last = begin, rises = 0;
  for (int k = 0; k <= steps; ++k) {
    double along = 0, squares = 0;
    for (std::size_t i = 0; i < f.x.size(); ++i)
      along += dot(mode(f.x[i]), f.v[i]), squares += dot(mode(f.x[i]), mode(f.x[i]));
    found.push_back({k * f.dt, along / squares});
    rises += std::max(0.0, f.energy() - last);
    last = f.energy();
    if (k % every == 0) report(f, k * f.dt, begin, f.s["test"] == 0 ? along / squares : 0, mode);
    f.step();
  }
  std::printf("sum of all rises of energy %.5f J/kg; %.1f iterations a step\n", rises,
              double(f.iterations) / steps);
  return found;
}

void wave(const Settings& s) {
  const double size = s.at("length");
  Fluid f = settledTank(s, size, s.at("depth"), s.at("width") * s.at("d"), s.at("ends") > 0);
  const Mode mode{kPi / size * (s.at("ends") > 0 ? 1 : 2), 2 * f.height()};
  for (std::size_t i = 0; i < f.x.size(); ++i) f.v[i] = s.at("speed") * mode(f.x[i]);
  const auto found = runTank(f, mode);
  std::vector<double> zeros, most{0};
  for (std::size_t k = 1; k < found.size(); ++k) {
    const auto [t, now] = found[k];
    const auto [before, was] = found[k - 1];
    if ((now > 0) != (was > 0)) zeros.push_back(before - was * (t - before) / (now - was)), most.push_back(0);
    most.back() = std::max(most.back(), std::abs(now));
  }
  if (!(s.at("speed") > 0) || zeros.size() < 2) return;
  const double period = 2 * (zeros.back() - zeros.front()) / double(zeros.size() - 1);
  std::printf("period %+.2f %%; lost", 100 * (period / mode.period() - 1));
  for (std::size_t k = 1; k + 1 < most.size(); ++k)
    std::printf(" %.1f %%", 100 * (1 - most[k] / s.at("speed")));
  std::printf("\n");
}

void dam(const Settings& s) {
  Fluid f = settledTank(s, s.at("column"), s.at("depth"), s.at("width") * s.at("d"), true);
  f.high.x = s.at("length");
  f.findNeighbors(), f.findMoments();
  runTank(f, {1, 1});
}

void shear(const Settings& s) {
  Fluid f = relaxedCube(s);
  const double size = f.high.x, rest = 0.3, w = 2 * kPi / s.at("period");
  const auto rateAt = [&](double t) { return t < rest ? 0 : s.at("strain") * w * std::cos(w * (t - rest)); };
  double pressure = 0, inPhase = 0, outOfPhase = 0, agitation = 0;
  int measured = 0;
  for (double t = 0; t < rest + s.at("period"); t += f.dt) {
    const double rate = rateAt(t + f.dt);
    for (std::size_t i = 0; i < f.x.size(); ++i) f.v[i].x += (rate - f.rise / size) * (f.x[i].y - size / 2);
    f.rise = rate * size;
    f.project(s.at("pressure"));
    double stress = 0, p = 0, squares = 0, mean = 0;
    for (std::size_t i = 0; i < f.x.size(); ++i) {
      for (int o = f.start[i]; o < f.start[i + 1]; ++o) {
        const int k = f.neighbor[o];
        const Vec e = f.a[o] * f.r[o], force = f.q[i] * (f.N[i] * e) + f.q[f.images[k].of] * (f.N[k] * e);
        stress -= force.x * f.r[o].y / 2, p += dot(force, f.r[o]) / 6;
      }
      const Vec u = f.v[i] - Vec{rate * (f.x[i].y - size / 2), 0, 0};
      squares += dot(u, u) / double(f.x.size());
      f.x[i] += f.dt * f.v[i];
    }
    f.offset = std::fmod(f.offset + f.rise * f.dt + size, size);
    f.keepInside();
    f.correct();
    for (const double one : f.lambda) mean += one / double(f.x.size());
    f.calibration *= 1 + 0.1 * std::clamp(1 - mean, -0.01, 0.01);  // in place of the cube's volume
    if (t < rest) continue;
    ++measured, pressure += p, agitation += squares;
    inPhase += stress * std::sin(w * (t + f.dt - rest)),
        outOfPhase += stress * std::cos(w * (t + f.dt - rest));
  }
  std::printf("moduli over pressure: storage %.4f, loss %.4f; agitation %.4f m/s\n",
              inPhase / (pressure * s.at("strain") / 2), outOfPhase / (pressure * s.at("strain") / 2),
              std::sqrt(agitation / measured));
}

}  // namespace

int main(int count, char** words) {
  Settings s{{"test", 0},       {"plain", 0},     {"d", 0.025},        {"ratio", 2},    {"dt", 2e-3},
             {"length", 1},     {"depth", 0.4},   {"width", 5},        {"ends", 1},     {"speed", 0.192},
             {"duration", 1.6}, {"column", 0.35}, {"settle", 0.6},     {"seed", 1},     {"lines", 8},
             {"skin", 0.15},    {"filter", 0.3},  {"spread", 0},       {"relax", 0.02}, {"free", 0.03},
             {"sweeps", 2},     {"jacobi", 0.5},  {"tolerance", 1e-3},  // 1/s
             {"strain", 0.03},  {"period", 1},    {"pressure", 2000}};
  for (int k = 1; k < count; ++k) {
    const std::string word = words[k];
    const auto known = s.find(word.substr(0, word.find('=')));
    if (known == s.end() || word.find('=') == std::string::npos) {
      std::fprintf(stderr, "found \"%s\"; allowed: NAME=NUMBER with a NAME of", words[k]);
      for (const auto& [name, value] : s) std::fprintf(stderr, " %s (%g)", name.c_str(), value);
      std::fprintf(stderr, "\n");
      return 2;
    }
    known->second = std::strtod(word.c_str() + word.find('=') + 1, nullptr);
  }
  s["test"] == 1 ? shear(s) : s["test"] == 2 ? dam(s) : wave(s);
}
