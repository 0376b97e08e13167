#pragma once

#include <array>
#include <list>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "segment/evaluator.hpp"

namespace partuv {

/// Asks an evaluator what its caller will ask next, on threads that the context has to spare. The
/// evaluator remembers the answers; what is found does not depend on what was asked ahead.
class LookAhead {
 public:
  /// Tells questions apart.
  using Key = std::array<int32_t, 5>;

  struct Question {
    Key key;
    bool flatten;  ///< or only predict
    std::vector<int32_t> faces;
  };

  explicit LookAhead(Evaluator& evaluator) : evaluator_(evaluator) {}
  /// Waits for what is being worked out.
  ~LookAhead();
  LookAhead(const LookAhead&) = delete;
  LookAhead& operator=(const LookAhead&) = delete;

  /// True if threads are at work or could be.
  bool possible() const;
  bool begun(const Key& key) const;
  /// What may be asked soon, the most likely first, in place of what was expected before.
  void expect(std::vector<Question> questions);
  /// If a question is being worked out, work out others until it is known, or none is left.
  void bridge(const Key& key);

 private:
  struct Helper {
    std::thread thread;
    bool done = false;
  };

  void work(Helper& self);
  /// Work out the next question. lock: of mutex_, open meanwhile.
  void ask(std::unique_lock<std::mutex>& lock);

  Evaluator& evaluator_;
  mutable std::mutex mutex_;
  std::vector<Question> waiting_;  ///< the most likely last
  std::set<Key> begun_, running_;
  std::list<Helper> helpers_;
};

}  // namespace partuv
