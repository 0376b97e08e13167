#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <optional>
#include <string>

#include "arrays.hpp"
#include "bindings.hpp"
#include "partuv/denoise.hpp"
#include "partuv/lift.hpp"
#include "partuv/simplify.hpp"
#include "partuv/topology.hpp"
#include "raise.hpp"

namespace nb = nanobind;

namespace partuv {
namespace {

using IndexArray = nb::ndarray<const int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using IndexResult = nb::ndarray<nb::numpy, int32_t>;

Topology make_topology(const PositionArray& positions, const FaceArray& faces, bool canonical) {
  const Mesh mesh = to_mesh(positions, faces);
  std::optional<Result<Topology>> topology;
  {
    nb::gil_scoped_release release;
    topology.emplace(
        build_topology(mesh, Context(), canonical ? Numbering::canonical : Numbering::of_mesh));
  }
  if (!*topology) raise(topology->failure());
  return std::move(topology->value());
}

IndexResult index_array(const std::vector<int32_t>& values) {
  return to_numpy(std::vector<int32_t>(values), {values.size()});
}

IndexResult triangle_array(const std::vector<Triangle>& triangles) {
  std::vector<int32_t> flat;
  flat.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) flat.insert(flat.end(), t.begin(), t.end());
  return to_numpy(std::move(flat), {triangles.size(), 3});
}

nb::ndarray<nb::numpy, double> position_array(const Surface& surface) {
  std::vector<double> flat;
  flat.reserve(3 * surface.positions.size());
  for (const Vec3& p : surface.positions) flat.insert(flat.end(), p.data(), p.data() + 3);
  return to_numpy(std::move(flat), {surface.positions.size(), 3});
}

std::vector<int32_t> checked_indices(const IndexArray& values, int count, int below,
                                     const char* what) {
  if (static_cast<int>(values.shape(0)) != count) raise({Error::invalid_option, what});
  std::vector<int32_t> result(values.data(), values.data() + values.shape(0));
  for (const int32_t value : result) {
    if (value < 0 || value >= below) raise({Error::invalid_option, what});
  }
  return result;
}

Topology denoised(const Topology& topology, std::optional<double> strength,
                  const Context* context) {
  const Context unbounded;
  nb::gil_scoped_release release;
  Topology result = topology;
  result.surface.positions =
      strength ? denoise(topology.surface, *strength, context ? *context : unbounded)
               : denoise_auto(topology.surface, estimate_noise_by_component(topology.surface),
                              context ? *context : unbounded);
  return result;
}

Proxy simplified(const Topology& topology, int target_faces, double max_error,
                 const Context* context) {
  const Context unbounded;
  nb::gil_scoped_release release;
  SimplifyOptions options;
  options.target_faces = target_faces;
  options.max_error = max_error;
  return simplify(topology.surface, options, context ? *context : unbounded);
}

IndexResult lifted(const Topology& topology, const Proxy& proxy, const IndexArray& labels,
                   double band_edges, const Context* context) {
  const int proxy_faces = proxy.surface.face_count();
  const std::vector<int32_t> coarse = checked_indices(labels, proxy_faces, proxy_faces, "labels");
  if (static_cast<int>(proxy.proxy_of_face.size()) != topology.surface.face_count()) {
    raise({Error::invalid_option, "proxy"});
  }
  const Context unbounded;
  std::vector<int32_t> fine;
  {
    nb::gil_scoped_release release;
    const Context& used = context ? *context : unbounded;
    const SideWeights weights =
        weigh_sides(topology.surface, estimate_noise(topology.surface), used);
    fine = lift_labels(topology.surface, weights, proxy, coarse, LiftOptions{band_edges}, used);
  }
  const size_t count = fine.size();
  return to_numpy(std::move(fine), {count});
}

}  // namespace

void bind_mesh(nb::module_& m) {
  nb::class_<Proxy>(m, "Proxy", "A coarse stand-in for a surface, with the way back to it.")
      .def_prop_ro(
          "positions", [](const Proxy& p) { return position_array(p.surface); },
          nb::rv_policy::move)
      .def_prop_ro(
          "faces", [](const Proxy& p) { return triangle_array(p.surface.faces); },
          nb::rv_policy::move)
      .def_prop_ro(
          "opposite", [](const Proxy& p) { return triangle_array(p.surface.opposite); },
          nb::rv_policy::move)
      .def_prop_ro(
          "proxy_of_face", [](const Proxy& p) { return index_array(p.proxy_of_face); },
          nb::rv_policy::move, "proxy face of each face of the source");

  nb::class_<Topology>(m, "Surface",
                       "A mesh welded into an oriented manifold of unit area about the origin. "
                       "Faces that repeat a welded point are left out: see source_face.")
      .def(
          "__init__",
          [](Topology* self, const PositionArray& positions, const FaceArray& faces,
             bool canonical) { new (self) Topology(make_topology(positions, faces, canonical)); },
          nb::arg("positions"), nb::arg("faces"), nb::arg("canonical") = false,
          "canonical: number and place it as an unwrap does, however it is numbered and lies.")
      .def_prop_ro("face_count", [](const Topology& t) { return t.surface.face_count(); })
      .def_prop_ro(
          "source_face", [](const Topology& t) { return index_array(t.source_face); },
          nb::rv_policy::move, "For each face of the surface, the face of the mesh it is.")
      .def_prop_ro(
          "positions", [](const Topology& t) { return position_array(t.surface); },
          nb::rv_policy::move)
      .def_prop_ro(
          "faces", [](const Topology& t) { return triangle_array(t.surface.faces); },
          nb::rv_policy::move)
      .def_prop_ro(
          "opposite", [](const Topology& t) { return triangle_array(t.surface.opposite); },
          nb::rv_policy::move,
          "F x 3: the half-edge 3 * face + side on the other side, -1 at a boundary")
      .def(
          "noise", [](const Topology& t) { return estimate_noise(t.surface); },
          nb::call_guard<nb::gil_scoped_release>(),
          "Angle (rad) by which the bend at a typical vertex differs from its neighbours'.")
      .def("denoised", &denoised, nb::arg("strength"), nb::arg("context") = nb::none(),
           "The surface after `strength` half-step Laplacian passes; None: as many as it needs.")
      .def("simplified", &simplified, nb::arg("target_faces"), nb::arg("max_error"),
           nb::arg("context") = nb::none(),
           "A proxy of the same topology with about `target_faces` faces.")
      .def("lift", &lifted, nb::arg("proxy"), nb::arg("labels"), nb::arg("band_edges"),
           nb::arg("context") = nb::none(),
           "Labels per face from labels per proxy face, with straight boundaries.");
}

}  // namespace partuv
