#include "segment/graft.hpp"

#include <algorithm>
#include <cmath>

#include "rounded.hpp"
#include "segment/grafter.hpp"
#include "segment/thin.hpp"

namespace partuv {

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

namespace {

// Of a texture of 1024 on a surface of unit area, if charts fill no less than 0.4 of the square.
const double texel = 1.0 / (1024.0 * std::sqrt(0.4));
const double sliver_width = 2.0 * texel, small_width = 128.0 * texel;

/// Charts from `first` on that are narrower than `widest`.
void hang_charts(const Surface& surface, const SearchOptions& options, const Context& context,
                 double widest, size_t first, std::vector<SolvedChart>& charts) {
  constexpr size_t most_sliver_faces = 4000, most_small_faces = 2000;
  // Charts that hardly touch would hang together by a thread; slivers are worse.
  constexpr double least_closeness = 0.05;
  // Near-linear in the size of the mesh.
  const double most_work_faces = 500e3 + 10.0 * surface.face_count();
  struct Small {
    float area;
    int32_t chart;
    bool sliver;
  };
  std::vector<Small> small;
  for (size_t c = first; c < charts.size(); ++c) {
    const Flattening& flat = charts[c].flattening;
    const double width = mean_width(flat);
    const bool sliver = width < sliver_width;
    if (width < widest &&
        flat.piece.source_face.size() <= (sliver ? most_sliver_faces : most_small_faces)) {
      small.push_back({rounded(surface_area(flat.piece.surface)), static_cast<int32_t>(c), sliver});
    }
  }
  if (small.empty() || charts.size() == 1) return;
  std::sort(small.begin(), small.end(), [](const Small& a, const Small& b) {
    return a.area != b.area ? a.area < b.area : a.chart < b.chart;
  });
  Grafter grafter(surface, options, context, charts);
  for (const Small& each : small) {
    if (context.stopping() || grafter.work_faces() > most_work_faces) break;
    grafter.hang(each.chart, each.sliver ? 0.0 : least_closeness);
  }
  for (const Small& each : small) {
    if (!each.sliver || charts[each.chart].flattening.uv.empty()) continue;
    if (context.stopping() || grafter.work_faces() > most_work_faces) break;
    grafter.widen(each.chart, sliver_width);
  }
  // What was taken in is empty.
  std::erase_if(
      charts, [](const SolvedChart& chart) { return chart.flattening.piece.source_face.empty(); });
}

}  // namespace

void hang_small_charts(const Surface& surface, const SearchOptions& options, const Context& context,
                       std::vector<SolvedChart>& charts) {
  hang_charts(surface, options, context, small_width, 0, charts);
}

void hang_slivers(const Surface& surface, const SearchOptions& options, const Context& context,
                  size_t first, std::vector<SolvedChart>& charts) {
  hang_charts(surface, options, context, sliver_width, first, charts);
}

}  // namespace partuv
