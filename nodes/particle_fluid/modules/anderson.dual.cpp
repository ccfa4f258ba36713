#include <cmath>

#include "nodes/particle_fluid/modules/anderson.h"

namespace weir {

namespace {

constexpr int kEarlier = AndersonHistory::kEarlier;

/// How many earlier iterates the next one is combined of; 0 if it is to be plain.
WEIR_HD int earlierOf(const SolverControl& control) {
  if (control.done || control.takesBack || control.momentum == 0) return 0;
  const int made = control.sinceRestart - 1, max = control.exhausted ? 1 : kEarlier;
  return made < max ? made : max;
}

struct MeasureResiduals {
  const SolverControl* control;
  AndersonHistory history;
  ArrayView<const Vec3f> displacement;

  WEIR_HD AndersonGram operator()(std::int64_t i) const {
    AndersonGram gram;
    const int earlier = earlierOf(*control);
    if (earlier == 0 || control->exhausted) return gram;
    const Vec3f now = displacement[i] - history.start(control->entry, i);
    Vec3f difference[kEarlier] = {};
    for (int j = 0; j < kEarlier; ++j) {
      if (j >= earlier) continue;  // a fixed number of turns is faster
      const int entry = AndersonHistory::before(control->entry, j + 1);
      difference[j] = now - (history.result(entry, i) - history.start(entry, i));
    }
    int p = 0;
    for (int j = 0; j < kEarlier; ++j) {
      gram.right[j] = product(difference[j], now);
      for (int l = j; l < kEarlier; ++l) gram.products[p++] = product(difference[j], difference[l]);
    }
    return gram;
  }

  /// Residuals of converged iterations are so small that squares of floats would lose them.
  WEIR_HD static double product(const Vec3f& a, const Vec3f& b) {
    return double(a.x) * double(b.x) + double(a.y) * double(b.y) + double(a.z) * double(b.z);
  }
};

struct AddGrams {
  WEIR_HD AndersonGram operator()(const AndersonGram& a, const AndersonGram& b) const {
    AndersonGram sum;
    for (int p = 0; p < AndersonGram::kProducts; ++p) sum.products[p] = a.products[p] + b.products[p];
    for (int j = 0; j < kEarlier; ++j) sum.right[j] = a.right[j] + b.right[j];
    return sum;
  }
};

/// Solves (G + ε·tr(G))·γ = b by Cholesky's decomposition. Where a pivot is not positive, or anything is no
/// number, all weights are 0.
struct SolveWeights {
  const SolverControl* control;
  const AndersonGram* gram;
  AndersonWeights* weights;

  WEIR_HD void operator()(std::int64_t) const {
    *weights = {};
    if (control->exhausted) {
      weights->of[0] = -control->momentum;
      return;
    }
    const int n = earlierOf(*control);
    double lower[kEarlier][kEarlier] = {}, x[kEarlier] = {};
    if (n == 0 || !decompose(n, lower)) return;
    for (int j = 0; j < n; ++j) {
      x[j] = gram->right[j];
      for (int l = 0; l < j; ++l) x[j] -= lower[j][l] * x[l];
      x[j] /= lower[j][j];
    }
    for (int j = n - 1; j >= 0; --j) {
      for (int l = j + 1; l < n; ++l) x[j] -= lower[l][j] * x[l];
      x[j] /= lower[j][j];
    }
    for (int j = 0; j < n; ++j) {
      if (!(fabs(x[j]) < kMaxWeight)) return;
    }
    for (int j = 0; j < n; ++j) weights->of[j] = float(x[j]);
  }

  WEIR_HD bool decompose(int n, double (&lower)[kEarlier][kEarlier]) const {
    double matrix[kEarlier][kEarlier] = {}, trace = 0;
    int p = 0;
    for (int j = 0; j < kEarlier; ++j) {
      for (int l = j; l < kEarlier; ++l) matrix[l][j] = gram->products[p++];
      trace += matrix[j][j];
    }
    for (int j = 0; j < n; ++j) {
      for (int l = 0; l <= j; ++l) {
        double rest = matrix[j][l] + (l == j ? kRegularization * trace : 0.0);
        for (int q = 0; q < l; ++q) rest -= lower[j][q] * lower[l][q];
        if (l == j && !(rest > 0)) return false;
        lower[j][l] = l == j ? sqrt(rest) : rest / lower[l][l];
      }
    }
    return true;
  }

  static constexpr double kRegularization = 1e-10;
  static constexpr double kMaxWeight = 1e6;  // beyond it floats keep nothing of the iterates
};

/// The next iterate, and the plain one into the history; or the last plain one.
struct Mix {
  const SolverControl* control;
  const AndersonWeights* weights;
  AndersonHistory history;
  AndersonIterate iterate;

  WEIR_HD void operator()(std::int64_t i) const {
    if (control->done) return;
    const int latest = control->entry;
    if (history.shares.size > 0) {
      float& share = iterate.share[i];
      share =
          mixed(share, history.share(latest, i), [this, i](int entry) { return history.share(entry, i); });
    }
    const Vec3f u = iterate.displacement[i];
    const Vec3f next =
        mixed(u, history.result(latest, i), [this, i](int entry) { return history.result(entry, i); });
    if (next == u) return;
    iterate.displacement[i] = next;
    const Vec3f p = iterate.predicted[i] + next;
    iterate.state[i] = {p.x, p.y, p.z, 0};
  }

  template <class T, class Earlier>
  WEIR_HD T mixed(const T& plain, T& latest, const Earlier& earlierAt) const {
    if (control->takesBack) return latest;
    latest = plain;
    T next = plain;
    const int earlier = earlierOf(*control);
    for (int j = 0; j < earlier; ++j) {
      const T before = earlierAt(AndersonHistory::before(control->entry, j + 1));
      next = next - weights->of[j] * (plain - before);
    }
    return next;
  }
};

}  // namespace

template <class Backend>
void AndersonMixing::mixOn(Backend& device, Count count, const SolverControl* control,
                           const AndersonIterate& iterate) {
  reduce(device, "measure residuals", count, AndersonGram{},
         MeasureResiduals{control, view(), iterate.displacement}, AddGrams{}, gram_.data());
  parallelFor(device, "weigh", 1, SolveWeights{control, gram_.data(), weights_.data()});
  parallelFor(device, "mix", count, Mix{control, weights_.data(), view(), iterate});
}

template void AndersonMixing::mixOn(ThisBackend&, Count, const SolverControl*, const AndersonIterate&);

}  // namespace weir
