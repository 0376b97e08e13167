#include "partuv/repack.hpp"

#include <algorithm>
#include <cmath>

#include "pack/layout.hpp"

namespace partuv {

namespace {

Result<bool> check(const FlatMesh& mesh, size_t charts) {
  for (const Vec2& p : mesh.uv) {
    if (!p.allFinite()) return Failure{Error::non_finite_position, "uv"};
  }
  const int32_t points = static_cast<int32_t>(mesh.uv.size());
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    for (int32_t corner : mesh.faces[f]) {
      if (corner < 0 || corner >= points) {
        return Failure{Error::index_out_of_range, "face " + std::to_string(f)};
      }
    }
    if (mesh.chart[f] < 0) return Failure{Error::index_out_of_range, "chart"};
  }
  if (!mesh.part.empty() && mesh.part.size() != charts) {
    return Failure{Error::index_out_of_range, "part"};
  }
  if (!mesh.weight.empty() && mesh.weight.size() != charts) {
    return Failure{Error::index_out_of_range, "weight"};
  }
  return true;
}

/// Every chart with points of its own.
std::vector<PackChart> separate(const FlatMesh& mesh, size_t count) {
  std::vector<PackChart> charts(count);
  std::vector<std::vector<int32_t>> faces(count);
  for (size_t f = 0; f < mesh.faces.size(); ++f) faces[mesh.chart[f]].push_back(int32_t(f));
  std::vector<int32_t> local(mesh.uv.size(), -1);
  for (size_t c = 0; c < count; ++c) {
    PackChart& chart = charts[c];
    for (int32_t f : faces[c]) {
      Triangle triangle = mesh.faces[f];
      for (int32_t& corner : triangle) {
        if (local[corner] < 0) {
          local[corner] = static_cast<int32_t>(chart.uv.size());
          chart.uv.push_back(mesh.uv[corner]);
        }
        corner = local[corner];
      }
      chart.triangles.push_back(triangle);
    }
    for (int32_t f : faces[c]) {
      for (int32_t corner : mesh.faces[f]) local[corner] = -1;
    }
    if (!mesh.part.empty()) chart.part = chart.rank = mesh.part[c];
    if (!mesh.weight.empty()) chart.weight = mesh.weight[c];
  }
  return charts;
}

}  // namespace

Result<Repacked> repack(const FlatMesh& mesh, const PackOptions& options, const Context& context) {
  if (mesh.faces.empty()) return Failure{Error::empty_mesh, "faces"};
  if (mesh.chart.size() != mesh.faces.size()) return Failure{Error::index_out_of_range, "chart"};
  const size_t count = 1 + *std::max_element(mesh.chart.begin(), mesh.chart.end());
  if (count > mesh.faces.size()) return Failure{Error::index_out_of_range, "chart"};
  if (const Result<bool> fine = check(mesh, count); !fine) return fine.failure();
  PackOptions plain = options;
  plain.rounding_steps = 0.5;  // nothing but rounding happens to the points below
  Result<Packing> packed = pack(separate(mesh, count), plain, context);
  if (!packed) return packed.failure();
  if (context.cancelled()) return Failure{Error::cancelled, "packing"};
  Repacked result;
  result.packing = std::move(packed.value());
  result.corner_uv.reserve(6 * mesh.faces.size());
  const double grid = std::ldexp(1.0, result.packing.grid_bits);
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Placement& place = result.packing.placements[mesh.chart[f]];
    const packing::Turn turn(place.rotation_rad, place.scale);
    for (int32_t corner : mesh.faces[f]) {
      const Vec2 at = turn(mesh.uv[corner]) + place.offset;
      for (int k = 0; k < 2; ++k) {
        const double rounded = std::round(at[k] * grid) / grid;
        result.corner_uv.push_back(static_cast<float>(std::clamp(rounded, 0.0, 1.0)));
      }
    }
  }
  return result;
}

}  // namespace partuv
