#pragma once

#include <cstdint>
#include <vector>

#include "partuv/surface.hpp"

namespace partuv::detail {

/// An edge seen from one of its ends: `out` leaves that vertex, `in` arrives. One is -1 at a
/// boundary.
struct Spoke {
  int out = -1;
  int in = -1;
};

/// A surface that can lose vertices and swap diagonals in place. Half-edges are numbered as in
/// `Surface`; dead faces keep their number and have vertex -1.
class EditableSurface {
 public:
  explicit EditableSurface(const Surface& source);

  const Vec3& position(int v) const { return (*positions_)[v]; }
  const Triangle& face(int f) const { return faces_[f]; }
  bool face_alive(int f) const { return faces_[f][0] >= 0; }
  int face_slots() const { return static_cast<int>(faces_.size()); }
  int alive_faces() const { return alive_faces_; }
  int vertex_count() const { return static_cast<int>(first_.size()); }
  bool vertex_alive(int v) const { return first_[v] >= 0; }
  /// Number of edges at v.
  int valence(int v) const { return valence_[v]; }
  bool on_boundary(int v) const { return opposite_[first_[v]] < 0; }

  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int prev(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  int from(int h) const { return faces_[h / 3][h % 3]; }
  int to(int h) const { return from(next(h)); }
  int opposite(int h) const { return opposite_[h]; }
  /// The far end of a spoke.
  int tip(const Spoke& spoke) const { return spoke.out >= 0 ? to(spoke.out) : from(spoke.in); }

  /// Call body(h) for every half-edge that leaves v (one per face), counter-clockwise.
  template <typename Body>
  void around(int v, Body&& body) const {
    const int start = first_[v];
    int h = start;
    do {
      body(h);
      h = opposite_[prev(h)];
    } while (h >= 0 && h != start);
  }

  /// Call body(spoke) for every edge at v, counter-clockwise.
  template <typename Body>
  void around_edges(int v, Body&& body) const {
    const int start = first_[v];
    int h = start, last;
    do {
      body(Spoke{h, opposite_[h]});
      last = h;
      h = opposite_[prev(h)];
    } while (h >= 0 && h != start);
    if (h < 0) body(Spoke{-1, prev(last)});
  }

  /// True if moving u along one of its spokes onto its tip keeps the surface a manifold of the same
  /// topology, with its boundary in place (link condition; Dey et al. 1999).
  bool can_collapse(int u, const Spoke& spoke);
  /// Remove u and the one or two faces at the spoke. `heir_of` names for each removed face one that
  /// now covers its place.
  void collapse(int u, const Spoke& spoke, std::vector<int32_t>& heir_of);

  /// True if replacing the edge of h by the other diagonal keeps the surface a manifold.
  bool can_flip(int h) const;
  void flip(int h);

 private:
  void link(int a, int b);
  void set_first(int v, int leaving);
  bool adjacent(int a, int b) const;
  int heir(int face, int inner, int outer) const;

  const std::vector<Vec3>* positions_;
  std::vector<Triangle> faces_;
  std::vector<int32_t> opposite_;
  std::vector<int32_t> first_;  ///< a half-edge leaving v, the clockwise-most one at a boundary
  std::vector<int32_t> valence_;
  std::vector<int32_t> mark_;
  int32_t stamp_ = 0;
  int alive_faces_;
};

}  // namespace partuv::detail
