#include "mesh/simplify_provenance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "mesh/parallel_chunks.hpp"

namespace partuv::detail {
namespace {

struct Nearest {
  Vec3 point;
  int corner;  ///< the corner at which it lies, or -1
};

/// The point of a triangle nearest to p (Ericson 2005, section 5.1.5).
Nearest nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + ab * (d1 / (d1 - d3)), -1};
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + ac * (d2 / (d2 - d6)), -1};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0) {
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), -1};
  }
  const double denominator = va + vb + vc;
  return {a + ab * (vb / denominator) + ac * (vc / denominator), -1};
}

class Walker {
 public:
  Walker(const Surface& source, const Surface& proxy, double length)
      : source_(source), proxy_(proxy), squared_length_(length * length) {
    normals_.reserve(proxy.face_count());
    for (int f = 0; f < proxy.face_count(); ++f) {
      normals_.push_back(face_cross(proxy, f).stableNormalized());
    }
  }

  /// What it costs to have proxy face p stand for source face f.
  double cost(int f, int p) const {
    int corner;
    return cost(centre(f), normal(f), p, corner);
  }

  int nearest_face(int f, int start) const {
    const Vec3 c = centre(f), n = normal(f);
    int best = start, corner;
    double best_cost = cost(c, n, start, corner);
    for (int previous = -1; previous != best;) {
      const int here = best, here_corner = corner;
      previous = here;
      const auto consider = [&](int candidate) {
        if (candidate == best) return;
        int candidate_corner;
        const double candidate_cost = cost(c, n, candidate, candidate_corner);
        if (!(candidate_cost < best_cost)) return;
        best_cost = candidate_cost;
        best = candidate;
        corner = candidate_corner;
      };
      for (const int h : proxy_.opposite[here]) {
        if (h >= 0) consider(h / 3);
      }
      if (here_corner >= 0) around_corner(3 * here + here_corner, consider);
    }
    return best;
  }

 private:
  Vec3 centre(int f) const {
    const Triangle& t = source_.faces[f];
    return (source_.positions[t[0]] + source_.positions[t[1]] + source_.positions[t[2]]) / 3.0;
  }
  Vec3 normal(int f) const { return face_cross(source_, f).stableNormalized(); }

  /// Squared distance, plus a charge for a normal that points elsewhere.
  double cost(const Vec3& point, const Vec3& direction, int candidate, int& corner) const {
    const Triangle& t = proxy_.faces[candidate];
    const Nearest nearest = nearest_on_triangle(point, proxy_.positions[t[0]],
                                                proxy_.positions[t[1]], proxy_.positions[t[2]]);
    corner = nearest.corner;
    constexpr double turn_weight = 0.25;
    return (nearest.point - point).squaredNorm() +
           turn_weight * squared_length_ * (1.0 - direction.dot(normals_[candidate]));
  }

  template <typename Body>
  void around_corner(int h, Body&& body) const {
    const auto across = [&](int side) { return proxy_.opposite[side / 3][side % 3]; };
    // Counter-clockwise, then clockwise if a boundary stopped the turn.
    int turn = h;
    do {
      turn = across(turn % 3 == 0 ? turn + 2 : turn - 1);
      if (turn >= 0) body(turn / 3);
    } while (turn >= 0 && turn != h);
    if (turn >= 0) return;
    for (turn = across(h); turn >= 0; turn = across(turn)) {
      body(turn / 3);
      turn = turn % 3 == 2 ? turn - 2 : turn + 1;
    }
  }

  const Surface& source_;
  const Surface& proxy_;
  double squared_length_;
  std::vector<Vec3> normals_;
};

/// Keep the largest connected piece of each proxy face's set; give the rest to its neighbours.
void connect_sets(const Surface& source, const Surface& proxy, std::vector<int32_t>& owner) {
  const int faces = source.face_count();
  std::vector<int32_t> piece(faces, -1), stack;
  std::vector<double> piece_area;
  for (int seed = 0; seed < faces; ++seed) {
    if (piece[seed] >= 0) continue;
    const int id = static_cast<int>(piece_area.size());
    double area = 0.0;
    piece[seed] = id;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      area += face_cross(source, f).norm();
      for (const int h : source.opposite[f]) {
        if (h < 0 || piece[h / 3] >= 0 || owner[h / 3] != owner[seed]) continue;
        piece[h / 3] = id;
        stack.push_back(h / 3);
      }
    }
    piece_area.push_back(area);
  }
  std::vector<int32_t> largest(proxy.face_count(), -1);
  for (int f = 0; f < faces; ++f) {
    int32_t& kept = largest[owner[f]];
    if (kept < 0 || piece_area[piece[f]] > piece_area[kept]) kept = piece[f];
  }
  // Grow the kept pieces over the stray ones, one ring at a time.
  std::vector<int32_t> front, next;
  const auto stray = [&](int f) { return owner[f] < 0; };
  for (int f = 0; f < faces; ++f) {
    if (piece[f] != largest[owner[f]]) {
      owner[f] = -1 - owner[f];
      front.push_back(f);
    }
  }
  // A stray face waits for a neighbour that faces its way as long as any other finds one.
  constexpr double same_plane = 0.9;
  std::vector<std::pair<int32_t, int32_t>> adopted;
  for (double least_agreement = same_plane; !front.empty();) {
    next.clear();
    adopted.clear();
    for (const int f : front) {
      int best = -1;
      double best_agreement = -std::numeric_limits<double>::infinity();
      const Vec3 normal = face_cross(source, f).stableNormalized();
      for (const int h : source.opposite[f]) {
        if (h < 0 || stray(h / 3)) continue;
        const double agreement = normal.dot(face_cross(proxy, owner[h / 3]).stableNormalized());
        if (best < 0 || agreement > best_agreement) {
          best = owner[h / 3];
          best_agreement = agreement;
        }
      }
      if (best >= 0 && best_agreement >= least_agreement) {
        adopted.emplace_back(f, best);
      } else {
        next.push_back(f);
      }
    }
    for (const auto& [f, new_owner] : adopted) owner[f] = new_owner;
    const bool stuck = adopted.empty();
    front.swap(next);
    if (stuck) {
      if (least_agreement < -1.0) break;
      least_agreement = -2.0;
    } else {
      least_agreement = same_plane;
    }
  }
}

/// The faces of each owner, in order.
struct FaceLists {
  std::vector<int32_t> begin, faces;

  FaceLists(const std::vector<int32_t>& owner, int owners)
      : begin(owners + 1, 0), faces(owner.size()) {
    for (const int32_t p : owner) ++begin[p + 1];
    for (int p = 0; p < owners; ++p) begin[p + 1] += begin[p];
    std::vector<int32_t> at(begin.begin(), begin.end() - 1);
    for (int f = 0; f < static_cast<int>(owner.size()); ++f) faces[at[owner[f]]++] = f;
  }
};

/// True if the set that f belongs to stays connected without f.
bool can_leave(const Surface& source, const std::vector<int32_t>& owner, int f) {
  std::vector<int32_t> seen = {f}, ends;
  for (const int h : source.opposite[f]) {
    if (h >= 0 && owner[h / 3] == owner[f]) ends.push_back(h / 3);
  }
  if (ends.empty()) return false;
  seen.push_back(ends[0]);
  for (size_t i = 1; i < seen.size(); ++i) {
    for (const int h : source.opposite[seen[i]]) {
      if (h < 0 || owner[h / 3] != owner[f]) continue;
      if (std::find(seen.begin(), seen.end(), h / 3) == seen.end()) seen.push_back(h / 3);
    }
  }
  return std::all_of(ends.begin(), ends.end(), [&](int end) {
    return std::find(seen.begin(), seen.end(), end) != seen.end();
  });
}

/// Give every empty proxy face the source face that fits it best, from a neighbour that can spare
/// it.
void fill_empty(const Walker& walker, const Surface& source, const Surface& proxy,
                std::vector<int32_t>& owner) {
  const FaceLists lists(owner, proxy.face_count());
  std::vector<int32_t> count(proxy.face_count());
  for (int p = 0; p < proxy.face_count(); ++p) count[p] = lists.begin[p + 1] - lists.begin[p];
  // Larger sets can spare a face without a search through all of them; they seldom have to.
  constexpr int largest_set = 64;
  for (int p = 0; p < proxy.face_count(); ++p) {
    if (count[p] > 0) continue;
    int best = -1;
    double best_loss = std::numeric_limits<double>::infinity();
    for (const int h : proxy.opposite[p]) {
      const int q = h / 3;
      if (h < 0 || count[q] < 2 || count[q] > largest_set) continue;
      for (int i = lists.begin[q]; i < lists.begin[q + 1]; ++i) {
        const int f = lists.faces[i];
        if (owner[f] != q) continue;
        const double loss = walker.cost(f, p) - walker.cost(f, q);
        if (loss < best_loss && can_leave(source, owner, f)) {
          best = f;
          best_loss = loss;
        }
      }
    }
    if (best < 0) continue;
    --count[owner[best]];
    ++count[p];
    owner[best] = p;
  }
}

}  // namespace

void settle_provenance(const Surface& source, const Surface& proxy, double length,
                       std::vector<int32_t>& proxy_of_face, const Context& context) {
  const Walker walker(source, proxy, length);
  parallel_chunks(context, source.face_count(),
                  [&](int f) { proxy_of_face[f] = walker.nearest_face(f, proxy_of_face[f]); });
  connect_sets(source, proxy, proxy_of_face);
  fill_empty(walker, source, proxy, proxy_of_face);
}

}  // namespace partuv::detail
