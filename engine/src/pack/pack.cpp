#include "partuv/pack.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "pack/assign.hpp"
#include "pack/figures.hpp"
#include "pack/finish.hpp"
#include "pack/frame.hpp"
#include "pack/group.hpp"
#include "pack/outline.hpp"
#include "pack/spill.hpp"

namespace partuv {

namespace {

using namespace packing;
using Clock = std::chrono::steady_clock;

/// The charts of one tile.
struct Tile {
  std::vector<int> members;
  std::vector<Outline> outlines;
  std::vector<int32_t> parts;
  Layout layout;
  Layout finished;  ///< with gutters used up; may be hard to shrink
  double seconds = 0.0;
};

class Packer {
 public:
  Packer(const std::vector<PackChart>& charts, const PackOptions& options, const Context& context)
      : charts_(charts),
        options_(options),
        context_(context),
        outlines_(make_outlines(charts, context)) {
    plan_.cells = std::clamp(options.resolution, 256, 2048);
    plan_.rotations = options.rotations;
    plan_.effort = options.effort;
  }

  Result<Packing> run() {
    Packing packing;
    packing.placements.resize(charts_.size());
    if (charts_.empty()) return packing;
    std::vector<Tile> tiles;
    if (options_.texel_density > 0.0) {
      packing.grid_bits = grid_bits(most_tiles);
      set_frame(packing.grid_bits);
      const Clock::time_point start = Clock::now();
      const double scale = options_.texel_density * outlines_.unit;
      const Spill spilled = spill(outlines_.charts, frame_.bin, plan_, scale, context_);
      if (context_.cancelled()) return Failure{Error::cancelled, "packing"};
      if (!spilled.fits)
        return Failure{
            Error::invalid_option,
            "texel_density: a chart is larger than a tile, or too many tiles are needed"};
      tiles = split(spilled.tile, &spilled.layout);
      const std::chrono::duration<double> taken = Clock::now() - start;
      for (Tile& tile : tiles) tile.seconds = taken.count() / double(tiles.size());
    } else {
      const std::vector<int32_t> tile = assign();
      tiles = split(tile, nullptr);
      if (tiles.size() > static_cast<size_t>(most_tiles)) {
        return Failure{Error::invalid_option, "tiles: there are more than 100 parts"};
      }
      packing.grid_bits = grid_bits(static_cast<int>(tiles.size()));
      set_frame(packing.grid_bits);
      for (Tile& each : tiles) fill(each);
      level(tiles);
    }
    for (size_t i = 0; i < tiles.size(); ++i) {
      write(tiles[i], static_cast<int32_t>(i), packing);
      packing.efficiency += packing.tiles[i].efficiency / double(tiles.size());
    }
    return packing;
  }

 private:
  const std::vector<PackChart>& charts_;
  const PackOptions& options_;
  const Context& context_;
  const Outlines outlines_;
  TilePlan plan_;
  WrittenGrid grid_;
  Frame frame_;

  void set_frame(int bits) {
    grid_ = {options_.resolution, bits, merely_rounded(options_)};
    frame_ = make_frame(options_, rounding_texels(options_, bits));
  }

  std::vector<int32_t> assign() const {
    if (options_.tiles == 1) return std::vector<int32_t>(charts_.size(), 0);
    std::vector<double> area;
    for (const Outline& outline : outlines_.charts) area.push_back(outline.area);
    return assign_tiles(charts_, area, options_.tiles);
  }

  std::vector<Tile> split(const std::vector<int32_t>& tile, const Layout* layout) const {
    std::vector<Tile> tiles(1 + *std::max_element(tile.begin(), tile.end()));
    for (size_t i = 0; i < tile.size(); ++i) {
      Tile& to = tiles[tile[i]];
      to.members.push_back(static_cast<int>(i));
      to.outlines.push_back(outlines_.charts[i]);
      to.parts.push_back(charts_[i].part);
      if (layout) to.layout.poses.push_back(layout->poses[i]);
      if (layout) to.layout.scale = layout->scale;
    }
    return tiles;
  }

  void fill(Tile& tile) const {
    const Clock::time_point start = Clock::now();
    tile.layout = options_.group_by_part == Grouping::none
                      ? fill_tile(tile.outlines, frame_.bin, plan_, context_)
                      : fill_grouped(tile.outlines, tile.parts, frame_.bin, plan_,
                                     options_.group_by_part, context_);
    tile.finished = tile.layout;
    // Rectangles of parts, and charts about to be snapped, stay where they are.
    if (options_.group_by_part != Grouping::strict && !options_.snap_to_texels) {
      finish(tile.outlines, frame_, grid_.rounded ? make_frame(options_, 0.0) : frame_, grid_,
             tile.finished, context_);
    }
    tile.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  }

  /// Bring all tiles to the scale of the fullest one, so that texels are as dense everywhere.
  void level(std::vector<Tile>& tiles) const {
    constexpr double back = 0.995;
    double scale = INFINITY;
    double finished = INFINITY;
    for (const Tile& tile : tiles) {
      scale = std::min(scale, tile.layout.scale);
      finished = std::min(finished, tile.finished.scale);
    }
    if (level_at(finished, tiles)) return;
    while (!level_at(scale, tiles)) scale *= back;
  }

  bool level_at(double scale, std::vector<Tile>& tiles) const {
    std::vector<Layout> levelled;
    for (const Tile& tile : tiles) {
      const Layout& from = tile.layout.scale < scale ? tile.finished : tile.layout;
      levelled.push_back(lowered(tile.outlines, frame_.bin, plan_, from, scale, context_));
      if (levelled.back().scale <= 0.0) return false;
    }
    for (size_t i = 0; i < tiles.size(); ++i) tiles[i].layout = std::move(levelled[i]);
    return true;
  }

  void write(Tile& tile, int32_t number, Packing& packing) const {
    const double texel = 1.0 / options_.resolution;
    if (options_.snap_to_texels) snap_to_texels(tile.outlines, frame_.inset, tile.layout);
    for (size_t i = 0; i < tile.members.size(); ++i) {
      const int chart = tile.members[i];
      const Pose& pose = tile.layout.poses[i];
      Placement& placement = packing.placements[chart];
      placement.rotation_rad = pose.rotation_rad;
      placement.scale = tile.layout.scale / outlines_.unit * texel * charts_[chart].weight;
      placement.offset = (pose.centre.array() + frame_.inset) * texel;
      placement.offset -= Turn(pose.rotation_rad, placement.scale)(tile.outlines[i].centre);
      placement.tile = number;
    }
    TileFigures figures = measure_tile(tile.outlines, tile.layout, frame_, options_, grid_);
    figures.seconds = tile.seconds;
    packing.tiles.push_back(figures);
  }
};

bool within(double value, double low, double high) { return value >= low && value <= high; }

}  // namespace

Result<bool> check_pack_options(const PackOptions& o) {
  auto wrong = [](const char* name) { return Failure{Error::invalid_option, name}; };
  if (o.resolution < 16 || o.resolution > 65536) return wrong("resolution");
  const double most = 0.25 * o.resolution;
  if (!within(o.gutter_texels, 0.0, most)) return wrong("gutter_texels");
  if (!(o.border_texels <= most)) return wrong("border_texels");
  if (o.mip_levels < 0 || o.mip_levels > 16) return wrong("mip_levels");
  const Frame frame = make_frame(o, rounding_texels(o, 24));
  if (frame.bin.gutter > most + 2.0 || frame.bin.side < most) return wrong("mip_levels");
  if (o.rotations < 1 || o.rotations > 64) return wrong("rotations");
  if (!within(o.texel_density, 0.0, 1e9)) return wrong("texel_density");
  if (o.tiles < 0 || o.tiles > most_tiles) return wrong("tiles");
  if (!within(o.effort, 0.0, 1e6)) return wrong("effort");
  if (!within(o.rounding_steps, 0.0, 16.0)) return wrong("rounding_steps");
  if (o.texel_density > 0.0 && o.tiles != 1) return wrong("texel_density with tiles");
  if (o.group_by_part != Grouping::none) {
    if (o.texel_density > 0.0) return wrong("texel_density with group_by_part");
    if (o.tiles == 0) return wrong("tiles per part with group_by_part");
  }
  return true;
}

Result<Packing> pack(const std::vector<PackChart>& charts, const PackOptions& options,
                     const Context& context) {
  if (const Result<bool> fine = check_pack_options(options); !fine) return fine.failure();
  for (const PackChart& chart : charts) {
    if (!within(chart.weight, 1e-6, 1e6)) return Failure{Error::invalid_option, "weight"};
  }
  return Packer(charts, options, context).run();
}

}  // namespace partuv
