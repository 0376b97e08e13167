#pragma once

#include <functional>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/options.hpp"
#include "partuv/piece.hpp"

namespace partuv {

/// Where the paper clips max(s, 1/s) of a face, s its stretch by Eq. 1: what a lost face counts.
constexpr double most_face_distortion = 10.0;

/// How far a flattening is from an isometry. Means count the caller's faces, as the paper does.
struct Distortion {
  double area = 1.0;     ///< mean of max(s, 1/s), s the stretch of Eq. 1 of the paper, clipped
  double angular = 1.0;  ///< mean angular score over all rotations of the chart; 1 is conformal
  double angular_axes = 1.0;  ///< the paper's score, of the U and V axes as they lie
  int flipped = 0;            ///< faces of non-positive area
};

/// Measure a flattening of a piece against its true (not thickened) triangles. Degenerate faces,
/// below `least_area`, enter no mean and are never flipped.
Distortion measure(const Piece& piece, const std::vector<Vec2>& uv, double least_area);

/// Rotation-free angular score of a map with singular values s1 >= s2 > 0:
/// 1 - (2 / pi) asin((s1^2 - s2^2) / (s1^2 + s2^2)).
double angular_score(double s1, double s2);

template <int D>
class MeshSystem;

/// Scale a map to the area of the rest shapes. False, and nothing done, where it has none.
bool scale_to_area(const Piece& piece, const std::vector<RestTriangle>& rest,
                   std::vector<Vec2>& uv);

/// Least-squares conformal map (Levy et al. 2002) of rest shapes, two far vertices pinned. Scaled
/// to the area of the rest shapes, faces counter-clockwise. Empty if the system could not be
/// solved. system: two unknowns per vertex over the faces of the piece.
std::vector<Vec2> conformal_layout(const Piece& piece, const std::vector<RestTriangle>& rest,
                                   const Context& context, MeshSystem<2>& system);

/// The least-squares conformal map that keeps the fixed vertices where they are. False if the
/// system could not be solved.
bool conformal_extension(const Piece& piece, const std::vector<RestTriangle>& rest,
                         const std::vector<char>& fixed, const Context& context,
                         MeshSystem<2>& system, std::vector<Vec2>& uv);

/// Angles of ABF++ (Sheffer et al. 2005), as rest shapes of the same areas, after `steps` Newton
/// steps of the reduced system.
std::vector<RestTriangle> angle_based_shapes(const Piece& piece,
                                             const std::vector<RestTriangle>& rest, int steps,
                                             const Context& context);

/// Every face laid rigidly beside the one from which it is reached first: exact where the piece is
/// developable, torn and flipped where it is not. Empty if a face leaves no room for its neighbour.
std::vector<Vec2> unfolded_layout(const Piece& piece, const std::vector<RestTriangle>& rest);

/// The same from vertices that are placed already. False if some face cannot be laid.
bool unfold(const Piece& piece, const std::vector<RestTriangle>& rest, std::vector<char> placed,
            std::vector<Vec2>& uv);

/// Tutte embedding: the longest loop on a circle, other loops filled. Never flips (up to rounding).
std::vector<Vec2> tutte_layout(const Piece& piece, const Context& context);

/// What the polish minimises: the mean over faces of
/// angle_weight ((s1/s2 + s2/s1)/2 - 1) + area_weight ((d + 1/d)/2 - 1), d = s1 s2.
/// Equal weights lie near the symmetric Dirichlet energy, 4 cosh(ln s1/s2) cosh(ln d).
struct PolishOptions {
  double angle_weight = 1.0;
  double area_weight = 0.25;
  int steps = 12;                ///< Newton steps at most
  double least_area = 0.0;       ///< faces below it count for no more than their area
  std::vector<char> fixed;       ///< vertices that stay where they are; empty: none
  double least_decrease = 1e-3;  ///< stop when a step lowers the energy by less than this share
};

/// Lower the distortion energy of a flip-free flattening by projected Newton steps (analytic
/// eigensystems: Smith et al. 2019). Faces never flip. `enough` is asked after every step whether
/// the map is good as it is. system: as for `conformal_layout`. True if it converged or was good.
bool polish(const Piece& piece, const std::vector<RestTriangle>& rest, const PolishOptions& options,
            const std::function<bool()>& enough, const Context& context, MeshSystem<2>& system,
            std::vector<Vec2>& uv);

/// Turn flipped faces over by the same energy with a barrier that lets them pass (Garanzha et al.
/// 2021). True if no face is flipped in the end.
bool untangle(const Piece& piece, const std::vector<RestTriangle>& rest,
              const PolishOptions& options, const Context& context, MeshSystem<2>& system,
              std::vector<Vec2>& uv);

/// A flip-free map with its boundary drawn in by a hundredth of the faces' height: where it only
/// touches itself, as flaps do that lie side by side when unfolded, it no longer does.
std::vector<Vec2> inset_boundary(const Piece& piece, const std::vector<Vec2>& uv);

/// True if a flip-free map lies on itself so widely or deeply that `spread_apart` is hopeless.
bool overlaps_widely(const Piece& piece, const std::vector<Vec2>& uv);

/// Move the parts of a flip-free map that lie on each other apart: springs pull the boundary
/// vertices that lie on another part of the map out of it, against the distortion energy. At most
/// that many Newton steps, and none once `hopeless` says so. True if nothing overlaps in the end.
bool spread_apart(const Piece& piece, const std::vector<RestTriangle>& rest,
                  const PolishOptions& options, int most_rounds,
                  const std::function<bool()>& hopeless, const Context& context,
                  MeshSystem<2>& system, std::vector<Vec2>& uv);

/// True if the boundary of a flip-free flattening of a piece without handles neither crosses nor
/// touches itself and only its outline runs counter-clockwise, which makes the flattening
/// injective.
bool boundary_is_simple(const Piece& piece, const std::vector<Vec2>& uv);

/// A side of the boundary, by the vertices of its piece.
struct BoundarySegment {
  int32_t from, to;
};

/// Up to `most` pairs of boundary segments that cross or touch; a pair may come more than once.
std::vector<std::pair<BoundarySegment, BoundarySegment>> boundary_meetings(
    const Piece& piece, const std::vector<Vec2>& uv, size_t most);

/// A piece laid flat, with its measured distortion.
struct Flattening {
  Piece piece;           ///< opened along the cuts that were made
  std::vector<Vec2> uv;  ///< per vertex of `piece`, at the scale of the surface
  Distortion distortion;
  bool valid = false;   ///< finite, no flip, no overlap
  bool within = false;  ///< valid, and inside the bounds of the options
};

/// Bounds and means of flattening one piece.
struct FlattenOptions {
  double max_area_distortion = 1.25;
  double min_angular = 0.95;
  bool polish = true;
  bool angle_based = true;
  double area_weight = 0.25;  ///< of the polish, to begin with
  int steps = 12;             ///< polish steps at most, per weighting
  int spread_steps = 8;       ///< steps at most that move overlapping parts of a map apart
  int patience = 5;           ///< times the usual steps, where a chart would be split otherwise
  bool quick = false;         ///< stop as soon as the bounds hold: enough to know that they can
  bool to_cut_apart = false;  ///< quick: go on with maps that lie on themselves widely, too
  double least_area = 1e-14;  ///< faces below it have no distortion that could be measured
};

/// What the best conformal map of a piece would do to its areas, without flattening it: logarithm
/// of the scale per vertex, 0 on the boundary, from the angle defects (Ben-Chen et al. 2008).
struct ConformalScale {
  std::vector<double> log_scale;  ///< per vertex, of lengths
  double area_distortion =
      1.0;  ///< mean of max(s, 1/s) over the caller's faces, Eq. 1 of the paper
};

/// Rest shapes under a conformal scale: nearly flat, so that laying them out is nearly exact.
std::vector<RestTriangle> scaled_shapes(const Surface& surface,
                                        const std::vector<double>& log_scale);

/// One sparse solve of the size of the piece's inner vertices. The piece must have a boundary.
ConformalScale predict_scale(const Piece& piece, const Context& context);

/// A piece with a boundary and without handles, and what to expect of it.
struct OpenedPiece {
  Piece piece;
  ConformalScale scale;
};

/// Flatten a piece as it is (its boundary and cuts given).
Flattening flatten(OpenedPiece opened, const FlattenOptions& options, const Context& context);

/// True if nothing is flipped and both means keep the bounds of one chart.
bool keeps_bounds(const Distortion& distortion, const FlattenOptions& options);

/// True if a polished map stretches areas so far beyond the bound that neither more steps nor
/// another start bring it there.
bool stretches_hopelessly(const Distortion& distortion, const FlattenOptions& options);

/// Measure and prove a map of a piece.
Flattening judged(Piece piece, std::vector<Vec2> uv, const FlattenOptions& options);

/// Some faces (local, ascending) of a flattening, lying where they lay, judged anew.
Flattening restricted(const Flattening& flattening, const std::vector<int32_t>& faces,
                      const FlattenOptions& options);

}  // namespace partuv
