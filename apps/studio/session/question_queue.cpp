#include "apps/studio/session/question_queue.h"

#include <utility>

#include "framework/base/check.h"

namespace weir::studio {

bool QuestionQueue::add(std::uint64_t client, Question question) {
  std::deque<Question>& questions = waiting_[client];
  if (questions.size() >= kMaxOfAClient) return false;
  questions.push_back(std::move(question));
  return true;
}

QuestionQueue::Question QuestionQueue::next() {
  WEIR_CHECK(!waiting_.empty());
  auto turn = waiting_.upper_bound(last_);
  if (turn == waiting_.end()) turn = waiting_.begin();
  last_ = turn->first;
  Question question = std::move(turn->second.front());
  turn->second.pop_front();
  if (turn->second.empty()) waiting_.erase(turn);
  return question;
}

}  // namespace weir::studio
