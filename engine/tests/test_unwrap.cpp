// Whole unwraps, to be run under the sanitizers: odd meshes, two threads, cancelled at any time.
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include "check.hpp"
#include "partuv/unwrap.hpp"
#include "shapes.hpp"

namespace partuv::test {
namespace {

std::vector<Mesh> meshes() {
  std::mt19937 random(2);
  std::vector<Mesh> all{sphere(3), torus(24, 12), pierced_plate(2), sheet(16, 16), tube(24, 3)};
  Mesh rough = sphere(3);
  shake(rough, 0.05, random);
  all.push_back(std::move(rough));
  all.push_back(soup(40, 300, random));
  all.push_back(soup(2000, 600, random));
  return all;
}

bool is_complete(const Mesh& mesh, const Atlas& atlas) {
  if (atlas.chart.size() != mesh.faces.size()) return false;
  if (atlas.corner_uv.size() != 6 * mesh.faces.size()) return false;
  for (const float x : atlas.corner_uv) {
    if (!(x >= 0.0f && x <= 1.0f)) return false;
  }
  std::vector<int32_t> count(atlas.charts.size(), 0);
  for (const int c : atlas.chart) {
    if (c < 0 || c >= static_cast<int>(atlas.charts.size())) return false;
    ++count[c];
  }
  // No face is in two charts: each has as many faces as it says.
  for (size_t c = 0; c < count.size(); ++c) {
    if (count[c] != atlas.charts[c].face_count) return false;
  }
  return true;
}

void test_threads(const Mesh& mesh) {
  Context one(1), two(2);
  Options options;
  options.effort = 0.1;
  const Result<Atlas> a = unwrap(mesh, {}, options, one), b = unwrap(mesh, {}, options, two);
  CHECK(a && b);
  if (!a || !b) return;
  CHECK(is_complete(mesh, a.value()));
  CHECK(a.value().corner_uv == b.value().corner_uv);
  CHECK(a.value().chart == b.value().chart);
}

/// Cancel after a while, from another thread; a deadline may come first.
void test_interruption(const Mesh& mesh, double cancel_after_s, double deadline_s) {
  Context context(2, deadline_s);
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::duration<double>(cancel_after_s));
    context.cancel();
  });
  const Result<Atlas> atlas = unwrap(mesh, {}, {}, context);
  other.join();
  if (atlas) {
    CHECK(is_complete(mesh, atlas.value()));
  } else {
    CHECK(atlas.failure().error == Error::cancelled);
  }
}

void test_options(const Mesh& mesh) {
  for (const Profile profile : {Profile::balanced, Profile::conformal}) {
    for (const Flattener flattening : {Flattener::abf, Flattener::lscm}) {
      Options options;
      options.effort = 0.1;
      options.profile = profile;
      options.flattening = flattening;
      options.max_area_distortion = flattening == Flattener::abf ? 1.1 : 3.0;
      options.denoise = profile == Profile::balanced ? 2.0 : 0.0;
      Context context(2);
      const Result<Atlas> atlas = unwrap(mesh, {}, options, context);
      CHECK(atlas && is_complete(mesh, atlas.value()));
    }
  }
}

void test_refusals() {
  const double nan = std::nan("");
  Mesh broken = sheet(2, 2);
  broken.positions[4].x() = nan;
  Context context;
  CHECK(unwrap(broken, {}, {}, context).failure().error == Error::non_finite_position);
  broken = sheet(2, 2);
  broken.faces[1][0] = 9;
  CHECK(unwrap(broken, {}, {}, context).failure().error == Error::index_out_of_range);
  CHECK(unwrap(Mesh{}, {}, {}, context).failure().error == Error::empty_mesh);
}

}  // namespace
}  // namespace partuv::test

int main() {
  using namespace partuv::test;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> log_seconds(std::log(1e-4), std::log(2.0));
  for (const partuv::Mesh& mesh : meshes()) {
    test_threads(mesh);
    for (int round = 0; round < 4; ++round) {
      const double cancel_after_s = std::exp(log_seconds(random));
      test_interruption(mesh, cancel_after_s, round % 2 == 0 ? 1e9 : std::exp(log_seconds(random)));
    }
  }
  test_options(meshes().front());
  test_refusals();
  return failures;
}
