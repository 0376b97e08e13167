#pragma once

#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "partuv/cut.hpp"
#include "partuv/search.hpp"
#include "partuv/solve.hpp"

namespace partuv {

/// Lays charts on neighbouring ones: the few rings of faces around the seam move, the rest of the
/// neighbour stays where it lies. A chart that was taken in is left empty.
class Grafter {
 public:
  Grafter(const Surface& surface, const SearchOptions& options, const Context& context,
          std::vector<SolvedChart>& charts);

  /// Number of the neighbour that took the chart in, -1 if none did.
  int graft(int fragment);

  /// The same for a chart of less area than its host, which may also hang on it by a part of their
  /// common boundary while the rest stays open: by a run of sides or a single one. closeness: the
  /// least share of the chart's outline by which it may hang; with 0 it is tried the harder, and on
  /// hosts of less area, too. The mean angular score keeps its bound, and most of what it has above
  /// it.
  void hang(int fragment, double closeness);

  /// Let a sliver that hangs nowhere take over as few faces of a neighbour as make it this wide
  /// (`narrow_width`). True if it did: both keep all bounds, and the neighbour its one piece. Not
  /// between calls of `hang`.
  bool widen(int sliver, double least_width);

  /// Faces looked at so far.
  double work_faces() const { return work_faces_; }

 private:
  /// Sides of a fragment along which it joins a neighbour.
  struct Weld {
    int32_t host;
    std::vector<int32_t> sides;
    double length;
  };

  /// A weld that was tried.
  struct Attempt {
    std::optional<Flattening> grown;  ///< the host with the fragment laid on, where that is allowed
    double work_faces = 0.0;          ///< looked at
  };

  /// What a thread marks while it tries a weld.
  struct Marks {
    CutSides cuts;           ///< those of all charts, and the sides that this weld leaves open
    std::vector<char> seen;  ///< per face
  };

  /// What a union has to keep and how hard it is tried.
  struct Terms {
    /// Of the sum of angular scores.
    double least_gain = -std::numeric_limits<double>::infinity();
    bool spread = false;         ///< take apart what comes to lie on itself
    bool spread_widely = false;  ///< even where that is unlikely to work
  };

  Weld weld_along(int host, std::vector<int32_t> sides) const;

  static void sort_by_length(std::vector<Weld>& welds);

  /// All that a fragment shares with each of the neighbours that it shares most with.
  std::vector<Weld> full_welds(int fragment) const;

  const std::vector<int32_t>& faces_of(int c) const;

  void take_in(int c);

  /// Sides that are open inside a chart.
  void note_cuts(const Piece& piece);

  Vec2 corner(int f, int k) const;

  /// The fragment and the faces of the host within a few rings of it.
  std::vector<int32_t> patch_around(int host, int fragment, Marks& marks) const;

  /// Sides that lie open on both charts when a fragment is welded to a host.
  std::vector<int32_t> sides_off(const Weld& weld, int fragment) const;

  /// Let the first host that can take the fragment in do so: within the bounds, and gaining as
  /// much. Threads that are free try the next ones meanwhile. The host's number, -1 if none can.
  int grow_first(const std::vector<Weld>& welds, int fragment, const Terms& terms);

  /// Sum of angular scores that a weld brings.
  double gain(const Weld& weld, int fragment, const Flattening& grown) const;

  /// The host with the fragment laid on, if that may be.
  Attempt attempt(const Weld& weld, int fragment, const Terms& terms);
  Attempt laid_on(int host, int fragment, const Terms& terms, Marks& marks) const;

  /// A map of the patch around a fragment, at its borders with the rest of the host as that lies.
  std::optional<std::vector<Vec2>> lay_patch(const Piece& patch, int host, const Terms& terms,
                                             const CutSides& cuts) const;

  /// Faces of the chart beyond a side of a sliver, the nearest first, until they have enough area.
  std::vector<int32_t> faces_beyond(int side, double enough_area);

  /// Move those faces from the host to the sliver, which they join along the weld alone.
  bool take_over(const Weld& weld, int sliver, std::vector<int32_t> taken, double least_width);

  /// The sliver with those faces, ascending, if that keeps all bounds and is wide enough.
  std::optional<Flattening> widened(const Weld& weld, int sliver, const std::vector<int32_t>& taken,
                                    double least_width);

  /// What a host keeps, as faces of its piece, when it loses those that are taken: its largest
  /// connected part. The other parts are taken as well.
  std::vector<int32_t> left_in_one_piece(int host, std::vector<int32_t>& taken) const;

  std::unique_ptr<Marks> borrow_marks();
  void return_marks(std::unique_ptr<Marks> marks);

  const Surface& surface_;
  const SearchOptions& options_;
  const Context& context_;
  std::vector<SolvedChart>& charts_;
  std::vector<double> area_;  ///< of each chart
  double work_faces_ = 0.0;
  double spare_angular_ = 0.0;  ///< sum of angular scores that may be given up
  std::vector<int32_t> chart_of_, local_of_;
  CutSides cuts_;  ///< sides that are open inside a chart
  std::mutex mutex_;
  std::vector<std::unique_ptr<Marks>> marks_;  ///< those that no thread uses
};

}  // namespace partuv
