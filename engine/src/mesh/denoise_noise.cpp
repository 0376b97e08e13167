#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "partuv/denoise.hpp"

namespace partuv {
namespace {

/// Call body(from, to) for every edge in both directions.
template <typename Body>
void each_directed_edge(const Surface& surface, Body&& body) {
  for (int f = 0; f < surface.face_count(); ++f) {
    for (int s = 0; s < 3; ++s) {
      const int a = surface.faces[f][s], b = surface.faces[f][(s + 1) % 3];
      body(a, b);
      if (surface.opposite[f][s] < 0) body(b, a);
    }
  }
}

struct Sample {
  double value, area;
};

double weighted_median(std::vector<Sample>& samples) {
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.value < b.value; });
  double total = 0.0, seen = 0.0;
  for (const Sample& sample : samples) total += sample.area;
  for (const Sample& sample : samples) {
    seen += sample.area;
    if (seen >= 0.5 * total) return sample.value;
  }
  return 0.0;
}

/// Roughness at each vertex, negative where none can be told (boundary), and the area around it.
void vertex_roughness(const Surface& surface, std::vector<double>& roughness,
                      std::vector<double>& area) {
  const int vertices = surface.vertex_count(), faces = surface.face_count();
  std::vector<Vec3> face_normal(faces), normal(vertices, Vec3::Zero());
  area.assign(vertices, 0.0);
  for (int f = 0; f < faces; ++f) {
    const Vec3 cross = face_cross(surface, f);
    face_normal[f] = cross.stableNormalized();
    for (const int v : surface.faces[f]) {
      normal[v] += cross;
      area[v] += cross.norm();
    }
  }
  for (Vec3& n : normal) n = n.stableNormalized();

  // Mean curvature of the best osculating paraboloid: height over squared distance.
  std::vector<double> height(vertices, 0.0), squared(vertices, 0.0), length(vertices, 0.0);
  std::vector<int32_t> edges(vertices, 0);
  each_directed_edge(surface, [&](int a, int b) {
    const Vec3 d = surface.positions[b] - surface.positions[a];
    height[a] += d.dot(normal[a]);
    squared[a] += d.squaredNorm();
    length[a] += d.norm();
    ++edges[a];
  });
  std::vector<double> bend(vertices, 0.0), mean_bend(vertices, 0.0);
  for (int v = 0; v < vertices; ++v) {
    if (squared[v] > 0.0) bend[v] = 2.0 * height[v] / squared[v];
  }
  each_directed_edge(surface, [&](int a, int b) { mean_bend[a] += bend[b] / edges[a]; });

  // Around a vertex on a crease the flattest edge tells: on CAD there is one inside a face.
  std::vector<double> flattest(vertices, std::numeric_limits<double>::infinity());
  std::vector<double> steepest(vertices, 0.0);
  std::vector<uint8_t> on_boundary(vertices, 0);
  for (int f = 0; f < faces; ++f) {
    for (int s = 0; s < 3; ++s) {
      const int h = surface.opposite[f][s];
      if (h > 3 * f + s) continue;  // the other side tells
      const double angle =
          h < 0
              ? 0.0
              : 2.0 * std::asin(std::min(1.0, 0.5 * (face_normal[f] - face_normal[h / 3]).norm()));
      for (const int v : {surface.faces[f][s], surface.faces[f][(s + 1) % 3]}) {
        if (h < 0) on_boundary[v] = 1;
        flattest[v] = std::min(flattest[v], angle);
        steepest[v] = std::max(steepest[v], angle);
      }
    }
  }
  constexpr double crease_angle = 0.6;
  roughness.assign(vertices, -1.0);
  for (int v = 0; v < vertices; ++v) {
    if (on_boundary[v] || edges[v] == 0) continue;
    // Noise bends a vertex, and otherwise than its neighbours; a flat or evenly bent one has none.
    double value = std::min(std::abs(bend[v] - mean_bend[v]), std::abs(bend[v]));
    value *= length[v] / edges[v];
    roughness[v] = steepest[v] < crease_angle ? value : std::min(value, flattest[v]);
  }
}

/// Call visit(face, sample) once for every vertex that tells of noise, with its first face.
template <typename Visit>
void each_sample(const Surface& surface, Visit&& visit) {
  std::vector<double> roughness, area;
  vertex_roughness(surface, roughness, area);
  std::vector<uint8_t> done(surface.vertex_count(), 0);
  for (int f = 0; f < surface.face_count(); ++f) {
    for (const int v : surface.faces[f]) {
      if (done[v] || roughness[v] < 0.0) continue;
      done[v] = 1;
      visit(f, Sample{roughness[v], area[v]});
    }
  }
}

double noise_of(std::vector<Sample>& samples, int faces) {
  // In few faces every bend is their shape.
  constexpr double coarse_faces = 500.0, fine_faces = 2500.0;
  const double trust = (faces - coarse_faces) / (fine_faces - coarse_faces);
  return trust > 0.0 ? std::min(1.0, trust) * weighted_median(samples) : 0.0;
}

}  // namespace

double estimate_noise(const Surface& surface) {
  std::vector<Sample> samples;
  each_sample(surface, [&](int, const Sample& sample) { samples.push_back(sample); });
  return noise_of(samples, surface.face_count());
}

Noise estimate_noise_by_component(const Surface& surface) {
  Noise noise;
  const int components = label_components(surface, noise.component);
  std::vector<Sample> all;
  std::vector<std::vector<Sample>> samples(components);
  each_sample(surface, [&](int f, const Sample& sample) {
    samples[noise.component[f]].push_back(sample);
    if (components > 1) all.push_back(sample);
  });
  std::vector<int32_t> faces(components, 0);
  for (const int32_t c : noise.component) ++faces[c];
  for (int c = 0; c < components; ++c) {
    noise.of_component.push_back(noise_of(samples[c], faces[c]));
  }
  noise.whole = components == 1 ? noise.of_component[0] : noise_of(all, surface.face_count());
  return noise;
}

double strength_for_noise(double noise) {
  // Clean shapes measure up to 0.02, raw iso-surfaces of image-to-3D models 0.02 to 0.05; up to two
  // passes do for those, white noise takes more.
  constexpr double clean = 0.02, none = 0.012, iso_surface = 0.05, passes_there = 2.0;
  constexpr double passes_per_noise = 60.0, most = 8.0;
  if (noise < clean) return 0.0;
  const double mild = passes_there * std::min((noise - none) / (iso_surface - none), 1.0);
  return std::min(most, mild + passes_per_noise * std::max(0.0, noise - iso_surface));
}

}  // namespace partuv
