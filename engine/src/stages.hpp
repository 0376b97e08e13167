#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "partuv/context.hpp"
#include "partuv/unwrap.hpp"

namespace partuv {

/// A part of the progress.
struct Span {
  double from = 0.0, to = 1.0;
  double at(double share) const { return from + share * (to - from); }
};

/// Enters the stages of an unwrap and notes how long each took, all its turns together.
class Stages {
 public:
  /// span: of the progress that the unwrap takes.
  Stages(Context& context, Atlas& atlas, const Span& span)
      : context_(context), atlas_(atlas), span_(span) {}
  ~Stages() { finish(); }
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  /// from, to: of the unwrap's own progress.
  void enter(const std::string& name, double from, double to) {
    finish();
    name_ = name;
    start_ = Context::Clock::now();
    context_.enter(name, span_.at(from), span_.at(to));
  }

  void finish() {
    if (name_.empty()) return;
    const std::chrono::duration<double> taken = Context::Clock::now() - start_;
    auto& seconds = atlas_.stage_seconds;
    const auto entry = std::find_if(seconds.begin(), seconds.end(),
                                    [&](const auto& stage) { return stage.first == name_; });
    if (entry != seconds.end()) {
      entry->second += taken.count();
    } else {
      seconds.emplace_back(name_, taken.count());
    }
    name_.clear();
  }

 private:
  Context& context_;
  Atlas& atlas_;
  Span span_;
  std::string name_;
  Context::Clock::time_point start_;
};

}  // namespace partuv
