#include "partuv/solve.hpp"

#include <algorithm>
#include <atomic>

#include "segment/evaluator.hpp"

namespace partuv {
namespace {

/// Split a connected region in two by its normals.
std::vector<std::vector<int32_t>> split_region(const Surface& surface,
                                               const std::vector<int32_t>& faces,
                                               const Context& context) {
  const Piece piece = extract_piece(surface, faces, {});
  const Result<PartTree> tree = normals_tree(piece, context);
  if (!tree) return {faces};
  const PartTree& t = tree.value();
  std::vector<std::vector<int32_t>> halves;
  const int merge = t.root() - t.face_count;
  for (const int node : {t.left[merge], t.right[merge]}) {
    std::vector<int32_t> half;
    for (int i = t.begin[node]; i < t.end[node]; ++i) half.push_back(faces[t.order[i]]);
    std::sort(half.begin(), half.end());
    halves.push_back(std::move(half));
  }
  return halves;
}

/// Flatten one region, splitting it as often as it takes.
void solve_region(const Surface& surface, const std::vector<int32_t>& faces,
                  const SearchOptions& options, const Context& context,
                  std::vector<Flattening>& solved) {
  constexpr int most_splits = 24;
  struct Open {
    std::vector<int32_t> faces;
    int splits;
  };
  std::vector<Open> open{{faces, 0}};
  while (!open.empty() && !context.cancelled()) {
    const Open region = std::move(open.back());
    open.pop_back();
    const bool last_resort =
        region.faces.size() == 1 || region.splits >= most_splits || context.expired();
    if (!last_resort) {
      std::optional<OpenedPiece> opened =
          open_for_flattening(extract_piece(surface, region.faces, {}),
                              prediction_limit(options.flatten), options, context);
      if (opened) {
        Flattening flat = flatten(*opened, options.flatten, context);
        if (!flat.within && options.flatten.polish) {
          // The way of the search, which may end elsewhere.
          FlattenOptions quick = options.flatten;
          quick.quick = true;
          flat = flatten(std::move(*opened), quick, context);
        }
        if (flat.within) {
          solved.push_back(std::move(flat));
          continue;
        }
      }
    }
    if (last_resort || context.expired()) {
      for (Flattening& flat : project_to_planes(surface, region.faces, options.flatten)) {
        solved.push_back(std::move(flat));
      }
      continue;
    }
    for (auto& half : split_region(surface, region.faces, context)) {
      open.push_back({std::move(half), region.splits + 1});
    }
  }
}

}  // namespace

std::vector<SolvedChart> solve_charts(const Surface& surface, const ChartSet& regions,
                                      const SearchOptions& options, Context& context) {
  // Largest regions first, so that no thread is left with a large one at the end.
  std::vector<int32_t> order(regions.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int32_t>(i);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return regions[a].faces.size() > regions[b].faces.size();
  });
  std::vector<std::vector<Flattening>> solved(regions.size());
  std::atomic<int64_t> done{0};
  parallel_for(context, static_cast<int>(regions.size()), [&](int i) {
    const Chart& region = regions[order[i]];
    solve_region(surface, region.faces, options, context, solved[order[i]]);
    const int64_t faces = done += static_cast<int64_t>(region.faces.size());
    context.advance(static_cast<double>(faces) / surface.face_count());
  });
  std::vector<SolvedChart> charts;
  for (size_t i = 0; i < regions.size(); ++i) {
    for (Flattening& flat : solved[i]) charts.push_back({std::move(flat), regions[i].part});
  }
  return charts;
}

}  // namespace partuv
