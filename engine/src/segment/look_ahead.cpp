#include "segment/look_ahead.hpp"

#include <algorithm>

namespace partuv {

LookAhead::~LookAhead() {
  {
    std::lock_guard<std::mutex> lock(mutex_);
    waiting_.clear();
  }
  if (helpers_.empty()) return;
  const Context& context = evaluator_.context();
  // While this thread waits, what the others run may use it.
  context.return_threads(1);
  for (Helper& helper : helpers_) helper.thread.join();
  context.return_threads(-1);
}

bool LookAhead::possible() const {
  if (evaluator_.context().free_threads() > 1) return true;
  std::lock_guard<std::mutex> lock(mutex_);
  return std::any_of(helpers_.begin(), helpers_.end(), [](const Helper& h) { return !h.done; });
}

bool LookAhead::begun(const Key& key) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return begun_.count(key) > 0;
}

void LookAhead::expect(std::vector<Question> questions) {
  std::lock_guard<std::mutex> lock(mutex_);
  std::reverse(questions.begin(), questions.end());
  waiting_ = std::move(questions);
  std::erase_if(waiting_, [&](const Question& question) { return begun_.count(question.key) > 0; });
  helpers_.remove_if([](Helper& helper) {
    if (helper.done) helper.thread.join();
    return helper.done;
  });
  if (waiting_.empty()) return;
  for (int more = evaluator_.context().borrow_threads(static_cast<int>(waiting_.size())); more > 0;
       --more) {
    Helper& helper = helpers_.emplace_back();
    helper.thread = std::thread([this, &helper] { work(helper); });
  }
}

void LookAhead::bridge(const Key& key) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (running_.count(key) > 0 && !waiting_.empty()) ask(lock);
}

void LookAhead::work(Helper& self) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!waiting_.empty()) ask(lock);
  self.done = true;
  evaluator_.context().return_threads(1);
}

void LookAhead::ask(std::unique_lock<std::mutex>& lock) {
  const Question question = std::move(waiting_.back());
  waiting_.pop_back();
  begun_.insert(question.key);
  running_.insert(question.key);
  lock.unlock();
  if (question.flatten) {
    evaluator_.chart(question.faces);
  } else {
    evaluator_.predicted(question.faces);
  }
  lock.lock();
  running_.erase(question.key);
}

}  // namespace partuv
