#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "partuv/types.hpp"

namespace partuv {

using PositionArray = nanobind::ndarray<const double, nanobind::shape<-1, 3>, nanobind::c_contig,
                                        nanobind::device::cpu>;
using FaceArray = nanobind::ndarray<const int32_t, nanobind::shape<-1, 3>, nanobind::c_contig,
                                    nanobind::device::cpu>;

using FeatureArray = nanobind::ndarray<const float, nanobind::shape<-1, -1>, nanobind::c_contig,
                                       nanobind::device::cpu>;

inline Mesh to_mesh(const PositionArray& positions, const FaceArray& faces) {
  Mesh mesh;
  mesh.positions.resize(positions.shape(0));
  mesh.faces.resize(faces.shape(0));
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    mesh.positions[i] = Vec3(positions(i, 0), positions(i, 1), positions(i, 2));
  }
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    mesh.faces[f] = {faces(f, 0), faces(f, 1), faces(f, 2)};
  }
  return mesh;
}

/// A numpy array that owns a vector, of the given shape.
template <typename T>
nanobind::ndarray<nanobind::numpy, T> to_numpy(std::vector<T> data,
                                               std::initializer_list<size_t> shape) {
  auto* owned = new std::vector<T>(std::move(data));
  nanobind::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nanobind::ndarray<nanobind::numpy, T>(owned->data(), shape, owner);
}

}  // namespace partuv
