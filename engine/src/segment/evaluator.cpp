#include "segment/evaluator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "face_index.hpp"
#include "rounded.hpp"
#include "scramble.hpp"

namespace partuv {
namespace {

/// Vertices where a polyhedron bends in two directions: the tips that a cut has to reach.
std::vector<int32_t> sharp_corners(const Piece& piece) {
  constexpr double least_defect = 0.6;
  constexpr size_t most_corners = 64;
  std::vector<int32_t> corners;
  const std::vector<double> defect = angle_defects(piece);
  for (size_t v = 0; v < defect.size(); ++v) {
    if (std::abs(defect[v]) > least_defect) corners.push_back(static_cast<int32_t>(v));
  }
  if (corners.size() > most_corners) corners.clear();
  return corners;
}

}  // namespace

double prediction_limit(const FlattenOptions& options) {
  // The polish trades angle for area: it reaches tau from conformal maps up to about this far above
  // (measured on spherical caps). Without it the conformal map is the result.
  const double excess = options.max_area_distortion - 1.0;
  return 1.0 + excess * (options.polish ? 1.7 : 1.05);
}

std::optional<OpenedPiece> open_for_flattening(const Piece& piece, double limit,
                                               const SearchOptions& options,
                                               const Context& context) {
  if (piece.component_count != 1) return std::nullopt;
  const bool disk_like = !piece.loops.empty() && piece.genus() == 0;
  if (!options.cut_open) {
    if (!disk_like) return std::nullopt;
    return OpenedPiece{piece, predict_scale(piece, context)};
  }
  CutOptions cut;
  Piece opened = open_piece(piece, find_cuts(piece, cut));
  ConformalScale scale = predict_scale(opened, context);
  if (scale.area_distortion > limit) {
    cut.terminals = sharp_corners(piece);
    if (!cut.terminals.empty()) {
      Piece unfolded = open_piece(piece, find_cuts(piece, cut));
      ConformalScale better = predict_scale(unfolded, context);
      if (rounded(better.area_distortion) < rounded(scale.area_distortion)) {
        opened = std::move(unfolded);
        scale = std::move(better);
      }
    }
  }
  for (int slit = 0; slit < options.most_slits && scale.area_distortion > limit; ++slit) {
    // A slit to the peak of the scale; pointless where the distortion is far out of reach.
    if (scale.area_distortion > 1.0 + 3.0 * (limit - 1.0)) break;
    int peak = 0;
    for (size_t v = 0; v < scale.log_scale.size(); ++v) {
      const auto height = [&](size_t at) { return rounded(std::abs(scale.log_scale[at])); };
      if (height(v) > height(peak)) peak = static_cast<int>(v);
    }
    CutOptions slit_cut;
    slit_cut.join_tubes = false;
    slit_cut.terminals = {peak};
    Piece slitted = open_piece(opened, find_cuts(opened, slit_cut));
    ConformalScale better = predict_scale(slitted, context);
    if (!(rounded(better.area_distortion) < rounded(scale.area_distortion))) break;
    opened = std::move(slitted);
    scale = std::move(better);
  }
  return OpenedPiece{std::move(opened), std::move(scale)};
}

std::optional<OpenedPiece> open_to_tip(const Piece& piece, double limit,
                                       const SearchOptions& options, const Context& context) {
  if (!options.cut_open) return std::nullopt;
  CutOptions cut;
  cut.join_tubes = false;
  cut.terminals = sharp_corners(piece);
  if (cut.terminals.size() != 1) return std::nullopt;
  Piece opened = open_piece(piece, find_cuts(piece, cut));
  ConformalScale scale = predict_scale(opened, context);
  if (scale.area_distortion > limit) return std::nullopt;
  return OpenedPiece{std::move(opened), std::move(scale)};
}

void OpenedPieces::keep(const RegionKey& key, OpenedPiece piece) {
  constexpr size_t most_faces = 100'000;
  const size_t faces = piece.piece.source_face.size();
  if (faces > most_faces) return;
  std::lock_guard<std::mutex> lock(mutex_);
  if (!pieces_.emplace(key, std::move(piece)).second) return;
  by_age_.push_back(key);
  face_count_ += faces;
  for (; face_count_ > most_faces; by_age_.pop_front()) {
    const auto oldest = pieces_.find(by_age_.front());
    if (oldest == pieces_.end()) continue;
    face_count_ -= oldest->second.piece.source_face.size();
    pieces_.erase(oldest);
  }
}

std::optional<OpenedPiece> OpenedPieces::take(const RegionKey& key) {
  std::lock_guard<std::mutex> lock(mutex_);
  auto node = pieces_.extract(key);
  if (node.empty()) return std::nullopt;
  face_count_ -= node.mapped().piece.source_face.size();
  return std::move(node.mapped());
}

RegionKey Evaluator::key_of(const std::vector<int32_t>& faces) {
  RegionKey key;
  for (int f : faces) {
    key.low += scramble(static_cast<uint64_t>(f));
    key.high += scramble(static_cast<uint64_t>(f) * 0xd6e8feb86659fd93ULL + 1);
  }
  return key;
}

Evaluator::Claim::Claim(Evaluator& evaluator, const RegionKey& key)
    : evaluator_(evaluator), key_(key) {
  std::unique_lock<std::mutex> lock(evaluator_.mutex_);
  if (evaluator_.claimed_.insert(key_).second) return;
  // While this thread waits, what the others run may use it.
  evaluator_.context_.return_threads(1);
  evaluator_.released_.wait(lock, [&] { return evaluator_.claimed_.insert(key_).second; });
  evaluator_.context_.return_threads(-1);
}

Evaluator::Claim::~Claim() {
  {
    std::lock_guard<std::mutex> lock(evaluator_.mutex_);
    evaluator_.claimed_.erase(key_);
  }
  evaluator_.released_.notify_all();
}

std::optional<Evaluator::Answer> Evaluator::recall(const RegionKey& key) {
  std::lock_guard<std::mutex> lock(mutex_);
  const auto it = answers_.find(key);
  if (it == answers_.end()) return std::nullopt;
  return it->second;
}

void Evaluator::remember(const RegionKey& key, const Answer& answer) {
  std::lock_guard<std::mutex> lock(mutex_);
  Answer& kept = answers_[key];
  if (!kept.tried) kept = answer;
}

std::optional<OpenedPiece> Evaluator::open(const std::vector<int32_t>& faces) const {
  return open_for_flattening(extract_piece(surface_, faces, weight_), limit(), options_, context_);
}

double Evaluator::predicted(const std::vector<int32_t>& faces) {
  if (faces.size() == 1) return 1.0;
  const RegionKey key = key_of(faces);
  if (const auto known = recall(key)) return known->predicted;
  const Claim claim(*this, key);
  if (const auto known = recall(key)) return known->predicted;
  Answer answer;
  if (auto opened = open(faces)) {
    answer.predicted = opened->scale.area_distortion;
    if (answer.predicted <= limit()) opened_.keep(key, std::move(*opened));
  }
  remember(key, answer);
  return answer.predicted;
}

std::optional<double> Evaluator::known_prediction(const std::vector<int32_t>& faces) {
  if (faces.size() == 1) return 1.0;
  const auto known = recall(key_of(faces));
  return known ? std::optional(known->predicted) : std::nullopt;
}

std::optional<Chart> Evaluator::chart(const std::vector<int32_t>& faces) {
  Chart found;
  if (faces.size() == 1) {
    found.faces = faces;
    return found;
  }
  const RegionKey key = key_of(faces);
  Answer answer;
  const Claim claim(*this, key);
  const auto known = recall(key);
  if (known && (known->tried || known->predicted > limit())) {
    answer = *known;
  } else {
    std::optional<OpenedPiece> opened = opened_.take(key);
    if (!opened) opened = open(faces);
    if (opened) answer.predicted = opened->scale.area_distortion;
    if (opened && answer.predicted <= limit() && !context_.stopping()) {
      FlattenOptions quick = options_.flatten;
      quick.quick = true;
      Flattening flattening = flatten(*opened, quick, context_);
      if (!flattening.within) {
        if (auto tipped = open_to_tip(opened->piece, limit(), options_, context_)) {
          flattening = flatten(std::move(*tipped), quick, context_);
        }
      }
      answer.tried = true;
      answer.within = flattening.within;
      answer.area_distortion = flattening.distortion.area;
      answer.angular = flattening.distortion.angular;
    }
    if (!context_.stopping()) remember(key, answer);
  }
  if (!answer.within) return std::nullopt;
  found.faces = faces;
  found.area_distortion = answer.area_distortion;
  found.angular = answer.angular;
  return found;
}

std::vector<std::vector<int32_t>> connected_parts(const Surface& surface,
                                                  const std::vector<int32_t>& faces) {
  std::vector<int32_t> sorted = faces;
  std::sort(sorted.begin(), sorted.end());
  std::vector<int32_t> part(sorted.size(), -1);
  const FaceIndex place(sorted);
  std::vector<std::vector<int32_t>> parts;
  std::vector<int32_t> stack;
  for (size_t i = 0; i < sorted.size(); ++i) {
    if (part[i] >= 0) continue;
    const int number = static_cast<int>(parts.size());
    parts.emplace_back();
    part[i] = number;
    stack.push_back(static_cast<int32_t>(i));
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      parts[number].push_back(sorted[at]);
      for (int h : surface.opposite[sorted[at]]) {
        const int next = h < 0 ? -1 : place.find(h / 3);
        if (next >= 0 && part[next] < 0) {
          part[next] = number;
          stack.push_back(next);
        }
      }
    }
    std::sort(parts[number].begin(), parts[number].end());
  }
  return parts;
}

}  // namespace partuv
