#pragma once

#include <cstdint>
#include <vector>

#include "partuv/context.hpp"
#include "partuv/surface.hpp"

namespace partuv {

/// How rough a surface is at the scale of its edges: the angle (rad) by which the bend at a typical
/// vertex differs from the bend at its neighbours. Below 0.01 for tessellated CAD and for smooth
/// shapes, about 0.03 to 0.06 for raw iso-surfaces and scans, 0.1 and above for white noise.
double estimate_noise(const Surface& surface);

/// Noise of a surface and of each of its components.
struct Noise {
  double whole = 0.0;
  std::vector<int32_t> component;  ///< per face, as from `label_components`
  std::vector<double> of_component;
};

Noise estimate_noise_by_component(const Surface& surface);

/// The strength of `denoise` that suits a noise: 0 where there is none to speak of, 2 for
/// raw iso-surfaces, 8 at most.
double strength_for_noise(double noise);

/// Positions after `strength` half-step Laplacian passes, in place of `surface.positions`. Creases
/// and boundaries are smoothed along themselves only, their corners stay.
std::vector<Vec3> denoise(const Surface& surface, double strength, const Context& context);

/// The same with the strength that suits the noise of each component. Components that need none are
/// untouched.
std::vector<Vec3> denoise_auto(const Surface& surface, const Noise& noise, const Context& context);

}  // namespace partuv
