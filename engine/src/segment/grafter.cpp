#include "segment/grafter.hpp"

#include <algorithm>
#include <map>

#include "flatten/system.hpp"
#include "planar.hpp"
#include "rounded.hpp"
#include "segment/runs.hpp"

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

double mean_width(const Flattening& flat) {
  double perimeter = 0.0;
  for (const std::vector<int32_t>& loop : flat.piece.loops) {
    for (const int h : loop) {
      const Triangle& t = flat.piece.surface.faces[h / 3];
      perimeter += (flat.uv[t[(h % 3 + 1) % 3]] - flat.uv[t[h % 3]]).norm();
    }
  }
  const double area = signed_area(flat.piece.surface.faces, flat.uv);
  return perimeter > 0.0 ? 2.0 * area / perimeter : 0.0;
}

Grafter::Grafter(const Surface& surface, const SearchOptions& options, const Context& context,
                 std::vector<SolvedChart>& charts)
    : surface_(surface),
      options_(options),
      context_(context),
      charts_(charts),
      chart_of_(surface.faces.size(), -1),
      local_of_(surface.faces.size(), -1),
      seen_(surface.faces.size(), 0),
      cuts_(3 * surface.faces.size(), 0) {
  // The score of the atlas depends a little on how the charts lie. Where it lies far above its
  // bound, few charts less are not worth much of it; where it has none, angles are what counts.
  constexpr double margin = 0.001;
  const double most_loss = options.min_mean_angular > 0.0 ? 0.003 : 0.001;
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
  for (const Weld& weld : full_welds(fragment)) {
    if (faces_of(weld.host).size() < faces_of(fragment).size()) continue;
    if (grow(weld, fragment, {})) return weld.host;
  }
  return -1;
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
  std::erase_if(welds, [&](const Weld& weld) { return weld.length < shortest; });
  if (welds.size() > most_welds) welds.resize(most_welds);
  for (const Weld& weld : welds) {
    if (mean_width(charts_[weld.host].flattening) < least_host_width) continue;
    if (std::pair(area_[weld.host], weld.host) < std::pair(area_[fragment], fragment)) continue;
    const Terms terms{std::min(0.0, -spare_angular_), true, closeness == 0.0};
    if (grow(weld, fragment, terms)) return;
  }
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

std::vector<int32_t> Grafter::patch_around(int host, int fragment) {
  std::vector<int32_t> patch = faces_of(fragment);
  for (int f : patch) seen_[f] = 1;
  size_t ring_begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    const size_t ring_end = patch.size();
    for (size_t i = ring_begin; i < ring_end; ++i) {
      for (int k = 0; k < 3; ++k) {
        const int h = surface_.opposite[patch[i]][k];
        if (h < 0 || seen_[h / 3] || chart_of_[h / 3] != host || cuts_[3 * patch[i] + k]) {
          continue;
        }
        seen_[h / 3] = 1;
        patch.push_back(h / 3);
      }
    }
    ring_begin = ring_end;
  }
  for (int f : patch) seen_[f] = 0;
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

bool Grafter::grow(const Weld& weld, int fragment, const Terms& terms) {
  const std::vector<int32_t> open = sides_off(weld, fragment);
  for (const int h : open) cuts_[h] = 1;
  Flattening &host = charts_[weld.host].flattening, &lone = charts_[fragment].flattening;
  std::optional<Flattening> grown = laid_on(weld.host, fragment, terms);
  const double before = angular_sum(host) + angular_sum(lone);
  if (!grown || angular_sum(*grown) - before < terms.least_gain) {
    for (const int h : open) cuts_[h] = 0;
    return false;
  }
  spare_angular_ += angular_sum(*grown) - before;
  host = std::move(*grown);
  lone = {};
  area_[weld.host] += area_[fragment];
  take_in(weld.host);
  return true;
}

std::optional<Flattening> Grafter::laid_on(int host, int fragment, const Terms& terms) {
  const Piece patch = extract_piece(surface_, patch_around(host, fragment), {}, cuts_);
  work_faces_ += static_cast<double>(patch.source_face.size());
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
          !cuts_[3 * f + k]) {
        fixed[s.faces[i][k]] = fixed[s.faces[i][(k + 1) % 3]] = 1;
      }
    }
  }
  const std::vector<RestTriangle> rest = rest_shapes(s);
  MeshSystem<2> system(s.faces, s.vertex_count());
  const bool laid = unfold(patch, rest, placed, uv);
  if (!laid || measure(patch, uv, options_.flatten.least_area).flipped > 0) {
    if (!conformal_extension(patch, rest, placed, context_, system, uv)) return std::nullopt;
  }
  PolishOptions polishing;
  polishing.area_weight = options_.flatten.area_weight;
  polishing.least_area = options_.flatten.least_area;
  polishing.fixed = fixed;
  if (!untangle(patch, rest, polishing, context_, system, uv)) return std::nullopt;
  polish(patch, rest, polishing, [] { return false; }, context_, system, uv);
  if (terms.spread && !boundary_is_simple(patch, uv)) {
    constexpr int spread_steps = 16;
    const auto never = [] { return false; };
    if ((!terms.spread_widely && overlaps_widely(patch, uv)) ||
        !spread_apart(patch, rest, polishing, spread_steps, never, context_, system, uv)) {
      return std::nullopt;
    }
  }

  work_faces_ += static_cast<double>(faces_of(host).size());
  std::vector<int32_t> whole;
  std::merge(faces_of(host).begin(), faces_of(host).end(), faces_of(fragment).begin(),
             faces_of(fragment).end(), std::back_inserter(whole));
  Piece piece = extract_piece(surface_, whole, {}, cuts_);
  std::vector<Vec2> grown(piece.surface.positions.size());
  for (size_t i = 0, j = 0; i < whole.size(); ++i) {
    const bool moved = j < patch.source_face.size() && patch.source_face[j] == whole[i];
    for (int k = 0; k < 3; ++k) {
      grown[piece.surface.faces[i][k]] = moved ? uv[s.faces[j][k]] : corner(whole[i], k);
    }
    j += moved;
  }
  Flattening flat = judged(std::move(piece), std::move(grown), options_.flatten);
  if (!flat.within) return std::nullopt;
  return flat;
}

}  // namespace partuv
