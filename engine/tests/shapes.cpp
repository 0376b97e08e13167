#include "shapes.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "partuv/topology.hpp"

namespace partuv::test {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Two triangles for every cell of a grid; `number` gives the vertex at (row, column).
template <typename Number>
void fill_cells(int rows, int columns, const Number& number, Mesh& mesh) {
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1),
                d = number(i, j + 1);
      mesh.faces.push_back({a, b, c});
      mesh.faces.push_back({a, c, d});
    }
  }
}

}  // namespace

Mesh sheet(int rows, int columns) {
  Mesh mesh;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j <= columns; ++j) {
      mesh.positions.emplace_back(static_cast<double>(i) / rows, static_cast<double>(j) / columns,
                                  0.0);
    }
  }
  fill_cells(rows, columns, [&](int i, int j) { return i * (columns + 1) + j; }, mesh);
  return mesh;
}

Mesh sheet_with_hole() {
  Mesh mesh = sheet(5, 5);
  const auto middle = mesh.faces.begin() + 2 * (2 * 5 + 2);
  mesh.faces.erase(middle, middle + 2);
  return mesh;
}

Mesh tube(int around, int along) {
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j <= along; ++j) {
      const double turn = two_pi * i / around;
      mesh.positions.emplace_back(std::cos(turn), std::sin(turn), 2.0 * j / along);
    }
  }
  fill_cells(around, along, [&](int i, int j) { return i % around * (along + 1) + j; }, mesh);
  return mesh;
}

Mesh torus(int around, int along) {
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double turn = two_pi * i / around, tilt = two_pi * j / along;
      const double reach = 1.0 + 0.4 * std::cos(tilt);
      mesh.positions.emplace_back(reach * std::cos(turn), reach * std::sin(turn),
                                  0.4 * std::sin(tilt));
    }
  }
  fill_cells(around, along, [&](int i, int j) { return i % around * along + j % along; }, mesh);
  return mesh;
}

Mesh pierced_plate(int holes) {
  std::set<std::array<int, 3>> filled;
  for (int x = 0; x < 2 * holes + 1; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x % 2 == 0 || y != 1) filled.insert({x, y, 0});
    }
  }
  Mesh mesh;
  std::map<std::array<int, 3>, int32_t> number;
  auto vertex = [&](const std::array<int, 3>& p) {
    const auto [it, added] = number.try_emplace(p, static_cast<int32_t>(number.size()));
    if (added) mesh.positions.emplace_back(p[0], p[1], p[2]);
    return it->second;
  };
  for (const auto& cell : filled) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int out = 0; out < 2; ++out) {
        std::array<int, 3> neighbour = cell;
        neighbour[axis] += out ? 1 : -1;
        if (filled.contains(neighbour)) continue;
        std::array<int, 3> corner = cell;
        corner[axis] += out;
        int32_t v[4];
        for (int k = 0; k < 4; ++k) {
          std::array<int, 3> p = corner;
          p[(axis + 1) % 3] += k == 1 || k == 2;
          p[(axis + 2) % 3] += k >= 2;
          v[k] = vertex(p);
        }
        if (!out) std::swap(v[1], v[3]);
        mesh.faces.push_back({v[0], v[1], v[2]});
        mesh.faces.push_back({v[0], v[2], v[3]});
      }
    }
  }
  return mesh;
}

Mesh sphere(int levels) {
  Mesh mesh;
  mesh.positions = {Vec3(1, 0, 0),  Vec3(0, 1, 0),  Vec3(0, 0, 1),
                    Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
  mesh.faces = {{0, 1, 2}, {1, 3, 2}, {3, 4, 2}, {4, 0, 2},
                {1, 0, 5}, {3, 1, 5}, {4, 3, 5}, {0, 4, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int32_t, int32_t>, int32_t> middle;
    auto split = [&](int32_t a, int32_t b) {
      const auto [it, added] =
          middle.try_emplace(std::minmax(a, b), static_cast<int32_t>(mesh.positions.size()));
      if (added) {
        const Vec3 p = mesh.positions[a] + mesh.positions[b];
        mesh.positions.push_back(p.normalized());
      }
      return it->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.faces) {
      const int32_t ab = split(a, b), bc = split(b, c), ca = split(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.faces = std::move(finer);
  }
  return mesh;
}

Mesh soup(int points, int faces, std::mt19937& random) {
  Mesh mesh;
  mesh.positions.assign(points, Vec3::Zero());
  shake(mesh, 1.0, random);
  std::uniform_int_distribution<int32_t> any(0, points - 1);
  for (int f = 0; f < faces; ++f) mesh.faces.push_back({any(random), any(random), any(random)});
  return mesh;
}

void shake(Mesh& mesh, double amount, std::mt19937& random) {
  std::normal_distribution<double> deviate(0.0, amount);
  for (Vec3& p : mesh.positions) {
    for (int k = 0; k < 3; ++k) p[k] += deviate(random);
  }
}

Surface surface_of(const Mesh& mesh) { return build_topology(mesh).value().surface; }

Piece whole_piece(const Surface& surface) {
  std::vector<int32_t> all(surface.faces.size());
  std::iota(all.begin(), all.end(), 0);
  return extract_piece(surface, all, {});
}

std::vector<Vec2> plan(const Piece& piece) {
  const double side = face_cross(piece.surface, 0).z() > 0.0 ? 1.0 : -1.0;
  std::vector<Vec2> uv;
  for (const Vec3& p : piece.surface.positions) uv.emplace_back(p.x(), side * p.y());
  return uv;
}

}  // namespace partuv::test
