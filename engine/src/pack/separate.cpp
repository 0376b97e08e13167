#include "pack/separate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "pack/mask.hpp"
#include "pack/random.hpp"
#include "pack/sums.hpp"

namespace partuv::packing {

namespace {

struct Spot {
  int turn = 0;
  int x = 0;
  int y = 0;
};

class Separator {
 public:
  Separator(const std::vector<Shape>& shapes, const Bin& bin, const Layout& start,
            const SeparationPlan& plan)
      : shapes_(shapes),
        bin_(bin),
        plan_(plan),
        scale_(start.scale),
        cell_((bin.side + bin.gutter) / plan.cells),
        count_(static_cast<int>(shapes.size())),
        sums_(size_t(plan.cells) * (plan.cells + 1) + lane_count),
        row_move_(plan.cells, 0),
        kept_(shapes.size()),
        masks_(shapes.size() * (plan.rotations + 1)),
        own_turn_(shapes.size()),
        spots_(shapes.size()),
        weight_(shapes.size() * shapes.size(), base_weight),
        scratch_(plan.cells + lane_count),
        random_(plan.seed) {
    for (int i = 0; i < count_; ++i) {
      own_turn_[i] = start.poses[i].rotation_rad;
      settle_spot(i, 0, start.poses[i].centre);
    }
  }

  Layout run(const Context& context) {
    Layout layout;
    layout.poses.resize(count_);
    int64_t fewest = std::numeric_limits<int64_t>::max();
    while (work_ < plan_.work) {
      if (!possible_) return layout;
      const std::vector<std::pair<int, int64_t>> bad = overlapping(fewest);
      if (bad.empty()) {
        for (int i = 0; i < count_; ++i) {
          const Mask& at = mask(i, spots_[i].turn);
          const Vec2 corner(spots_[i].x, spots_[i].y);
          layout.poses[i] = {at.rotation_rad,
                             ((corner + at.centre) * cell_).array() - 0.5 * bin_.gutter};
        }
        layout.scale = scale_;
        return layout;
      }
      for (const auto& [chart, overlap] : bad) {
        if (context.stopping()) return layout;
        if (shared_cells(chart) > 0) move(chart);
      }
    }
    return layout;
  }

  int64_t work() const { return work_; }

 private:
  static constexpr int32_t base_weight = 16;
  static constexpr int32_t most_weight = 16 * 1024;
  static constexpr int rows_at_once = 3;  // between looks at whether there is hope

  const std::vector<Shape>& shapes_;
  const Bin& bin_;
  const SeparationPlan& plan_;
  double scale_;
  double cell_;  // texels
  int count_;
  std::vector<uint32_t> sums_;     // cells x (cells + 1), and some that are read in vain
  std::vector<int64_t> row_move_;  // the move a row of sums was built for
  int64_t move_ = 0;
  std::vector<int> others_;
  std::vector<const Mask*> kept_;
  std::vector<std::optional<Mask>> masks_;  // turn 0 is the one the chart came with
  std::vector<double> own_turn_;
  std::vector<Spot> spots_;
  std::vector<int32_t> weight_;   // count x count, symmetric
  std::vector<uint32_t> window_;  // the same for some columns and rows, column after column
  std::vector<uint32_t> scratch_;
  std::vector<Strip> strips_;
  Random random_;
  int64_t work_ = 0;
  bool possible_ = true;

  const Mask& mask(int chart, int turn) {
    std::optional<Mask>& kept = masks_[size_t(chart) * (plan_.rotations + 1) + turn];
    if (!kept) {
      double angle = own_turn_[chart];
      if (turn > 0) {
        angle = turn_rad(shapes_[chart], turn - 1, plan_.rotations, bin_.side / scale_);
        if (plan_.askew) {
          angle += uniform(plan_.seed, uint64_t(chart)) * 2.0 * std::numbers::pi / plan_.rotations;
        }
      }
      kept =
          make_mask(shapes_[chart], angle, scale_ / cell_, 0.5 * bin_.gutter / cell_, plan_.cover);
      work_ += 100 * int64_t(shapes_[chart].loops.points.size() + kept->height);
    }
    return *kept;
  }

  bool fits(const Mask& mask) const {
    return mask.width <= plan_.cells && mask.height <= plan_.cells;
  }

  void settle_spot(int chart, int turn, const Vec2& centre) {
    const Mask* at = &mask(chart, turn);
    for (int other = 1; !fits(*at) && other <= plan_.rotations; ++other) {
      turn = other;
      at = &mask(chart, turn);
    }
    if (!fits(*at)) {
      possible_ = false;
      return;
    }
    const Vec2 corner = (centre.array() + 0.5 * bin_.gutter) / cell_ - at->centre.array();
    spots_[chart] = {turn, std::clamp(int(std::lround(corner.x())), 0, plan_.cells - at->width),
                     std::clamp(int(std::lround(corner.y())), 0, plan_.cells - at->height)};
  }

  /// Number of cells two charts share where they lie now.
  int64_t shared(int one, int two) {
    const Mask& a = mask(one, spots_[one].turn);
    const Mask& b = mask(two, spots_[two].turn);
    const int dx = spots_[two].x - spots_[one].x;
    const int dy = spots_[two].y - spots_[one].y;
    if (dx >= a.width || -dx >= b.width) return 0;
    int64_t cells = 0;
    const int from = std::max(0, dy);
    const int to = std::min(a.height, dy + b.height);
    for (int row = from; row < to; ++row) {
      int32_t i = a.row_start[row];
      int32_t j = b.row_start[row - dy];
      while (i < a.row_start[row + 1] && j < b.row_start[row - dy + 1]) {
        const int begin = std::max(a.runs[i].begin, b.runs[j].begin + dx);
        const int end = std::min(a.runs[i].end, b.runs[j].end + dx);
        if (begin < end) cells += end - begin;
        if (a.runs[i].end < b.runs[j].end + dx) {
          ++i;
        } else {
          ++j;
        }
      }
    }
    return cells;
  }

  int64_t shared_cells(int chart) {
    int64_t cells = 0;
    for (int other = 0; other < count_; ++other) {
      if (other != chart) cells += shared(chart, other);
    }
    return cells;
  }

  /// Charts that overlap others, in random order; raises the weight of every overlapping pair.
  std::vector<std::pair<int, int64_t>> overlapping(int64_t& fewest) {
    std::vector<int64_t> cells(count_, 0);
    struct Pair {
      int one, two;
      int64_t cells;
    };
    std::vector<Pair> pairs;
    int64_t total = 0;
    int64_t most = 1;
    for (int one = 0; one < count_; ++one) {
      for (int two = one + 1; two < count_; ++two) {
        const int64_t both = shared(one, two);
        work_ += 16;
        if (both == 0) continue;
        pairs.push_back({one, two, both});
        cells[one] += both;
        cells[two] += both;
        total += both;
        most = std::max(most, both);
      }
    }
    fewest = std::min(fewest, total);
    for (const Pair& pair : pairs) {
      int32_t& up = weight_[size_t(pair.one) * count_ + pair.two];
      const double factor = 1.2 + 0.8 * double(pair.cells) / double(most);
      up = std::min(most_weight, int32_t(std::ceil(factor * up)));
      weight_[size_t(pair.two) * count_ + pair.one] = up;
    }
    std::vector<std::pair<int, int64_t>> bad;
    for (int i = 0; i < count_; ++i) {
      if (cells[i] > 0) bad.emplace_back(i, cells[i]);
    }
    for (size_t i = bad.size(); i > 1; --i) std::swap(bad[i - 1], bad[random_.below(int(i))]);
    return bad;
  }

  /// The summed weights of the charts on a row of cells, built when first asked for in a move.
  const uint32_t* row_sums(int chart, int y) {
    uint32_t* line = &sums_[size_t(y) * (plan_.cells + 1)];
    if (row_move_[y] == move_) return line;
    row_move_[y] = move_;
    std::fill(line, line + plan_.cells + 1, 0);
    for (int other : others_) {
      const Mask& at = *kept_[other];
      const int row = y - spots_[other].y;
      if (row < 0 || row >= at.height) continue;
      const uint32_t weight = weight_[size_t(chart) * count_ + other];
      const int x = spots_[other].x;
      for (int i = at.row_start[row]; i < at.row_start[row + 1]; ++i) {
        line[x + at.runs[i].begin] += weight;
        line[x + at.runs[i].end] -= weight;
      }
    }
    sum_twice(line, plan_.cells + 1);
    work_ += plan_.cells * 2;
    return line;
  }

  struct Candidate {
    int32_t value = std::numeric_limits<int32_t>::max();
    Spot spot;
  };

  void move(int chart) {
    ++move_;
    others_.clear();
    for (int other = 0; other < count_; ++other) {
      kept_[other] = &mask(other, spots_[other].turn);
      if (other != chart) others_.push_back(other);
    }
    std::array<Candidate, 3> best;
    scan(chart, spots_[chart].turn, best);
    for (int trial = 0; trial < plan_.trials; ++trial) {
      scan(chart, random_.below(plan_.rotations + 1), best);
    }
    Candidate chosen;
    chosen.spot = spots_[chart];
    refine(chart, spots_[chart], 0, chosen);
    for (const Candidate& candidate : best) {
      if (candidate.value < std::numeric_limits<int32_t>::max()) {
        refine(chart, candidate.spot, stride(mask(chart, candidate.spot.turn)), chosen);
      }
    }
    spots_[chart] = chosen.spot;
  }

  /// Rows of a mask are sampled this far apart, and so are lines of positions.
  static int stride(const Mask& mask) { return std::clamp(mask.height / 12, 1, 8); }

  /// The cell of least weighted overlap for one turn, about: on sampled rows, which are added in an
  /// order spread over the mask so that most lines of positions can be given up early.
  void scan(int chart, int turn, std::array<Candidate, 3>& best) {
    const Mask& at = mask(chart, turn);
    if (!fits(at)) return;
    const int step = stride(at);
    const int columns = plan_.cells - at.width + 1;
    const int lines = (plan_.cells - at.height) / step + 1;
    Candidate found;
    const int first = random_.below(lines);
    for (int k = 0; k < lines && found.value > 0; ++k) {
      const int y = (first + k) % lines * step;
      const int32_t bound = std::min(found.value, best.back().value);
      const int rows = (at.height - 1) / step + 1;
      // A stride near the golden section visits all rows and spreads any first few.
      const int hop = golden_hop(rows);
      bool hopeless = false;
      int64_t lowest = 0;
      for (int r = 0, row = 0; r < rows && !hopeless;) {
        strips_.clear();
        const bool anew = r == 0;
        const int some = std::min(rows, r + rows_at_once);
        for (; r < some; ++r, row = (row + hop) % rows) {
          add_row(at, row * step, row_sums(chart, y + row * step));
        }
        lowest = add_up(0, columns, anew);
        hopeless = lowest * step >= bound;
      }
      if (hopeless) continue;
      const auto first_lowest = std::find(scratch_.begin(), scratch_.end(), lowest);
      found.value = static_cast<int32_t>(lowest * step);
      found.spot = {turn, static_cast<int>(first_lowest - scratch_.begin()), y};
    }
    for (Candidate& candidate : best) {
      if (found.value < candidate.value) std::swap(found, candidate);
    }
  }

  /// Note the runs of a mask's row for `add_up`.
  void add_row(const Mask& mask, int row, const uint32_t* sums) {
    for (int32_t i = mask.row_start[row]; i < mask.row_start[row + 1]; ++i) {
      strips_.push_back({sums + mask.runs[i].begin, sums + mask.runs[i].end});
    }
  }

  /// Add the noted runs up, for so many columns, with all sums `ahead` of where they were noted.
  /// Returns the least of the columns.
  int64_t add_up(int ahead, int columns, bool anew) {
    work_ += int64_t(columns) * int64_t(strips_.size());
    return add_strips(scratch_.data(), strips_.data(), int(strips_.size()), ahead, columns, anew);
  }

  static int golden_hop(int rows) {
    int hop = std::max(1, static_cast<int>(0.618 * rows));
    while (std::gcd(hop, rows) != 1) ++hop;
    return hop;
  }

  /// The exact least overlap within `reach` cells of a spot; the lowest place, if there are
  /// several.
  void refine(int chart, const Spot& spot, int reach, Candidate& chosen) {
    const Mask& at = mask(chart, spot.turn);
    const int left = std::max(0, spot.x - reach);
    const int right = std::min(plan_.cells - at.width, spot.x + reach);
    const int bottom = std::max(0, spot.y - reach);
    const int top = std::min(plan_.cells - at.height, spot.y + reach);
    const int lines = top - bottom + 1;
    const int height = top - bottom + at.height;
    const int stride = (height + lane_count - 1) / lane_count * lane_count;
    sum_window(chart, left, bottom, right - left + at.width, height, stride);
    strips_.clear();
    for (int row = 0; row < at.height; ++row) {
      for (int32_t i = at.row_start[row]; i < at.row_start[row + 1]; ++i) {
        strips_.push_back(
            {&window_[at.runs[i].begin * stride + row], &window_[at.runs[i].end * stride + row]});
      }
    }
    Candidate found;
    for (int x = left; x <= right; ++x) {
      const int64_t lowest = add_up((x - left) * stride, lines, true);
      if (lowest > found.value) continue;
      const auto first_lowest = std::find(scratch_.begin(), scratch_.end(), lowest);
      const int y = bottom + static_cast<int>(first_lowest - scratch_.begin());
      if (lowest == found.value && y >= found.spot.y) continue;
      found.value = static_cast<int32_t>(lowest);
      found.spot = {spot.turn, x, y};
    }
    if (found.value < chosen.value) chosen = found;
  }

  /// Like `row_sums`, for some rows and columns only, column after column: `stride` takes from one
  /// to the next.
  void sum_window(int chart, int left, int bottom, int width, int height, int stride) {
    window_.assign(size_t(width + 1) * stride + lane_count, 0);
    for (int other : others_) {
      const Mask& at = *kept_[other];
      const int x = spots_[other].x - left;
      const int y = spots_[other].y - bottom;
      if (x >= width || x + at.width <= 0) continue;
      const uint32_t weight = weight_[size_t(chart) * count_ + other];
      for (int row = std::max(0, -y); row < std::min(at.height, height - y); ++row) {
        for (int i = at.row_start[row]; i < at.row_start[row + 1]; ++i) {
          const int begin = std::clamp(x + at.runs[i].begin, 0, width);
          const int end = std::clamp(x + at.runs[i].end, 0, width);
          window_[begin * stride + y + row] += weight;
          window_[end * stride + y + row] -= weight;
        }
      }
    }
    sum_rows_twice(window_.data(), width + 1, stride);
    work_ += int64_t(2) * height * width;
  }
};

}  // namespace

Separation separate(const std::vector<Shape>& shapes, const Bin& bin, const Layout& start,
                    const SeparationPlan& plan, const Context& context) {
  Separator separator(shapes, bin, start, plan);
  Layout layout = separator.run(context);
  return {std::move(layout), separator.work()};
}

}  // namespace partuv::packing
