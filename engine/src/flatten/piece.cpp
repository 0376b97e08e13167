#include "partuv/piece.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace partuv {
namespace {

int next_side(int h) { return h - h % 3 + (h % 3 + 1) % 3; }

/// Position of each face in a list: a table for large lists, a search for small ones.
class FaceIndex {
 public:
  FaceIndex(const std::vector<int32_t>& faces, int face_count)
      : small_(static_cast<int64_t>(faces.size()) * 64 < face_count) {
    if (!small_) table_.assign(face_count, -1);
    for (size_t i = 0; i < faces.size(); ++i) {
      if (small_) {
        pairs_.emplace_back(faces[i], static_cast<int32_t>(i));
      } else {
        table_[faces[i]] = static_cast<int32_t>(i);
      }
    }
    std::sort(pairs_.begin(), pairs_.end());
  }
  int find(int face) const {
    if (!small_) return table_[face];
    const auto it = std::lower_bound(pairs_.begin(), pairs_.end(), std::make_pair(face, 0));
    return it != pairs_.end() && it->first == face ? it->second : -1;
  }

 private:
  bool small_;
  std::vector<int32_t> table_;
  std::vector<std::pair<int32_t, int32_t>> pairs_;
};

/// Number the vertices of a surface whose faces hold source vertices and whose `opposite` is set:
/// a vertex is a fan of corners joined across sides.
void split_vertices(Piece& piece, const std::vector<Vec3>& source_positions) {
  Surface& s = piece.surface;
  std::vector<int32_t> vertex_of_corner(3 * s.faces.size(), -1);
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

void trace_loops(Piece& piece) {
  const Surface& s = piece.surface;
  std::vector<char> seen(3 * s.faces.size(), 0);
  int boundary_sides = 0;
  std::vector<double> length;
  for (int h = 0; h < static_cast<int>(seen.size()); ++h) {
    if (seen[h] || s.opposite[h / 3][h % 3] >= 0) continue;
    std::vector<int32_t> loop;
    double sum = 0.0;
    int side = h;
    do {
      seen[side] = 1;
      loop.push_back(side);
      const Triangle& t = s.faces[side / 3];
      sum += (s.positions[t[(side % 3 + 1) % 3]] - s.positions[t[side % 3]]).norm();
      side = next_side(side);
      while (s.opposite[side / 3][side % 3] >= 0) {
        side = next_side(s.opposite[side / 3][side % 3]);
      }
    } while (side != h);
    boundary_sides += static_cast<int>(loop.size());
    piece.loops.push_back(std::move(loop));
    length.push_back(sum);
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

}  // namespace

Piece extract_piece(const Surface& source, const std::vector<int32_t>& faces,
                    const std::vector<double>& weight, const CutSides& cuts) {
  Piece piece;
  piece.source_face = faces;
  piece.weight.resize(faces.size(), 1.0);
  Surface& s = piece.surface;
  s.faces.resize(faces.size());
  s.opposite.resize(faces.size());
  const FaceIndex local(faces, source.face_count());
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
  split_vertices(piece, source.positions);
  trace_loops(piece);
  return piece;
}

Piece open_piece(const Piece& piece, const CutSides& cuts) {
  std::vector<int32_t> all(piece.surface.faces.size());
  std::iota(all.begin(), all.end(), 0);
  Piece opened = extract_piece(piece.surface, all, piece.weight, cuts);
  opened.source_face = piece.source_face;
  for (int32_t& v : opened.source_vertex) v = piece.source_vertex[v];
  return opened;
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

std::vector<double> angle_defects(const Surface& surface) {
  std::vector<double> defect(surface.positions.size(), 2.0 * std::numbers::pi);
  for (int f = 0; f < surface.face_count(); ++f) {
    const Triangle& t = surface.faces[f];
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = surface.positions[t[(k + 1) % 3]] - surface.positions[t[k]];
      const Vec3 b = surface.positions[t[(k + 2) % 3]] - surface.positions[t[k]];
      defect[t[k]] -= std::atan2(a.cross(b).norm(), a.dot(b));
    }
  }
  const std::vector<char> boundary = boundary_vertices(surface);
  for (size_t v = 0; v < defect.size(); ++v) {
    if (boundary[v]) defect[v] = 0.0;
  }
  return defect;
}

}  // namespace partuv
