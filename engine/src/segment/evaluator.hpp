#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "partuv/cut.hpp"
#include "partuv/search.hpp"
#include "tree/steady_normals.hpp"

namespace partuv {

/// Distortion that the best conformal map of a region would have, above which flattening it cannot
/// end within the bounds.
double prediction_limit(const FlattenOptions& options);

/// Open a piece so that its predicted distortion comes below `limit` if at all possible: handles,
/// tubes, then corners and peaks of the conformal scale. Empty if it can't be opened.
std::optional<OpenedPiece> open_for_flattening(const Piece& piece, double limit,
                                               const SearchOptions& options,
                                               const Context& context);

/// Open a piece with a boundary along a path to its only sharp tip, which may be too coarse for the
/// predicted scale to see. Empty if it has none or more, or if that is out of bounds.
std::optional<OpenedPiece> open_to_tip(const Piece& piece, double limit,
                                       const SearchOptions& options, const Context& context);

/// Prediction for a region that cannot be opened.
constexpr double hopeless = 10.0;

/// A set of faces, by a hash that is as good as the set itself.
struct RegionKey {
  uint64_t low = 0, high = 0;
  bool operator==(const RegionKey&) const = default;

  struct Hash {
    size_t operator()(const RegionKey& key) const { return key.low; }
  };
};

/// Pieces that were opened for a prediction and may be flattened later. Bounded: the oldest are
/// dropped and opened again when they are asked for.
class OpenedPieces {
 public:
  void keep(const RegionKey& key, OpenedPiece piece);
  std::optional<OpenedPiece> take(const RegionKey& key);

 private:
  std::mutex mutex_;
  std::unordered_map<RegionKey, OpenedPiece, RegionKey::Hash> pieces_;
  std::deque<RegionKey> by_age_;  ///< those taken in the meantime included
  size_t face_count_ = 0;
};

/// Answers whether a region of a surface flattens within the bounds, and remembers every answer by
/// the set of faces. May be asked from several threads; answers do not depend on the order.
class Evaluator {
 public:
  Evaluator(const Surface& surface, const std::vector<double>& weight, const SearchOptions& options,
            const Context& context)
      : surface_(surface), weight_(weight), options_(options), context_(context) {}

  /// Predicted distortion of the region once opened; above the limit it is hopeless.
  double predicted(const std::vector<int32_t>& faces);
  /// The same if it is known already.
  std::optional<double> known_prediction(const std::vector<int32_t>& faces);
  /// The region as a chart if it flattens within the bounds. faces: ascending.
  std::optional<Chart> chart(const std::vector<int32_t>& faces);

  /// The union of two charts, joined only along the longest run of their common boundary, the rest
  /// of it left open: so a box unfolds like a cross. None if that does not flatten within the
  /// bounds.
  std::optional<Chart> partly_welded(const Chart& a, const Chart& b) const;

  const Surface& surface() const { return surface_; }
  /// Of the faces; see `steady_normals`. Made when they are first asked for.
  const std::vector<Vec3>& normals() {
    std::call_once(normals_made_, [&] { normals_ = steady_normals(surface_); });
    return normals_;
  }
  const std::vector<double>& weight() const { return weight_; }
  const SearchOptions& options() const { return options_; }
  const Context& context() const { return context_; }
  double limit() const { return prediction_limit(options_.flatten); }

 private:
  struct Answer {
    double predicted = hopeless;
    bool tried = false;
    bool within = false;
    double area_distortion = 0.0, angular = 0.0;
  };

  /// One region that is being worked out: whoever else asks for it waits for the answer.
  class Claim {
   public:
    Claim(Evaluator& evaluator, const RegionKey& key);
    ~Claim();
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;

   private:
    Evaluator& evaluator_;
    RegionKey key_;
  };

  static RegionKey key_of(const std::vector<int32_t>& faces);
  std::optional<Answer> recall(const RegionKey& key);
  void remember(const RegionKey& key, const Answer& answer);
  std::optional<OpenedPiece> open(const std::vector<int32_t>& faces) const;

  const Surface& surface_;
  const std::vector<double>& weight_;
  const SearchOptions& options_;
  const Context& context_;
  std::once_flag normals_made_;
  std::vector<Vec3> normals_;
  std::mutex mutex_;
  std::unordered_map<RegionKey, Answer, RegionKey::Hash> answers_;
  std::unordered_set<RegionKey, RegionKey::Hash> claimed_;
  std::condition_variable released_;
  OpenedPieces opened_;
};

/// Ward tree of a surface over its face normals; none once the context is cancelled.
std::optional<PartTree> normals_tree(const Surface& surface, const Context& context);

/// The two topmost clusters of connected faces by their normals, each ascending. faces: at least
/// two.
std::vector<std::vector<int32_t>> normal_halves(const Surface& surface,
                                                const std::vector<int32_t>& faces,
                                                const Context& context);

/// Heuristic Normal: the first of 1..most_charts clusterings of the face normals whose clusters all
/// flatten within the bounds. faces: connected.
std::optional<ChartSet> normal_heuristic(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                         int most_charts);

/// Heuristic Merge: regions of like orientation to the axes of the piece's box, merged as long as
/// the unions flatten within the bounds. Empty if some region does not flatten at all.
std::optional<ChartSet> merge_heuristic(Evaluator& evaluator, const std::vector<int32_t>& faces,
                                        int most_charts);

/// Merge neighbouring charts while their unions flatten within the bounds: the union with the least
/// predicted distortion first, then the one with the longest shared boundary. With `movable` one
/// flag per chart, only pairs with a movable chart are tried. Stops when the unions tried have
/// `most_work_faces` in all, those that were flattened counted several times.
void merge_charts(Evaluator& evaluator, ChartSet& charts, std::vector<char> movable = {},
                  double most_work_faces = std::numeric_limits<double>::infinity());

/// Connected components of a set of faces, each ascending, in order of their smallest faces.
std::vector<std::vector<int32_t>> connected_parts(const Surface& surface,
                                                  const std::vector<int32_t>& faces);

}  // namespace partuv
