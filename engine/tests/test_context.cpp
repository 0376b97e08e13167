// Sharing threads: what runs side by side, and that every thread comes back.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "check.hpp"
#include "partuv/context.hpp"

namespace partuv::test {
namespace {

/// Waits until it holds; false if it takes too long.
template <typename Condition>
bool eventually(Condition condition) {
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > limit) return false;
    std::this_thread::yield();
  }
  return true;
}

/// True if two bodies of a loop that is started now meet.
bool two_meet(const Context& context) {
  std::atomic<int> arrived{0};
  return parallel_all(context, 2, [&](int) {
    ++arrived;
    return eventually([&] { return arrived == 2; });
  });
}

void test_every_index_once() {
  for (const int threads : {1, 2, 5}) {
    const Context context(threads);
    std::vector<std::atomic<int>> times(100);
    parallel_for(context, 100, [&](int i) {
      ++times[i];
      parallel_for(context, 3, [](int) {});
    });
    CHECK(std::all_of(times.begin(), times.end(), [](const auto& t) { return t == 1; }));
    CHECK(eventually([&] { return context.free_threads() == threads; }));
    parallel_for(context, 0, [](int) { CHECK(false); });
  }
}

/// A thread that has nothing left to do helps a loop inside of what still runs, whichever of the
/// two it is.
void test_free_threads_help() {
  for (const int busy : {0, 1}) {
    const Context context(2);
    std::atomic<bool> both_began{false};
    std::atomic<int> began{0};
    bool met = false;
    parallel_for(context, 2, [&](int i) {
      if (++began == 2) both_began = true;
      eventually([&] { return both_began.load(); });
      if (i != busy) return;
      eventually([&] { return context.free_threads() == 2; });
      met = two_meet(context);
    });
    CHECK(met);
    CHECK(context.free_threads() == 2);
  }
}

/// A loop that began alone gets the thread that is given back while it runs.
void test_late_threads_join() {
  const Context context(2);
  CHECK(context.borrow_threads(1) == 1);
  std::atomic<int> arrived{0};
  bool met = false;
  parallel_for(context, 3, [&](int i) {
    if (i == 0) {
      context.return_threads(1);
      return;
    }
    ++arrived;
    if (eventually([&] { return arrived == 2; }) && i == 1) met = true;
  });
  CHECK(met);
  CHECK(context.free_threads() == 2);
}

void test_all() {
  for (const int threads : {1, 3}) {
    Context context(threads);
    CHECK(parallel_all(context, 50, [](int) { return true; }));
    CHECK(parallel_all(context, 0, [](int) { return false; }));
    std::atomic<int> begun{0};
    CHECK(!parallel_all(context, 1000, [&](int) {
      ++begun;
      return false;
    }));
    CHECK(begun <= threads);
    context.cancel();
    CHECK(!parallel_all(context, 50, [](int) { return true; }));
  }
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  test_every_index_once();
  test_free_threads_help();
  test_late_threads_join();
  test_all();
  return failures;
}
