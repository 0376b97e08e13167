#include "partuv/pack.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "partuv/repack.hpp"
#include "raise.hpp"

namespace nb = nanobind;

namespace partuv {

nb::dict tile_table(const std::vector<TileFigures>& tiles) {
  const size_t n = tiles.size();
  std::vector<int32_t> charts(n);
  std::vector<double> efficiency(n), covered(n), gutter(n), seconds(n);
  for (size_t t = 0; t < n; ++t) {
    charts[t] = tiles[t].charts;
    efficiency[t] = tiles[t].efficiency;
    covered[t] = tiles[t].covered_texels;
    gutter[t] = tiles[t].gutter_texels;
    seconds[t] = tiles[t].seconds;
  }
  nb::dict table;
  table["charts"] = to_numpy(std::move(charts), {n});
  table["efficiency"] = to_numpy(std::move(efficiency), {n});
  table["covered_texels"] = to_numpy(std::move(covered), {n});
  table["gutter_texels"] = to_numpy(std::move(gutter), {n});
  table["seconds"] = to_numpy(std::move(seconds), {n});
  return table;
}

namespace {

using PointArray = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using LabelArray = nb::ndarray<const int32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using WeightArray = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

template <typename Array>
auto to_vector(const Array& array) {
  return std::vector<std::remove_const_t<typename Array::Scalar>>(array.data(),
                                                                  array.data() + array.size());
}

Repacked repack_arrays(const PointArray& uv, const FaceArray& faces, const LabelArray& chart,
                       const PackOptions& options, const Context& context,
                       const std::optional<LabelArray>& part,
                       const std::optional<WeightArray>& weight) {
  FlatMesh mesh;
  for (size_t i = 0; i < uv.shape(0); ++i) mesh.uv.emplace_back(uv(i, 0), uv(i, 1));
  for (size_t f = 0; f < faces.shape(0); ++f) {
    mesh.faces.push_back({faces(f, 0), faces(f, 1), faces(f, 2)});
  }
  mesh.chart = to_vector(chart);
  if (part) mesh.part = to_vector(*part);
  if (weight) mesh.weight = to_vector(*weight);
  std::optional<Result<Repacked>> result;
  {
    nb::gil_scoped_release release;
    result.emplace(repack(mesh, options, context));
  }
  if (!*result) raise(result->failure());
  return std::move(result->value());
}

/// One number of every placement.
template <typename T, typename Get>
auto per_chart(const Repacked& repacked, Get&& get) {
  std::vector<T> values;
  for (const Placement& placement : repacked.packing.placements) values.push_back(get(placement));
  const size_t n = values.size();
  return to_numpy(std::move(values), {n});
}

}  // namespace

void bind_pack(nb::module_& m) {
  nb::enum_<Grouping>(m, "Grouping", "How charts of one part lie to each other.")
      .value("none", Grouping::none)
      .value("near", Grouping::near)
      .value("strict", Grouping::strict);
  nb::class_<PackOptions>(m, "PackOptions", "Options of a packing; see partuv/pack.hpp.")
      .def(nb::init<>())
      .def_rw("resolution", &PackOptions::resolution)
      .def_rw("gutter_texels", &PackOptions::gutter_texels)
      .def_rw("border_texels", &PackOptions::border_texels)
      .def_rw("mip_levels", &PackOptions::mip_levels)
      .def_rw("snap_to_texels", &PackOptions::snap_to_texels)
      .def_rw("rotations", &PackOptions::rotations)
      .def_rw("texel_density", &PackOptions::texel_density)
      .def_rw("group_by_part", &PackOptions::group_by_part)
      .def_rw("tiles", &PackOptions::tiles)
      .def_rw("effort", &PackOptions::effort);
  nb::class_<Repacked>(m, "Packed", "Charts in their places.")
      .def_prop_ro(
          "corner_uv",
          [](const Repacked& r) {
            return to_numpy(std::vector<float>(r.corner_uv), {r.corner_uv.size() / 6, 3, 2});
          },
          nb::rv_policy::move, "F x 3 x 2, V up, in the unit square of each face's tile")
      .def_prop_ro(
          "tile",
          [](const Repacked& r) {
            return per_chart<int32_t>(r, [](const Placement& p) { return p.tile; });
          },
          nb::rv_policy::move, "tile of each chart")
      .def_prop_ro(
          "rotation_rad",
          [](const Repacked& r) {
            return per_chart<double>(r, [](const Placement& p) { return p.rotation_rad; });
          },
          nb::rv_policy::move, "turn of each chart")
      .def_prop_ro(
          "scale",
          [](const Repacked& r) {
            return per_chart<double>(r, [](const Placement& p) { return p.scale; });
          },
          nb::rv_policy::move, "size of each chart in its tile, relative to the given one")
      .def_prop_ro(
          "tiles", [](const Repacked& r) { return tile_table(r.packing.tiles); },
          "dict of arrays: charts, efficiency, covered_texels, gutter_texels, seconds")
      .def_prop_ro("efficiency", [](const Repacked& r) { return r.packing.efficiency; });
  m.def("pack", &repack_arrays, nb::arg("uv"), nb::arg("faces"), nb::arg("chart"),
        nb::arg("options"), nb::arg("context"), nb::kw_only(), nb::arg("part") = nb::none(),
        nb::arg("weight") = nb::none(),
        "Pack given charts: uv N x 2 float64, faces F x 3 int32, chart F int32; part int32 and\n"
        "weight float64 per chart.");
}

}  // namespace partuv
