#include "segment/grafter.hpp"

#include <algorithm>
#include <atomic>
#include <map>

#include "flatten/system.hpp"
#include "planar.hpp"
#include "rounded.hpp"
#include "segment/graft.hpp"
#include "segment/runs.hpp"
#include "segment/thin.hpp"

namespace partuv {
namespace {

/// Faces around a seam that move when a fragment is grafted on.
constexpr int rings = 5;

double perimeter_of(const Piece& piece) {
  double perimeter = 0.0;
  for (const std::vector<int32_t>& loop : piece.loops) {
    perimeter += loop_length(piece.surface, loop);
  }
  return perimeter;
}

}  // namespace

Grafter::Grafter(const Surface& surface, const SearchOptions& options, const Context& context,
                 std::vector<SolvedChart>& charts)
    : surface_(surface),
      options_(options),
      context_(context),
      charts_(charts),
      chart_of_(surface.faces.size(), -1),
      local_of_(surface.faces.size(), -1),
      cuts_(3 * surface.faces.size(), 0) {
  // The score of the atlas depends a little on how the charts lie. Where it lies far above its
  // bound, few charts less are not worth much of it; where it has none, angles are what counts.
  constexpr double margin = 0.001;
  const double most_loss = options.min_mean_angular > 0.0 ? hanging_angular_cost : 0.001;
  double sum = 0.0;
  for (const SolvedChart& chart : charts) {
    area_.push_back(surface_area(chart.flattening.piece.surface));
    sum += angular_sum(chart.flattening);
  }
  const double faces = surface.face_count();
  spare_angular_ = std::min(sum - faces * (options.min_mean_angular + margin), faces * most_loss);
  for (size_t c = 0; c < charts.size(); ++c) take_in(static_cast<int>(c));
  for (const SolvedChart& chart : charts) note_cuts(chart.flattening.piece);
}

int Grafter::graft(int fragment) {
  std::vector<Weld> welds = full_welds(fragment);
  std::erase_if(welds, [&](const Weld& weld) {
    return faces_of(weld.host).size() < faces_of(fragment).size();
  });
  return grow_first(welds, fragment, {});
}

void Grafter::hang(int fragment, double closeness) {
  constexpr size_t most_welds = 16;
  // A host that single precision has to enlarge has no room for another.
  constexpr double least_host_width = 1e-4;
  std::vector<Weld> welds = full_welds(fragment);
  const size_t full = welds.size();
  std::vector<Weld> runs, singles;
  for (size_t i = 0; i < full; ++i) {
    const std::vector<std::vector<int32_t>> parts = connected_runs(surface_, welds[i].sides);
    for (const std::vector<int32_t>& run : parts) {
      if (parts.size() > 1) runs.push_back(weld_along(welds[i].host, run));
      if (run.size() == 1) continue;
      for (const int side : run) singles.push_back(weld_along(welds[i].host, {side}));
    }
  }
  for (std::vector<Weld>* group : {&runs, &singles}) {
    sort_by_length(*group);
    welds.insert(welds.end(), group->begin(), group->end());
  }
  const double shortest = closeness * perimeter_of(charts_[fragment].flattening.piece);
  std::erase_if(welds, [&](const Weld& weld) { return rounded(weld.length) < rounded(shortest); });
  if (welds.size() > most_welds) welds.resize(most_welds);
  std::erase_if(welds, [&](const Weld& weld) {
    return mean_width(charts_[weld.host].flattening) < least_host_width ||
           (closeness > 0.0 && std::pair(rounded(area_[weld.host]), weld.host) <
                                   std::pair(rounded(area_[fragment]), fragment));
  });
  grow_first(welds, fragment, {std::min(0.0, -spare_angular_), true, closeness == 0.0});
}

Grafter::Weld Grafter::weld_along(int host, std::vector<int32_t> sides) const {
  double length = 0.0;
  for (const int h : sides) length += side_length(surface_, h);
  return {host, std::move(sides), length};
}

void Grafter::sort_by_length(std::vector<Weld>& welds) {
  std::stable_sort(welds.begin(), welds.end(), [](const Weld& a, const Weld& b) {
    return rounded(a.length) > rounded(b.length);
  });
}

std::vector<Grafter::Weld> Grafter::full_welds(int fragment) const {
  constexpr size_t most_hosts = 4;
  std::map<int32_t, std::vector<int32_t>> shared;
  for (const int f : faces_of(fragment)) {
    for (int k = 0; k < 3; ++k) {
      const int h = surface_.opposite[f][k];
      if (h >= 0 && chart_of_[h / 3] != fragment) shared[chart_of_[h / 3]].push_back(3 * f + k);
    }
  }
  std::vector<Weld> welds;
  for (auto& [host, sides] : shared) welds.push_back(weld_along(host, std::move(sides)));
  sort_by_length(welds);
  if (welds.size() > most_hosts) welds.resize(most_hosts);
  return welds;
}

const std::vector<int32_t>& Grafter::faces_of(int c) const {
  return charts_[c].flattening.piece.source_face;
}

void Grafter::take_in(int c) {
  const std::vector<int32_t>& faces = faces_of(c);
  for (size_t i = 0; i < faces.size(); ++i) {
    chart_of_[faces[i]] = c;
    local_of_[faces[i]] = static_cast<int32_t>(i);
  }
}

void Grafter::note_cuts(const Piece& piece) {
  for (size_t i = 0; i < piece.source_face.size(); ++i) {
    const int f = piece.source_face[i];
    for (int k = 0; k < 3; ++k) {
      const int across = surface_.opposite[f][k];
      if (across < 0 || piece.surface.opposite[i][k] >= 0) continue;
      cuts_[3 * f + k] = chart_of_[across / 3] == chart_of_[f];
    }
  }
}

Vec2 Grafter::corner(int f, int k) const {
  const Flattening& flat = charts_[chart_of_[f]].flattening;
  return flat.uv[flat.piece.surface.faces[local_of_[f]][k]];
}

std::vector<int32_t> Grafter::patch_around(int host, int fragment, Marks& marks) const {
  std::vector<int32_t> patch = faces_of(fragment);
  for (int f : patch) marks.seen[f] = 1;
  size_t ring_begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const size_t ring_end = patch.size();
    for (size_t i = ring_begin; i < ring_end; ++i) {
      for (int k = 0; k < 3; ++k) {
        const int h = surface_.opposite[patch[i]][k];
        if (h < 0 || marks.seen[h / 3] || chart_of_[h / 3] != host ||
            marks.cuts[3 * patch[i] + k]) {
          continue;
        }
        marks.seen[h / 3] = 1;
        patch.push_back(h / 3);
      }
    }
    ring_begin = ring_end;
  }
  for (int f : patch) marks.seen[f] = 0;
  std::sort(patch.begin(), patch.end());
  return patch;
}

std::vector<int32_t> Grafter::sides_off(const Weld& weld, int fragment) const {
  std::vector<int32_t> open;
  for (const int f : faces_of(fragment)) {
    for (int k = 0; k < 3; ++k) {
      const int h = surface_.opposite[f][k];
      if (h < 0 || chart_of_[h / 3] != weld.host) continue;
      if (std::find(weld.sides.begin(), weld.sides.end(), 3 * f + k) != weld.sides.end()) {
        continue;
      }
      open.push_back(3 * f + k);
      open.push_back(h);
    }
  }
  return open;
}

int Grafter::grow_first(const std::vector<Weld>& welds, int fragment, const Terms& terms) {
  const int count = static_cast<int>(welds.size());
  std::vector<Attempt> attempts(count);
  std::atomic<int> first = count;
  parallel_for(context_, count, [&](int i) {
    if (i > first) return;
    attempts[i] = attempt(welds[i], fragment, terms);
    for (int known = first; attempts[i].grown && i < known;) {
      first.compare_exchange_weak(known, i);
    }
  });
  // What threads tried beyond the first is not counted: the same for any number of them.
  for (int i = 0; i < std::min(first + 1, count); ++i) work_faces_ += attempts[i].work_faces;
  if (first == count) return -1;
  const Weld& weld = welds[first];
  Flattening& grown = *attempts[first].grown;
  spare_angular_ += gain(weld, fragment, grown);
  for (const int h : sides_off(weld, fragment)) {
    cuts_[h] = 1;
    for (const auto& marks : marks_) marks->cuts[h] = 1;
  }
  charts_[weld.host].flattening = std::move(grown);
  charts_[fragment].flattening = {};
  area_[weld.host] += area_[fragment];
  take_in(weld.host);
  return weld.host;
}

double Grafter::gain(const Weld& weld, int fragment, const Flattening& grown) const {
  return angular_sum(grown) -
         (angular_sum(charts_[weld.host].flattening) + angular_sum(charts_[fragment].flattening));
}

std::unique_ptr<Grafter::Marks> Grafter::borrow_marks() {
  std::lock_guard<std::mutex> lock(mutex_);
  if (marks_.empty()) {
    return std::make_unique<Marks>(Marks{cuts_, std::vector<char>(surface_.faces.size(), 0)});
  }
  std::unique_ptr<Marks> marks = std::move(marks_.back());
  marks_.pop_back();
  return marks;
}

void Grafter::return_marks(std::unique_ptr<Marks> marks) {
  std::lock_guard<std::mutex> lock(mutex_);
  marks_.push_back(std::move(marks));
}

Grafter::Attempt Grafter::attempt(const Weld& weld, int fragment, const Terms& terms) {
  std::unique_ptr<Marks> marks = borrow_marks();
  const std::vector<int32_t> open = sides_off(weld, fragment);
  for (const int h : open) marks->cuts[h] = 1;
  Attempt result = laid_on(weld.host, fragment, terms, *marks);
  // Charts that are as they were must not seem to lose.
  constexpr double rounding = 1e-9;
  const double least_gain = terms.least_gain - rounding;
  if (result.grown && gain(weld, fragment, *result.grown) < least_gain) result.grown.reset();
  for (const int h : open) marks->cuts[h] = 0;
  return_marks(std::move(marks));
  return result;
}

Grafter::Attempt Grafter::laid_on(int host, int fragment, const Terms& terms, Marks& marks) const {
  Attempt result;
  const Piece patch = extract_piece(surface_, patch_around(host, fragment, marks), {}, marks.cuts);
  result.work_faces += static_cast<double>(patch.source_face.size());
  const auto uv = lay_patch(patch, host, terms, marks.cuts);
  if (!uv) return result;
  result.work_faces += static_cast<double>(faces_of(host).size());
  std::vector<int32_t> whole;
  std::merge(faces_of(host).begin(), faces_of(host).end(), faces_of(fragment).begin(),
             faces_of(fragment).end(), std::back_inserter(whole));
  Piece piece = extract_piece(surface_, whole, {}, marks.cuts);
  std::vector<Vec2> grown(piece.surface.positions.size());
  for (size_t i = 0, j = 0; i < whole.size(); ++i) {
    const bool moved = j < patch.source_face.size() && patch.source_face[j] == whole[i];
    for (int k = 0; k < 3; ++k) {
      grown[piece.surface.faces[i][k]] =
          moved ? (*uv)[patch.surface.faces[j][k]] : corner(whole[i], k);
    }
    j += moved;
  }
  Flattening flat = judged(std::move(piece), std::move(grown), options_.flatten);
  if (flat.within && survives_rounding(flat, options_)) result.grown = std::move(flat);
  return result;
}

std::optional<std::vector<Vec2>> Grafter::lay_patch(const Piece& patch, int host,
                                                    const Terms& terms,
                                                    const CutSides& cuts) const {
  if (patch.component_count != 1 || patch.loops.empty() || patch.genus() != 0) {
    return std::nullopt;
  }
  const Surface& s = patch.surface;
  std::vector<Vec2> uv(s.positions.size(), Vec2::Zero());
  std::vector<char> placed(uv.size(), 0), fixed(uv.size(), 0);
  for (int i = 0; i < s.face_count(); ++i) {
    const int f = patch.source_face[i];
    if (chart_of_[f] != host) continue;
    for (int k = 0; k < 3; ++k) {
      uv[s.faces[i][k]] = corner(f, k);
      placed[s.faces[i][k]] = 1;
      const int across = surface_.opposite[f][k];
      // Beyond this side the host goes on and stays.
      if (s.opposite[i][k] < 0 && across >= 0 && chart_of_[across / 3] == host &&
          !cuts[3 * f + k]) {
        fixed[s.faces[i][k]] = fixed[s.faces[i][(k + 1) % 3]] = 1;
      }
    }
  }
  const std::vector<RestTriangle> rest = rest_shapes(s);
  MeshSystem<2> system(s.faces, s.vertex_count());
  const auto flips = [&] { return measure(patch, uv, options_.flatten.least_area).flipped > 0; };
  bool flipped = !unfold(patch, rest, placed, uv) || flips();
  if (flipped) {
    if (!conformal_extension(patch, rest, placed, context_, system, uv)) return std::nullopt;
    flipped = flips();
  }
  // The polish changes little about what lies where.
  if (!terms.spread_widely && !flipped && overlaps_widely(patch, uv)) return std::nullopt;
  PolishOptions polishing;
  polishing.area_weight = options_.flatten.area_weight;
  polishing.least_area = options_.flatten.least_area;
  polishing.fixed = fixed;
  if (!untangle(patch, rest, polishing, context_, system, uv)) return std::nullopt;
  polish(patch, rest, polishing, [] { return false; }, context_, system, uv);
  if (terms.spread && !boundary_is_simple(patch, uv)) {
    constexpr int spread_steps = 16;
    const auto never = [] { return false; };
    if (!spread_apart(patch, rest, polishing, spread_steps, never, context_, system, uv)) {
      return std::nullopt;
    }
  }
  return uv;
}

}  // namespace partuv
