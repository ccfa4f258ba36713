// Anderson's acceleration of a solver's iterations (Anderson 1965, "Iterative Procedures for Nonlinear
// Integral Equations"; this is the form that Fang and Saad 2009 call type II).
//
// With u the displacement, f(u) what a plain iteration makes of it and r = f(u) − u, the next iterate is
//
//   u_k+1 = f(u_k) − Σ_j γ_j·(f(u_k) − f(u_k−j)),   j = 1 … m,  m = 3 or as many as there are
//
// where γ makes |r_k − Σ_j γ_j·(r_k − r_k−j)|² + ε·tr·|γ|² least: the combination of iterates whose residual
// is the smallest, were f linear. tr is the trace of the Gram matrix of the differences of residuals, and
// ε = 1e-10 keeps differences that are nearly parallel from getting huge weights. Sums are of doubles.
//
// The residual of a soft mode is a thousandth of how far it is from its end, or less. In floats noise of the
// positions drowns it long before that end: from there on the best mixtures are means of noise, and lead on
// no faster than plain iterations. So when a mixture lowers the objective by no more than its rounding, the
// rest of the pass goes on with Nesterov's momentum, which looks at no residuals: it is a mixture, too, with
// γ_1 = −k/(k + 3) alone.
//
// What the displacement is made of, as the share of walls in it, is combined in the same way. Restarts and
// the judgement whether an iterate is to be taken back are the solver's, see SolverControl.
#pragma once

#include "framework/base/api.h"
#include "framework/base/vec.h"
#include "framework/compute/device.h"
#include "framework/compute/parallel.h"
#include "nodes/particle_fluid/modules/accelerated_control.h"

namespace WEIR_API weir {

/// A ring of iterates, for kernels; empty where nobody mixes. Entry e of particle i is at [e·stride + i].
struct AndersonHistory {
  static constexpr int kEarlier = 3;  // m
  static constexpr int kEntries = kEarlier + 1;

  ArrayView<Vec3f> starts;   ///< u
  ArrayView<Vec3f> results;  ///< f(u)
  ArrayView<float> shares;   ///< of walls in f(u); empty without them
  std::int64_t stride = 0;

  WEIR_HD bool empty() const { return stride == 0; }
  /// The entry that was made j iterations before `latest`, j at most kEarlier.
  WEIR_HD static int before(int latest, int j) { return (latest + kEntries - j) % kEntries; }
  WEIR_HD static int after(int latest) { return (latest + 1) % kEntries; }
  WEIR_HD Vec3f& start(int entry, std::int64_t i) const { return starts[entry * stride + i]; }
  WEIR_HD ArrayView<Vec3f> startsOf(int entry) const { return {starts.data + entry * stride, stride}; }
  WEIR_HD Vec3f& result(int entry, std::int64_t i) const { return results[entry * stride + i]; }
  WEIR_HD float& share(int entry, std::int64_t i) const { return shares[entry * stride + i]; }
};

/// γ; all 0 for a plain step.
struct AndersonWeights {
  float of[AndersonHistory::kEarlier] = {};
};

/// Sums of products of residuals' differences with each other (upper triangle, by rows) and with r_k.
struct AndersonGram {
  static constexpr int kProducts = AndersonHistory::kEarlier * (AndersonHistory::kEarlier + 1) / 2;
  double products[kProducts] = {};
  double right[AndersonHistory::kEarlier] = {};
};

/// What is mixed.
struct AndersonIterate {
  ArrayView<Vec3f> displacement;
  ArrayView<float> share;            ///< of walls; empty without them
  ArrayView<const Vec3f> predicted;  ///< positions without displacement
  ArrayView<Vec4f> state;            ///< positions with it, and 0
};

class AndersonMixing {
 public:
  /// Memory for that many particles: 96 bytes each, and 16 more with shares of walls. Contents are undefined.
  void reserve(Device& device, std::int64_t particles, bool shares);
  /// Bytes of that.
  double memoryFor(double particles, bool shares) const;
  /// Gives it back.
  void release();
  /// Empty if nothing is reserved. The solver writes the start of control's entry before its iteration.
  AndersonHistory view();
  /// Puts the next iterate in place of the plain one, or goes back to the last plain one, as `control` (on
  /// the device) says. Waits for nothing, allocates nothing.
  void mix(Device& device, Count count, const SolverControl* control, const AndersonIterate& iterate) {
    dispatch(device, [&](auto& backend) { mixOn(backend, count, control, iterate); });
  }

 private:
  template <class Backend>
  void mixOn(Backend& device, Count count, const SolverControl* control, const AndersonIterate& iterate);

  Array<Vec3f> starts_, results_;
  Array<float> shares_;
  Array<AndersonGram> gram_;
  Array<AndersonWeights> weights_;
};

}  // namespace weir
