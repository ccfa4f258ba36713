// How much of the server's time a client may take. What it does not use is saved up to a limit, so that a
// quick burst is served at once; who goes on and on is served slowly, and everybody else as ever.
#pragma once

#include <chrono>

namespace weir::studio {

class Allowance {
 public:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;
  static constexpr Seconds kMax{0.1};  ///< what can be saved
  /// Who had to wait goes on with so much: fewer, longer turns disturb a simulation less than one a message.
  static constexpr Seconds kTurn{0.002};
  static constexpr Seconds kLongestWait{2};

  explicit Allowance(Clock::time_point now) : at_(now) {}

  /// The client took so much of the server's time, and gets this share of all time that goes by. Returns how
  /// long it must wait, 0 if it need not.
  Seconds spend(Seconds time, double share, Clock::time_point now);

 private:
  Clock::time_point at_;
  Seconds left_ = kMax;  // below 0: it took more than it had
};

}  // namespace weir::studio
