#include <algorithm>
#include <cmath>

#include "partuv/flatten.hpp"
#include "planar.hpp"

namespace partuv {
namespace {

using Segment = BoundarySegment;

bool between(const Vec2& a, const Vec2& b, const Vec2& p, double touch) {
  return std::min(a.x(), b.x()) <= p.x() + touch && p.x() <= std::max(a.x(), b.x()) + touch &&
         std::min(a.y(), b.y()) <= p.y() + touch && p.y() <= std::max(a.y(), b.y()) + touch;
}

/// True if two segments come within `touch` of each other, but for an end that both name.
bool meet(const Segment& s, const Segment& t, const std::vector<Vec2>& uv, double touch) {
  const Vec2 &a = uv[s.from], &b = uv[s.to], &c = uv[t.from], &d = uv[t.to];
  if (s.to == t.from || s.from == t.to) {
    // Neighbours along the loop: only folding back onto each other counts.
    const Vec2 &hinge = s.to == t.from ? b : a, &p = s.to == t.from ? a : b,
               &q = s.to == t.from ? d : c;
    return turn(hinge, p, q) == 0.0 && (p - hinge).dot(q - hinge) > 0.0;
  }
  // Twice the area between a segment and a point that touches it.
  const double along_ab = touch * (b - a).norm(), along_cd = touch * (d - c).norm();
  const auto beside = [](double area, double least) { return std::abs(area) > least ? area : 0.0; };
  const double abc = beside(turn(a, b, c), along_ab), abd = beside(turn(a, b, d), along_ab);
  const double cda = beside(turn(c, d, a), along_cd), cdb = beside(turn(c, d, b), along_cd);
  if (abc * abd < 0.0 && cda * cdb < 0.0) return true;
  return (abc == 0.0 && between(a, b, c, touch)) || (abd == 0.0 && between(a, b, d, touch)) ||
         (cda == 0.0 && between(c, d, a, touch)) || (cdb == 0.0 && between(c, d, b, touch));
}

/// Call `visit` for pairs of boundary segments that meet, until it returns false. True if the
/// boundary is simple: no pair meets, and only one loop is an outline.
template <typename Visit>
bool check_boundary(const Piece& piece, const std::vector<Vec2>& uv, const Visit& visit) {
  std::vector<Segment> segments;
  int outlines = 0;
  for (const auto& loop : piece.loops) {
    double area = 0.0;
    for (int h : loop) {
      const Segment s{piece.surface.faces[h / 3][h % 3],
                      piece.surface.faces[h / 3][(h % 3 + 1) % 3]};
      area += uv[s.from].x() * uv[s.to].y() - uv[s.from].y() * uv[s.to].x();
      segments.push_back(s);
    }
    outlines += area > 0.0;
  }
  // Without flips the angles add up to branch points for every loop beyond the first that runs
  // counter-clockwise: a hole turned inside out covers the plane twice.
  bool simple = outlines == 1;
  Vec2 low = uv[segments.front().from], high = low;
  double length = 0.0;
  for (const Segment& s : segments) {
    low = low.cwiseMin(uv[s.from]);
    high = high.cwiseMax(uv[s.from]);
    length += (uv[s.to] - uv[s.from]).norm();
  }
  const Vec2 extent = high - low;
  if (!extent.allFinite() || !(length > 0.0)) return false;
  const double touch = touching_share * extent.maxCoeff();
  // Cells of about the mean segment's size, so that each cell sees a few segments.
  const double cell = std::max(length / segments.size(), extent.maxCoeff() / 2000.0);
  const int columns = static_cast<int>(extent.x() / cell) + 1;
  const int rows = static_cast<int>(extent.y() / cell) + 1;
  std::vector<std::pair<int32_t, int32_t>> entries;  // (cell, segment)
  for (size_t i = 0; i < segments.size(); ++i) {
    const Vec2 a = (uv[segments[i].from] - low) / cell, b = (uv[segments[i].to] - low) / cell;
    const int x0 = static_cast<int>(std::min(a.x(), b.x())),
              y0 = static_cast<int>(std::min(a.y(), b.y()));
    const int x1 = static_cast<int>(std::max(a.x(), b.x())),
              y1 = static_cast<int>(std::max(a.y(), b.y()));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        // Leave out cells that the segment's line passes on one side.
        const Vec2 centre(x + 0.5, y + 0.5), d = b - a;
        const double away = std::abs(d.x() * (centre.y() - a.y()) - d.y() * (centre.x() - a.x()));
        if (away > 0.5001 * (std::abs(d.x()) + std::abs(d.y())) + 1e-9) continue;
        entries.emplace_back(std::min(y, rows - 1) * columns + std::min(x, columns - 1),
                             static_cast<int32_t>(i));
      }
    }
  }
  std::sort(entries.begin(), entries.end());
  for (size_t i = 0; i < entries.size(); ++i) {
    for (size_t j = i + 1; j < entries.size() && entries[j].first == entries[i].first; ++j) {
      const Segment &s = segments[entries[i].second], &t = segments[entries[j].second];
      if (!meet(s, t, uv, touch)) continue;
      simple = false;
      if (!visit(s, t)) return false;
    }
  }
  return simple;
}

}  // namespace

bool boundary_is_simple(const Piece& piece, const std::vector<Vec2>& uv) {
  return check_boundary(piece, uv, [](const auto&, const auto&) { return false; });
}

std::vector<std::pair<BoundarySegment, BoundarySegment>> boundary_meetings(
    const Piece& piece, const std::vector<Vec2>& uv, size_t most) {
  std::vector<std::pair<BoundarySegment, BoundarySegment>> pairs;
  check_boundary(piece, uv, [&](const auto& s, const auto& t) {
    pairs.emplace_back(s, t);
    return pairs.size() < most;
  });
  return pairs;
}

}  // namespace partuv
