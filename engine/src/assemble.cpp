#include "assemble.hpp"

#include <algorithm>
#include <cmath>

#include "partuv/grid.hpp"
#include "planar.hpp"
#include "segment/evaluator.hpp"

namespace partuv {
namespace {

/// Give faces that repeat a point the coordinates of corners at the same points in one chart, so
/// that they lie on an edge (or a point) of it.
void place_collapsed(const Topology& topology, Atlas& atlas) {
  if (topology.collapsed.empty()) return;
  // Corners of the surface's faces by welded point.
  std::vector<std::pair<int32_t, int32_t>> corners;
  for (int f : topology.source_face) {
    for (int k = 0; k < 3; ++k) corners.emplace_back(topology.welded[f][k], 3 * f + k);
  }
  std::sort(corners.begin(), corners.end());
  auto at_point = [&](int point) {
    return std::lower_bound(corners.begin(), corners.end(), std::make_pair(point, -1));
  };
  for (int f : topology.collapsed) {
    // The two points of the face that differ, or the one.
    const Triangle& t = topology.welded[f];
    const int a = t[0], b = t[1] != t[0] ? t[1] : t[2];
    int corner_a = -1, corner_b = -1;
    for (auto i = at_point(a); i != corners.end() && i->first == a; ++i) {
      if (corner_a < 0) corner_a = i->second;
      const Triangle& other = topology.welded[i->second / 3];
      for (int k = 0; k < 3; ++k) {
        if (other[k] == b && corner_b < 0) {
          corner_a = i->second;
          corner_b = i->second - i->second % 3 + k;
        }
      }
    }
    if (corner_a < 0)
      corner_a = at_point(b) != corners.end() && at_point(b)->first == b
                     ? at_point(b)->second
                     : 3 * topology.source_face.front();
    if (corner_b < 0) corner_b = corner_a;
    const int host = corner_a / 3;
    atlas.chart[f] = atlas.chart[host];
    atlas.part[f] = atlas.part[host];
    atlas.tile[f] = atlas.tile[host];
    ++atlas.charts[atlas.chart[f]].face_count;
    for (int k = 0; k < 3; ++k) {
      const int corner = t[k] == b && b != a ? corner_b : corner_a;
      atlas.corner_uv[6 * f + 2 * k] = atlas.corner_uv[2 * corner];
      atlas.corner_uv[6 * f + 2 * k + 1] = atlas.corner_uv[2 * corner + 1];
    }
  }
}

/// Twice the area of a chart's face as written, negative where it is turned over.
double written_turn(const Topology& topology, const Piece& piece, const Atlas& atlas, int face) {
  const float* uv = &atlas.corner_uv[6 * topology.source_face[piece.source_face[face]]];
  const auto corner = [&](int k) { return Vec2(uv[2 * k], uv[2 * k + 1]); };
  return turn(corner(0), corner(1), corner(2));
}

/// Faces of a chart, by number of the surface, that have an area and are written turned over.
std::vector<int32_t> turned_faces(const Topology& topology, const Piece& piece, const Atlas& atlas,
                                  double least_area) {
  std::vector<int32_t> turned;
  for (int f = 0; f < piece.surface.face_count(); ++f) {
    if (written_turn(topology, piece, atlas, f) < 0.0 &&
        0.5 * face_cross(piece.surface, f).norm() > least_area) {
      turned.push_back(piece.source_face[f]);
    }
  }
  return turned;
}

/// Faces of a chart, by number of the surface, that rounding has made much smaller or larger than
/// they lay in the plane.
std::vector<int32_t> lost_faces(const Topology& topology, const Flattening& flat,
                                const Atlas& atlas) {
  constexpr double most_change = 3.0;
  const Surface& s = flat.piece.surface;
  std::vector<double> written(s.faces.size()), meant(s.faces.size());
  double written_sum = 0.0, meant_sum = 0.0;
  for (int f = 0; f < s.face_count(); ++f) {
    const Triangle& t = s.faces[f];
    written_sum += written[f] = written_turn(topology, flat.piece, atlas, f);
    meant_sum += meant[f] = turn(flat.uv[t[0]], flat.uv[t[1]], flat.uv[t[2]]);
  }
  std::vector<int32_t> lost;
  for (int f = 0; f < s.face_count(); ++f) {
    const double change = written[f] * meant_sum / (meant[f] * written_sum);
    if (change >= 1.0 / most_change && change <= most_change) continue;
    lost.push_back(flat.piece.source_face[f]);
  }
  return lost;
}

/// A piece with its vertices where they are in the caller's mesh.
Piece unrounded(const Topology& topology, const Piece& piece) {
  Piece exact = piece;
  if (topology.unrounded.empty()) return exact;
  for (size_t v = 0; v < piece.source_vertex.size(); ++v) {
    exact.surface.positions[v] = topology.unrounded[piece.source_vertex[v]];
  }
  return exact;
}

}  // namespace

ChartSet lift_charts(const Surface& surface, const SideWeights& weights, const Proxy& proxy,
                     const ChartSet& charts, const Context& context) {
  std::vector<int32_t> label(proxy.surface.faces.size(), -1);
  for (size_t c = 0; c < charts.size(); ++c) {
    for (int f : charts[c].faces) label[f] = static_cast<int32_t>(c);
  }
  const std::vector<int32_t> lifted =
      lift_labels(surface, weights, proxy, label, LiftOptions{}, context);
  std::vector<std::vector<int32_t>> faces(charts.size());
  for (int f = 0; f < surface.face_count(); ++f) faces[lifted[f]].push_back(f);
  ChartSet regions;
  for (size_t c = 0; c < charts.size(); ++c) {
    for (auto& part : connected_parts(surface, faces[c])) {
      Chart region;
      region.faces = std::move(part);
      region.part = charts[c].part;
      regions.push_back(std::move(region));
    }
  }
  return regions;
}

std::vector<ChartExcess> charts_to_repair(const Topology& topology,
                                          const std::vector<SolvedChart>& solved,
                                          const Atlas& atlas, double least_area,
                                          double max_area_distortion) {
  std::vector<ChartExcess> failed;
  for (size_t c = 0; c < atlas.charts.size(); ++c) {
    const ChartFigures& figures = atlas.charts[c];
    const Flattening& flat = solved[c].flattening;
    if (figures.face_count == 1) continue;
    const bool exceeds = figures.area_distortion > max_area_distortion;
    std::vector<int32_t> lost = exceeds ? lost_faces(topology, flat, atlas)
                                        : turned_faces(topology, flat.piece, atlas, least_area);
    if (!exceeds && lost.empty()) continue;
    failed.push_back({static_cast<int32_t>(c), figures.area_distortion, std::move(lost)});
  }
  return failed;
}

void assemble(const Mesh& mesh, const Topology& topology, const std::vector<SolvedChart>& solved,
              const Packing& packing, double least_area, Atlas& atlas) {
  const size_t faces = mesh.faces.size();
  atlas.corner_uv.assign(6 * faces, 0.0f);
  atlas.chart.assign(faces, 0);
  atlas.part.assign(faces, 0);
  atlas.tile.assign(faces, 0);
  atlas.charts.resize(solved.size());
  for (size_t c = 0; c < solved.size(); ++c) {
    const Flattening& flat = solved[c].flattening;
    const Placement& place = packing.placements[c];
    const double cosine = place.scale * std::cos(place.rotation_rad);
    const double sine = place.scale * std::sin(place.rotation_rad);
    std::vector<Vec2> uv(flat.uv.size());
    for (size_t v = 0; v < uv.size(); ++v) {
      const Vec2& p = flat.uv[v];
      uv[v] = Vec2(cosine * p.x() - sine * p.y(), sine * p.x() + cosine * p.y()) + place.offset;
    }
    uv = round_to_grid(flat.piece, uv, least_area, packing.grid_bits);
    ChartFigures& figures = atlas.charts[c];
    const Surface& s = flat.piece.surface;
    for (int f = 0; f < s.face_count(); ++f) {
      const int source = topology.source_face[flat.piece.source_face[f]];
      const int first = topology.first_corner[flat.piece.source_face[f]];
      for (int k = 0; k < 3; ++k) {
        float* written = &atlas.corner_uv[6 * source + 2 * ((first + k) % 3)];
        written[0] = static_cast<float>(uv[s.faces[f][k]].x());
        written[1] = static_cast<float>(uv[s.faces[f][k]].y());
      }
      atlas.chart[source] = static_cast<int32_t>(c);
      atlas.part[source] = solved[c].part;
      atlas.tile[source] = place.tile;
      figures.area_3d += 0.5 * face_cross(s, f).norm() * topology.area;
    }
    const Distortion distortion = measure(unrounded(topology, flat.piece), uv, least_area);
    figures.face_count = s.face_count();
    figures.part = solved[c].part;
    figures.tile = place.tile;
    figures.area_distortion = distortion.area;
    figures.angular = distortion.angular_axes;
  }
  place_collapsed(topology, atlas);
}

}  // namespace partuv
