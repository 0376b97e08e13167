#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <mutex>
#include <string>

namespace partuv {

/// What a long call needs from its caller: cancel flag, deadline, threads, and a place for
/// progress.
///
/// `cancel` and the readers may be called from any thread. A cancelled call returns
/// `Error::cancelled`; an expired deadline makes a call finish with what it has.
class Context {
 public:
  using Clock = std::chrono::steady_clock;

  /// threads: how many the call may use, itself included. deadline_s: seconds from now.
  explicit Context(int threads = 1, double deadline_s = std::numeric_limits<double>::infinity());

  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  /// True once the deadline has passed: skip what only improves the result.
  bool expired() const;
  /// True when there is no point in going on: cancelled, or out of time.
  bool stopping() const { return cancelled() || expired(); }
  int threads() const { return threads_; }

  /// How many threads a call from here could use now, itself included; may change at any time.
  int free_threads() const { return 1 + std::max(0, spare_.load(std::memory_order_relaxed)); }
  /// Take up to `wanted` of the threads that no one uses; returns how many. Give them back after.
  /// A thread that waits may give back its own, and take it again: for a moment there may be one
  /// more at work.
  int borrow_threads(int wanted) const;
  void return_threads(int count) const { spare_ += count; }

  /// Progress in [0, 1], never falling, with the stage it belongs to.
  struct Progress {
    double fraction = 0.0;
    std::string stage;
  };
  Progress progress() const;

  /// Enter a stage that covers [from, to] of the whole.
  void enter(const std::string& stage, double from, double to);
  /// Set the fraction done of the current stage, in [0, 1].
  void advance(double fraction_of_stage);

 private:
  int threads_;
  mutable std::atomic<int> spare_;
  bool bounded_;
  Clock::time_point deadline_;
  std::atomic<bool> cancelled_{false};
  mutable std::mutex mutex_;
  Progress progress_;
  double stage_from_ = 0.0;
  double stage_to_ = 0.0;
};

/// Run body(i) for i in [0, count) on this thread and on those that the context has to spare, in
/// ascending order of start. Results must be written per index, so that they do not depend on the
/// number of threads. May be called from inside a body. Stops handing out indices once the context
/// is cancelled.
void parallel_for(const Context& context, int count, const std::function<void(int)>& body);

/// Like `parallel_for`: true if holds(i) is true for all i. Once one is not, no other is begun.
bool parallel_all(const Context& context, int count, const std::function<bool(int)>& holds);

}  // namespace partuv
