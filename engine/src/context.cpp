#include "partuv/context.hpp"

#include <algorithm>
#include <cmath>
#include <thread>
#include <vector>

namespace partuv {

Context::Context(int threads, double deadline_s)
    : threads_(std::max(1, threads)), spare_(threads_ - 1), bounded_(std::isfinite(deadline_s)) {
  if (bounded_) {
    deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(std::max(0.0, deadline_s)));
  }
}

bool Context::expired() const { return bounded_ && Clock::now() >= deadline_; }

Context::Progress Context::progress() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return progress_;
}

void Context::enter(const std::string& stage, double from, double to) {
  std::lock_guard<std::mutex> lock(mutex_);
  stage_from_ = from;
  stage_to_ = to;
  progress_.stage = stage;
  progress_.fraction = std::max(progress_.fraction, from);
}

void Context::advance(double fraction_of_stage) {
  std::lock_guard<std::mutex> lock(mutex_);
  const double share = std::clamp(fraction_of_stage, 0.0, 1.0);
  progress_.fraction =
      std::max(progress_.fraction, stage_from_ + share * (stage_to_ - stage_from_));
}

int Context::borrow_threads(int wanted) const {
  int spare = spare_.load();
  while (spare > 0 && wanted > 0) {
    const int taken = std::min(spare, wanted);
    if (spare_.compare_exchange_weak(spare, spare - taken)) return taken;
  }
  return 0;
}

void parallel_for(const Context& context, int count, const std::function<void(int)>& body) {
  std::atomic<int> next{0};
  const auto take = [&] { return context.cancelled() ? count : next++; };
  std::vector<std::thread> threads;
  for (int i = take(); i < count; i = take()) {
    // Threads that others have given back in the meantime join in.
    for (int helpers = context.borrow_threads(count - 1 - i); helpers > 0; --helpers) {
      threads.emplace_back([&] {
        for (int k = take(); k < count; k = take()) body(k);
        context.return_threads(1);
      });
    }
    body(i);
  }
  if (threads.empty()) return;
  // While this thread waits, what the others run may use it.
  context.return_threads(1);
  for (std::thread& thread : threads) thread.join();
  context.return_threads(-1);
}

bool parallel_all(const Context& context, int count, const std::function<bool(int)>& holds) {
  std::atomic<bool> all{true};
  parallel_for(context, count, [&](int i) {
    if (all && !holds(i)) all = false;
  });
  return all && !context.cancelled();
}

}  // namespace partuv
