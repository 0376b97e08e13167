#include "partuv/prior.hpp"

#include <cmath>
#include <span>

#include "partuv/tree_nbm.hpp"
#include "partuv/tree_ward.hpp"

namespace partuv {

Result<PartTree> build_part_tree(const PartPrior& prior, const Topology& topology,
                                 const Proxy& proxy, const Context& context) {
  const size_t caller_faces = topology.welded.size();
  const size_t proxy_faces = proxy.surface.faces.size();
  const Surface& s = topology.surface;
  if (prior.tree) {
    if (static_cast<size_t>(prior.tree->face_count) != caller_faces) {
      return Failure{Error::invalid_tree, "number of leaves"};
    }
    std::vector<int32_t> representative(proxy_faces, -1);
    std::vector<double> largest(proxy_faces, -1.0);
    for (int f = 0; f < s.face_count(); ++f) {
      const int p = proxy.proxy_of_face[f];
      const double area = face_cross(s, f).norm();
      if (area > largest[p]) {
        largest[p] = area;
        representative[p] = topology.source_face[f];
      }
    }
    return restrict_tree(*prior.tree, representative);
  }
  if (prior.dimensions > 0) {
    const size_t d = static_cast<size_t>(prior.dimensions);
    if (prior.features.size() != caller_faces * d) {
      return Failure{Error::invalid_tree, "number of features"};
    }
    std::vector<double> mean(proxy_faces * d, 0.0), weight(proxy_faces, 0.0);
    for (int f = 0; f < s.face_count(); ++f) {
      const int p = proxy.proxy_of_face[f];
      const double area = face_cross(s, f).norm() + 1e-12;
      weight[p] += area;
      for (size_t k = 0; k < d; ++k) {
        const double value = prior.features[topology.source_face[f] * d + k];
        if (!std::isfinite(value)) {
          return Failure{Error::invalid_tree,
                         "feature of face " + std::to_string(topology.source_face[f])};
        }
        mean[p * d + k] += area * value;
      }
    }
    for (size_t p = 0; p < proxy_faces; ++p) {
      for (size_t k = 0; k < d; ++k) mean[p * d + k] /= weight[p];
    }
    return build_ward_tree(proxy.surface, std::span<const double>(mean), prior.dimensions, context);
  }
  return build_nbm_tree(proxy.surface, NbmOptions{}, context);
}

}  // namespace partuv
