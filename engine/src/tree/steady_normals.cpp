#include "tree/steady_normals.hpp"

#include <algorithm>
#include <utility>

namespace partuv {
namespace {

// Thinner than this share of the bounding diagonal, single precision leaves nothing of a normal.
constexpr double least_height = 1e-6;

double diagonal(const Surface& surface) {
  if (surface.positions.empty()) return 0.0;
  Vec3 low = surface.positions[0], high = low;
  for (const Vec3& p : surface.positions) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// The neighbour across the longest side that has a normal, or -1.
int lending_neighbour(const Surface& surface, const std::vector<Vec3>& normals, int face) {
  int lender = -1;
  double longest = -1.0;
  for (int s = 0; s < 3; ++s) {
    const int o = surface.opposite[face][s];
    if (o < 0 || normals[o / 3].isZero(0.0)) continue;
    const double length = side_length(surface, 3 * face + s);
    if (length > longest) {
      longest = length;
      lender = o / 3;
    }
  }
  return lender;
}

}  // namespace

std::vector<Vec3> steady_normals(const Surface& surface) {
  const double threshold = least_height * diagonal(surface);
  std::vector<Vec3> normals(surface.faces.size(), Vec3::Zero());
  std::vector<int32_t> thin;
  for (int f = 0; f < surface.face_count(); ++f) {
    const Vec3 cross = face_cross(surface, f);
    const double length = cross.norm();
    double longest = 0.0;
    for (int s = 0; s < 3; ++s) longest = std::max(longest, side_length(surface, 3 * f + s));
    if (length > threshold * longest) {
      normals[f] = cross / length;
    } else {
      thin.push_back(f);
    }
  }
  // Breadth first: in one round only normals of the rounds before are lent.
  std::vector<std::pair<int32_t, int32_t>> loans;
  std::vector<int32_t> round = thin, next;
  while (!round.empty()) {
    loans.clear();
    next.clear();
    for (const int f : round) {
      if (!normals[f].isZero(0.0)) continue;
      const int lender = lending_neighbour(surface, normals, f);
      if (lender >= 0) loans.emplace_back(f, lender);
    }
    for (const auto& [f, lender] : loans) {
      normals[f] = normals[lender];
      for (const int o : surface.opposite[f]) {
        if (o >= 0 && normals[o / 3].isZero(0.0)) next.push_back(o / 3);
      }
    }
    round.swap(next);
  }
  return normals;
}

}  // namespace partuv
