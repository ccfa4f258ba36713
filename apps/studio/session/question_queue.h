// What clients ask of the simulation: they take turns, so that none of them keeps the others waiting.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>

#include "framework/run/simulation.h"

namespace weir::studio {

class QuestionQueue {
 public:
  /// Gets the simulation, or null if there is none.
  using Question = std::function<void(Simulation*)>;
  static constexpr std::size_t kMaxOfAClient = 32;

  /// False if that many questions of the client wait already.
  bool add(std::uint64_t client, Question question);
  /// Drops what a client has asked.
  void forget(std::uint64_t client) { waiting_.erase(client); }
  bool empty() const { return waiting_.empty(); }
  /// The oldest question of the client whose turn it is; there must be one.
  Question next();

 private:
  std::map<std::uint64_t, std::deque<Question>> waiting_;  // no empty ones
  std::uint64_t last_ = 0;                                 // whose turn it was
};

}  // namespace weir::studio
