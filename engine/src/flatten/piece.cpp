#include "partuv/piece.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "face_index.hpp"
#include "rounded.hpp"

namespace partuv {
namespace {

int next_side(int h) { return h - h % 3 + (h % 3 + 1) % 3; }

/// Number the vertices of a surface whose faces hold source vertices and whose `opposite` is set:
/// a vertex is a fan of corners joined across sides.
void split_vertices(Piece& piece, const std::vector<Vec3>& source_positions) {
  Surface& s = piece.surface;
  std::vector<int32_t> vertex_of_corner(3 * s.faces.size(), -1);
  s.positions.reserve(s.faces.size());
  piece.source_vertex.reserve(s.faces.size());
  for (int c = 0; c < static_cast<int>(vertex_of_corner.size()); ++c) {
    if (vertex_of_corner[c] >= 0) continue;
    // Turn to the first corner of an open fan, then number the fan the other way round.
    int start = c;
    while (true) {
      const int across = s.opposite[start / 3][start % 3];
      if (across < 0) break;
      start = next_side(across);
      if (start == c) break;
    }
    const int v = s.vertex_count();
    const int source = s.faces[c / 3][c % 3];
    s.positions.push_back(source_positions[source]);
    piece.source_vertex.push_back(source);
    int corner = start;
    do {
      vertex_of_corner[corner] = v;
      corner = s.opposite[corner / 3][(corner % 3 + 2) % 3];
    } while (corner >= 0 && corner != start);
  }
  for (size_t f = 0; f < s.faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) s.faces[f][k] = vertex_of_corner[3 * f + k];
  }
}

void measure_corners(Piece& piece) {
  const Surface& s = piece.surface;
  piece.corner_angles.resize(s.faces.size());
  for (size_t f = 0; f < s.faces.size(); ++f) {
    const Triangle& t = s.faces[f];
    const Vec3 side = s.positions[t[1]] - s.positions[t[0]];
    const Vec3 other = s.positions[t[2]] - s.positions[t[0]];
    const double twice_area = side.cross(other).norm();
    const double first = std::atan2(twice_area, side.dot(other));
    const double second = std::atan2(twice_area, side.dot(side - other));
    piece.corner_angles[f] = {first, second, std::numbers::pi - first - second};
  }
}

void trace_loops(Piece& piece) {
  const Surface& s = piece.surface;
  std::vector<char> seen(3 * s.faces.size(), 0);
  int boundary_sides = 0;
  std::vector<float> length;
  for (int h = 0; h < static_cast<int>(seen.size()); ++h) {
    if (seen[h] || s.opposite[h / 3][h % 3] >= 0) continue;
    std::vector<int32_t> loop;
    int side = h;
    do {
      seen[side] = 1;
      loop.push_back(side);
      side = next_side(side);
      while (s.opposite[side / 3][side % 3] >= 0) {
        side = next_side(s.opposite[side / 3][side % 3]);
      }
    } while (side != h);
    boundary_sides += static_cast<int>(loop.size());
    length.push_back(rounded(loop_length(s, loop)));
    piece.loops.push_back(std::move(loop));
  }
  std::vector<int32_t> order(piece.loops.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return length[a] > length[b]; });
  std::vector<std::vector<int32_t>> sorted;
  for (int i : order) sorted.push_back(std::move(piece.loops[i]));
  piece.loops = std::move(sorted);
  const int faces = s.face_count();
  const int edges = (3 * faces + boundary_sides) / 2;
  piece.euler = s.vertex_count() - edges + faces;
  std::vector<int32_t> component;
  piece.component_count = label_components(s, component);
}

/// Everything that follows from the faces and `opposite`, but for the corner angles.
void trace_outline(Piece& piece, const std::vector<Vec3>& source_positions) {
  split_vertices(piece, source_positions);
  trace_loops(piece);
}

}  // namespace

Piece extract_piece(const Surface& source, const std::vector<int32_t>& faces,
                    const std::vector<double>& weight, const CutSides& cuts) {
  Piece piece;
  piece.source_face = faces;
  piece.weight.resize(faces.size(), 1.0);
  Surface& s = piece.surface;
  s.faces.resize(faces.size());
  s.opposite.resize(faces.size());
  const FaceIndex local(faces);
  for (size_t i = 0; i < faces.size(); ++i) {
    const int f = faces[i];
    s.faces[i] = source.faces[f];
    if (!weight.empty()) piece.weight[i] = weight[f];
    for (int k = 0; k < 3; ++k) {
      const int across = source.opposite[f][k];
      const bool cut = !cuts.empty() && cuts[3 * f + k];
      const int other = across < 0 || cut ? -1 : local.find(across / 3);
      s.opposite[i][k] = other < 0 ? -1 : 3 * other + across % 3;
    }
  }
  trace_outline(piece, source.positions);
  measure_corners(piece);
  return piece;
}

Piece open_piece(const Piece& piece, const CutSides& cuts) {
  if (std::find(cuts.begin(), cuts.end(), 1) == cuts.end()) return piece;
  Piece opened;
  opened.source_face = piece.source_face;
  opened.weight = piece.weight;
  opened.corner_angles = piece.corner_angles;
  Surface& s = opened.surface;
  s.faces = piece.surface.faces;
  s.opposite = piece.surface.opposite;
  for (size_t h = 0; h < cuts.size(); ++h) {
    if (cuts[h]) s.opposite[h / 3][h % 3] = -1;
  }
  trace_outline(opened, piece.surface.positions);
  for (int32_t& v : opened.source_vertex) v = piece.source_vertex[v];
  return opened;
}

double loop_length(const Surface& surface, const std::vector<int32_t>& loop) {
  double sum = 0.0;
  for (const int h : loop) sum += side_length(surface, h);
  return sum;
}

std::vector<RestTriangle> rest_shapes(const Surface& surface, double least_height) {
  std::vector<RestTriangle> rest(surface.faces.size());
  for (int f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.faces[f];
    const Vec3 e1 = surface.positions[t[1]] - surface.positions[t[0]];
    const Vec3 e2 = surface.positions[t[2]] - surface.positions[t[0]];
    const double longest =
        std::sqrt(std::max({e1.squaredNorm(), e2.squaredNorm(), (e2 - e1).squaredNorm()}));
    const double floor = std::max(least_height * longest, 1e-12);
    const double length = std::max(e1.norm(), floor);
    const double x = e1.dot(e2) / length;
    const double y = e1.cross(e2).norm() / length;
    rest[f] = {length, x, std::max(y, floor)};
  }
  return rest;
}

std::vector<char> boundary_vertices(const Surface& surface) {
  std::vector<char> boundary(surface.positions.size(), 0);
  for (int f = 0; f < surface.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) {
      if (surface.opposite[f][k] < 0) {
        boundary[surface.faces[f][k]] = boundary[surface.faces[f][(k + 1) % 3]] = 1;
      }
    }
  }
  return boundary;
}

std::vector<double> angle_sums(const Piece& piece) {
  std::vector<double> sum(piece.surface.positions.size(), 0.0);
  for (size_t f = 0; f < piece.corner_angles.size(); ++f) {
    for (int k = 0; k < 3; ++k) sum[piece.surface.faces[f][k]] += piece.corner_angles[f][k];
  }
  return sum;
}

std::vector<double> angle_defects(const Piece& piece) {
  std::vector<double> defect = angle_sums(piece);
  for (double& angle : defect) angle = 2.0 * std::numbers::pi - angle;
  for (const auto& loop : piece.loops) {
    for (const int h : loop) defect[piece.surface.faces[h / 3][h % 3]] = 0.0;
  }
  return defect;
}

}  // namespace partuv
