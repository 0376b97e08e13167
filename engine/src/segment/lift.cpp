#include "partuv/lift.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "partuv/denoise.hpp"
#include "segment/lift_regions.hpp"

namespace partuv {
namespace {

double mean_edge(const Surface& surface) {
  double length = 0.0;
  for (const Triangle& t : surface.faces) {
    for (int s = 0; s < 3; ++s) {
      length += (surface.positions[t[(s + 1) % 3]] - surface.positions[t[s]]).norm();
    }
  }
  return surface.faces.empty() ? 0.0 : length / (3.0 * surface.face_count());
}

Vec3 centre(const Surface& surface, int f) {
  const Triangle& t = surface.faces[f];
  return (surface.positions[t[0]] + surface.positions[t[1]] + surface.positions[t[2]]) / 3.0;
}

/// Give every label that has lost all its faces the nearest source face of a label that can spare
/// one, in the proxy faces nearest over the proxy's surface.
void revive_labels(const Surface& source, const Proxy& proxy,
                   const std::vector<int32_t>& label_of_proxy_face, int labels,
                   std::vector<int32_t>& label) {
  std::vector<int32_t> count(labels, 0), sample(labels, -1);
  for (const int32_t l : label) ++count[l];
  for (int p = proxy.surface.face_count() - 1; p >= 0; --p) sample[label_of_proxy_face[p]] = p;
  std::vector<int32_t> lost;
  for (int l = 0; l < labels; ++l) {
    if (count[l] == 0 && sample[l] >= 0) lost.push_back(l);
  }
  if (lost.empty()) return;

  std::vector<std::vector<int32_t>> faces_of(proxy.surface.faces.size());
  for (int f = 0; f < source.face_count(); ++f) faces_of[proxy.proxy_of_face[f]].push_back(f);
  for (const int l : lost) {
    const Vec3 target = centre(proxy.surface, sample[l]);
    std::vector<int32_t> queue = {sample[l]};
    std::vector<uint8_t> seen(proxy.surface.faces.size(), 0);
    seen[sample[l]] = 1;
    int best = -1;
    for (size_t i = 0; i < queue.size() && best < 0; ++i) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const int f : faces_of[queue[i]]) {
        const double d = (centre(source, f) - target).squaredNorm();
        if (count[label[f]] > 1 && d < nearest) {
          nearest = d;
          best = f;
        }
      }
      for (const int h : proxy.surface.opposite[queue[i]]) {
        if (h < 0 || seen[h / 3]) continue;
        seen[h / 3] = 1;
        queue.push_back(h / 3);
      }
    }
    if (best < 0) continue;
    --count[label[best]];
    label[best] = l;
    count[l] = 1;
  }
}

}  // namespace

std::vector<int32_t> lift_labels(const Surface& source, const SideWeights& weights,
                                 const Proxy& proxy,
                                 const std::vector<int32_t>& label_of_proxy_face,
                                 const LiftOptions& options, const Context& context) {
  std::vector<int32_t> label(source.face_count());
  if (label.empty()) return label;
  const int labels = 1 + *std::max_element(label_of_proxy_face.begin(), label_of_proxy_face.end());
  const double edge = mean_edge(proxy.surface);
  // First over the distance of a few coarse faces, then within them.
  std::vector<int32_t> coarse = label_of_proxy_face;
  straighten_labels(proxy.surface,
                    weigh_sides(proxy.surface, estimate_noise(proxy.surface), context),
                    1.5 * options.band_edges * edge, coarse, context);
  for (int f = 0; f < source.face_count(); ++f) label[f] = coarse[proxy.proxy_of_face[f]];
  revive_labels(source, proxy, coarse, labels, label);
  detail::Regions(source, label).keep_largest_pieces(labels);
  straighten_labels(source, weights, options.band_edges * edge, label, context);
  return label;
}

}  // namespace partuv
