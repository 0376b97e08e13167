#include "segment/graft.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "flatten/system.hpp"

namespace partuv {
namespace {

/// Faces around a seam that move when a fragment is grafted on.
constexpr int rings = 5;

class Grafter {
 public:
  Grafter(const Surface& surface, const SearchOptions& options, const Context& context,
          std::vector<SolvedChart>& charts)
      : surface_(surface),
        options_(options),
        context_(context),
        charts_(charts),
        chart_of_(surface.faces.size(), -1),
        local_of_(surface.faces.size(), -1),
        seen_(surface.faces.size(), 0),
        cuts_(3 * surface.faces.size(), 0) {
    for (size_t c = 0; c < charts.size(); ++c) take_in(static_cast<int>(c));
    for (const SolvedChart& chart : charts) note_cuts(chart.flattening.piece);
  }

  /// Number of the neighbour that took the chart in, -1 if none did.
  int graft(int fragment) {
    constexpr size_t most_hosts = 4;
    std::map<int32_t, double> shared;
    for (const int f : faces_of(fragment)) {
      for (int k = 0; k < 3; ++k) {
        const int h = surface_.opposite[f][k];
        if (h < 0 || chart_of_[h / 3] == fragment) continue;
        const Triangle& t = surface_.faces[f];
        shared[chart_of_[h / 3]] +=
            (surface_.positions[t[(k + 1) % 3]] - surface_.positions[t[k]]).norm();
      }
    }
    std::vector<std::pair<int32_t, double>> hosts(shared.begin(), shared.end());
    std::stable_sort(hosts.begin(), hosts.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    if (hosts.size() > most_hosts) hosts.resize(most_hosts);
    for (const auto& [host, unused] : hosts) {
      if (faces_of(host).size() < faces_of(fragment).size()) continue;
      if (std::optional<Flattening> grown = grow(host, fragment)) {
        charts_[host].flattening = std::move(*grown);
        charts_[fragment].flattening = {};
        take_in(host);
        return host;
      }
    }
    return -1;
  }

 private:
  const std::vector<int32_t>& faces_of(int c) const {
    return charts_[c].flattening.piece.source_face;
  }

  void take_in(int c) {
    const std::vector<int32_t>& faces = faces_of(c);
    for (size_t i = 0; i < faces.size(); ++i) {
      chart_of_[faces[i]] = c;
      local_of_[faces[i]] = static_cast<int32_t>(i);
    }
  }

  /// Sides that are open inside a chart.
  void note_cuts(const Piece& piece) {
    for (size_t i = 0; i < piece.source_face.size(); ++i) {
      const int f = piece.source_face[i];
      for (int k = 0; k < 3; ++k) {
        const int across = surface_.opposite[f][k];
        if (across < 0 || piece.surface.opposite[i][k] >= 0) continue;
        cuts_[3 * f + k] = chart_of_[across / 3] == chart_of_[f];
      }
    }
  }

  Vec2 corner(int f, int k) const {
    const Flattening& flat = charts_[chart_of_[f]].flattening;
    return flat.uv[flat.piece.surface.faces[local_of_[f]][k]];
  }

  /// The fragment and the faces of the host within a few rings of it.
  std::vector<int32_t> patch_around(int host, int fragment) {
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

  /// The host with the fragment laid on, if that stays within the bounds.
  std::optional<Flattening> grow(int host, int fragment) {
    const Piece patch = extract_piece(surface_, patch_around(host, fragment), {}, cuts_);
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

  const Surface& surface_;
  const SearchOptions& options_;
  const Context& context_;
  std::vector<SolvedChart>& charts_;
  std::vector<int32_t> chart_of_, local_of_;
  std::vector<char> seen_;
  CutSides cuts_;
};

}  // namespace

void graft_fragments(const Surface& surface, const SearchOptions& options, const Context& context,
                     std::vector<SolvedChart>& charts, std::vector<ChartState>& states) {
  constexpr size_t most_faces = 4000;
  std::vector<int32_t> order;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (states[c] == ChartState::fragment &&
        charts[c].flattening.piece.source_face.size() <= most_faces) {
      order.push_back(static_cast<int32_t>(c));
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return charts[a].flattening.piece.source_face.size() <
           charts[b].flattening.piece.source_face.size();
  });
  Grafter grafter(surface, options, context, charts);
  std::vector<char> gone(charts.size(), 0);
  for (const int c : order) {
    if (context.stopping()) break;
    const int host = grafter.graft(c);
    if (host < 0) continue;
    gone[c] = 1;
    states[host] = std::max(states[host], ChartState::changed);
  }
  size_t kept = 0;
  for (size_t c = 0; c < charts.size(); ++c) {
    if (gone[c]) continue;
    if (kept != c) charts[kept] = std::move(charts[c]);
    states[kept++] = states[c];
  }
  charts.resize(kept);
  states.resize(kept);
}

}  // namespace partuv
