#include "segment/shorten.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "planar.hpp"
#include "segment/cut_across.hpp"

namespace partuv {
namespace {

/// A chart and its size in the atlas.
struct Sized {
  SolvedChart chart;
  double weight;
  double side;  ///< of its least square
  double area;
};

Sized sized(SolvedChart chart, double weight) {
  const Flattening& flat = chart.flattening;
  const double area = signed_area(flat.piece.surface.faces, flat.uv);
  const double side = least_square_side(flat.uv);
  return {std::move(chart), weight, weight * side, weight * weight * area};
}

/// Area of the charts in the fullest tile. tiles: 0 is one for each part.
double area_of_fullest(const std::vector<Sized>& charts, int tiles) {
  std::map<int32_t, double> part;
  double total = 0.0, most = 0.0;
  for (const Sized& each : charts) {
    total += each.area;
    most = std::max(most, part[each.chart.part] += each.area);
  }
  return tiles > 0 ? total / tiles : most;
}

class Shortening {
 public:
  Shortening(std::vector<Sized> charts, int tiles)
      : charts_(std::move(charts)), area_(area_of_fullest(charts_, tiles)) {}

  /// No tile is filled to more than this: its square is no smaller than that of the longest chart.
  double efficiency_bound() const {
    const double side = charts_[longest()].side;
    return area_ / (side * side);
  }

  bool cut_longest(const FlattenOptions& bounds) {
    const size_t at = longest();
    auto sides = cut_across(charts_[at].chart.flattening, bounds);
    if (!sides) return false;
    Sized whole = std::move(charts_[at]);
    const auto as_chart = [&](Flattening& flat) {
      return sized({std::move(flat), whole.chart.part}, whole.weight);
    };
    charts_[at] = as_chart((*sides)[0]);
    charts_.insert(charts_.begin() + at + 1, as_chart((*sides)[1]));
    cuts_.emplace_back(at, std::move(whole));
    return true;
  }

  /// Take cuts back until so many are left.
  void keep(size_t cuts) {
    while (cuts_.size() > cuts) {
      auto& [at, whole] = cuts_.back();
      charts_[at] = std::move(whole);
      charts_.erase(charts_.begin() + at + 1);
      cuts_.pop_back();
    }
  }

  std::vector<SolvedChart> take() {
    std::vector<SolvedChart> taken;
    for (Sized& each : charts_) taken.push_back(std::move(each.chart));
    return taken;
  }

 private:
  std::vector<Sized> charts_;
  std::vector<std::pair<size_t, Sized>> cuts_;  // where, and what was there
  double area_;

  size_t longest() const {
    const auto shorter = [](const Sized& a, const Sized& b) { return a.side < b.side; };
    return std::max_element(charts_.begin(), charts_.end(), shorter) - charts_.begin();
  }
};

}  // namespace

void shorten_charts(const Options& options, const FlattenOptions& bounds,
                    const std::vector<double>& weight, const Context& context,
                    std::vector<SolvedChart>& charts) {
  constexpr double least_gain = 1.2;   // of the bound, for each chart more
  constexpr double attainable = 0.65;  // what charts fill where none dominates
  constexpr size_t few = 2, most = 3;  // cuts
  const double wanted = options.cut_below_efficiency;
  if (wanted <= 0.0 || options.texel_density > 0.0) return;
  FlattenOptions area_only = bounds;
  area_only.min_angular = 0.0;  // the bound is one of the mean, which a cut leaves as it is
  std::vector<Sized> whole;
  for (size_t c = 0; c < charts.size(); ++c)
    whole.push_back(sized(std::move(charts[c]), weight[c]));
  Shortening shortening(std::move(whole), options.tiles);
  const double before = shortening.efficiency_bound();
  double bound = before, best_worth = before;
  size_t kept = 0;
  for (size_t cuts = 1; cuts <= most && bound < wanted && !context.stopping(); ++cuts) {
    if (!shortening.cut_longest(area_only)) break;
    bound = shortening.efficiency_bound();
    if (cuts > few && bound < 2.0 * before) continue;
    const double worth =
        std::min(bound, attainable) / std::pow(least_gain, static_cast<double>(cuts));
    if (worth <= best_worth) continue;
    best_worth = worth;
    kept = cuts;
  }
  shortening.keep(kept);
  charts = shortening.take();
}

}  // namespace partuv
