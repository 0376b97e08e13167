#include "partuv/flatten.hpp"

#include <nanobind/stl/tuple.h>

#include <numeric>

#include "arrays.hpp"
#include "bindings.hpp"
#include "partuv/topology.hpp"
#include "raise.hpp"

namespace nb = nanobind;

namespace partuv {
namespace {

nb::dict flatten_mesh(const PositionArray& positions, const FaceArray& faces,
                      double max_area_distortion, double min_angular, bool polish,
                      bool angle_based) {
  const Mesh mesh = to_mesh(positions, faces);
  Flattening flattening;
  std::vector<int32_t> source;
  {
    nb::gil_scoped_release release;
    Result<Topology> topology = build_topology(mesh);
    if (!topology) {
      nb::gil_scoped_acquire acquire;
      raise(topology.failure());
    }
    std::vector<int32_t> all(topology.value().surface.faces.size());
    std::iota(all.begin(), all.end(), 0);
    FlattenOptions options;
    options.max_area_distortion = max_area_distortion;
    options.min_angular = min_angular;
    options.polish = polish;
    options.angle_based = angle_based;
    const Context context;
    Piece piece = extract_piece(topology.value().surface, all, {});
    ConformalScale scale = predict_scale(piece, context);
    flattening = flatten({std::move(piece), std::move(scale)}, options, context);
    source = topology.value().source_face;
  }
  std::vector<double> uv(mesh.faces.size() * 6, 0.0);
  if (!flattening.uv.empty()) {
    for (size_t f = 0; f < flattening.piece.surface.faces.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const Vec2& p = flattening.uv[flattening.piece.surface.faces[f][k]];
        uv[6 * source[f] + 2 * k] = p.x();
        uv[6 * source[f] + 2 * k + 1] = p.y();
      }
    }
  }
  nb::dict result;
  result["corner_uv"] = to_numpy(std::move(uv), {mesh.faces.size(), 3, 2});
  result["valid"] = flattening.valid;
  result["within"] = flattening.within;
  result["area_distortion"] = flattening.distortion.area;
  result["angular"] = flattening.distortion.angular;
  result["flipped"] = flattening.distortion.flipped;
  return result;
}

}  // namespace

void bind_flatten(nb::module_& m) {
  m.def("flatten", &flatten_mesh, nb::arg("positions"), nb::arg("faces"), nb::kw_only(),
        nb::arg("max_area_distortion") = 1.25, nb::arg("min_angular") = 0.95,
        nb::arg("polish") = true, nb::arg("angle_based") = true,
        "Flatten a connected mesh with boundary as one chart, without cutting it.");
}

}  // namespace partuv
