#include <algorithm>
#include <cmath>

#include "flatten/newton.hpp"

namespace partuv {

bool polish(const Piece& piece, const std::vector<RestTriangle>& rest, const PolishOptions& options,
            const std::function<bool()>& enough, const Context& context, MeshSystem<2>& system,
            std::vector<Vec2>& uv) {
  Newton newton(piece, rest, options, context, system);
  double current = newton.energy(uv, 0.0);
  if (!std::isfinite(current)) return false;
  std::vector<Vec2> step(uv.size());
  for (int taken = 0; taken < options.steps && !context.stopping(); ++taken) {
    if (enough()) return true;
    const double slope = newton.direction(uv, 0.0, step);
    if (!(slope < 0.0)) return true;
    const double next = newton.descend(uv, step, newton.safe_length(uv, step), slope, 0.0, current);
    if (current - next <= options.least_decrease * current) return true;
    current = next;
  }
  return false;
}

bool untangle(const Piece& piece, const std::vector<RestTriangle>& rest,
              const PolishOptions& options, const Context& context, MeshSystem<2>& system,
              std::vector<Vec2>& uv) {
  constexpr double safe = 1e-3;  // a determinant that the polish can start from
  Newton newton(piece, rest, options, context, system);
  std::vector<Vec2> step(uv.size());
  double least = newton.least_determinant(uv);
  for (int taken = 0; taken < options.steps && least < safe && !context.stopping(); ++taken) {
    const double epsilon = std::hypot(0.1 * safe, 0.2 * std::min(least, 0.0));
    const double slope = newton.direction(uv, epsilon, step);
    if (!(slope < 0.0)) break;
    const double current = newton.energy(uv, epsilon);
    if (!(newton.descend(uv, step, 1.0, slope, epsilon, current) < current)) break;
    least = newton.least_determinant(uv);
  }
  return least > 0.0;
}

}  // namespace partuv
