#include "partuv/unwrap.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "arrays.hpp"
#include "bindings.hpp"
#include "raise.hpp"

namespace nb = nanobind;

namespace partuv {
namespace {

/// One array per figure, a row per chart.
nb::dict chart_table(const std::vector<ChartFigures>& charts) {
  const size_t n = charts.size();
  std::vector<int32_t> faces(n), part(n), tile(n);
  std::vector<double> area(n), distortion(n), angular(n);
  for (size_t c = 0; c < n; ++c) {
    faces[c] = charts[c].face_count;
    part[c] = charts[c].part;
    tile[c] = charts[c].tile;
    area[c] = charts[c].area_3d;
    distortion[c] = charts[c].area_distortion;
    angular[c] = charts[c].angular;
  }
  nb::dict table;
  table["faces"] = to_numpy(std::move(faces), {n});
  table["part"] = to_numpy(std::move(part), {n});
  table["tile"] = to_numpy(std::move(tile), {n});
  table["area_3d"] = to_numpy(std::move(area), {n});
  table["area_distortion"] = to_numpy(std::move(distortion), {n});
  table["angular"] = to_numpy(std::move(angular), {n});
  return table;
}

template <std::vector<int32_t> Atlas::* Field>
nb::ndarray<nb::numpy, int32_t> per_face(const Atlas& atlas) {
  return to_numpy(std::vector<int32_t>(atlas.*Field), {(atlas.*Field).size()});
}

Atlas unwrap_mesh(const PositionArray& positions, const FaceArray& faces, const Options& options,
                  Context& context, const std::optional<FeatureArray>& features,
                  const PartTree* tree, const Ablation& ablation) {
  const Mesh mesh = to_mesh(positions, faces);
  PartPrior prior;
  if (features) {
    prior.dimensions = static_cast<int>(features->shape(1));
    prior.features.assign(features->data(), features->data() + features->size());
  }
  if (tree != nullptr) prior.tree = *tree;
  std::optional<Result<Atlas>> result;
  {
    nb::gil_scoped_release release;
    result.emplace(unwrap(mesh, prior, options, context, ablation));
  }
  if (!*result) raise(result->failure());
  return std::move(result->value());
}

}  // namespace

void bind_unwrap(nb::module_& m) {
  nb::enum_<Profile>(m, "Profile", "What a chart may cost.")
      .value("balanced", Profile::balanced)
      .value("conformal", Profile::conformal);
  nb::enum_<Flattener>(m, "Flattener", "How a chart is first flattened.")
      .value("abf", Flattener::abf)
      .value("lscm", Flattener::lscm);
  nb::class_<TexelWeights>(m, "TexelWeights", "Texel densities relative to others.")
      .def_rw("face", &TexelWeights::face)
      .def_rw("part", &TexelWeights::part);
  nb::enum_<Quality>(m, "Quality", "How much work an atlas may take.")
      .value("fast", Quality::fast)
      .value("standard", Quality::standard)
      .value("best", Quality::best);
  nb::class_<Options, PackOptions>(m, "Options", "Options of one unwrap; see partuv/options.hpp.")
      .def(nb::init<>())
      .def_rw("max_area_distortion", &Options::max_area_distortion)
      .def_rw("min_angular", &Options::min_angular)
      .def_rw("profile", &Options::profile)
      .def_rw("flattening", &Options::flattening)
      .def_rw("quality", &Options::quality)
      .def_rw("denoise", &Options::denoise)
      .def_rw("cut_below_efficiency", &Options::cut_below_efficiency)
      .def_rw("parts", &Options::parts)
      .def_rw("texel_weights", &Options::texel_weights);
  nb::class_<Ablation>(m, "Ablation", "Steps of an unwrap to leave out; see partuv/ablation.hpp.")
      .def(nb::init<>())
      .def_rw("proxy", &Ablation::proxy)
      .def_rw("merge_heuristic", &Ablation::merge_heuristic)
      .def_rw("recursion", &Ablation::recursion)
      .def_rw("final_merge", &Ablation::final_merge)
      .def_rw("cut_open", &Ablation::cut_open)
      .def_rw("polish", &Ablation::polish)
      .def_rw("fixed_parts", &Ablation::fixed_parts);
  nb::class_<Atlas>(m, "Atlas", "UVs, charts and figures of an unwrapped mesh.")
      .def_prop_ro(
          "corner_uv",
          [](const Atlas& a) {
            return to_numpy(std::vector<float>(a.corner_uv), {a.chart.size(), 3, 2});
          },
          nb::rv_policy::move, "F x 3 x 2, V up, in the unit square, multiples of 2^-24")
      .def_prop_ro("chart", per_face<&Atlas::chart>, nb::rv_policy::move, "chart of each face")
      .def_prop_ro("part", per_face<&Atlas::part>, nb::rv_policy::move, "part of each face")
      .def_prop_ro("tile", per_face<&Atlas::tile>, nb::rv_policy::move, "tile of each face")
      .def_prop_ro(
          "charts", [](const Atlas& a) { return chart_table(a.charts); },
          "dict of arrays: faces, part, tile, area_3d, area_distortion, angular")
      .def_prop_ro(
          "tiles", [](const Atlas& a) { return tile_table(a.tiles); },
          "dict of arrays: charts, efficiency, covered_texels, gutter_texels, seconds")
      .def_ro("part_count", &Atlas::part_count)
      .def_ro("efficiency", &Atlas::efficiency)
      .def_ro("noise", &Atlas::noise)
      .def_ro("proxy_faces", &Atlas::proxy_faces)
      .def_ro("searched_charts", &Atlas::searched_charts)
      .def_ro("stage_seconds", &Atlas::stage_seconds);
  m.def("unwrap", &unwrap_mesh, nb::arg("positions"), nb::arg("faces"), nb::arg("options"),
        nb::arg("context"), nb::kw_only(), nb::arg("features") = nb::none(),
        nb::arg("tree") = nb::none(), nb::arg("ablation") = Ablation{},
        "Unwrap a mesh: positions V x 3 float64, faces F x 3 int32. The part tree is the built-in "
        "one,\n"
        "or comes from features (F x d float32), or is given (over the faces).");
}

}  // namespace partuv
