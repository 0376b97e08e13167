#include "partuv/surface.hpp"

#include <algorithm>

namespace partuv {

void link_opposites(Surface& surface, const std::vector<int32_t>& layer) {
  const int sides = 3 * surface.face_count();
  auto from = [&](int h) { return surface.faces[h / 3][h % 3]; };
  auto to = [&](int h) { return surface.faces[h / 3][(h % 3 + 1) % 3]; };
  auto low = [&](int h) { return std::min(from(h), to(h)); };
  auto high = [&](int h) { return std::max(from(h), to(h)); };
  auto layer_of = [&](int h) { return layer.empty() ? 0 : layer[h / 3]; };
  surface.opposite.resize(surface.faces.size(), Triangle{-1, -1, -1});
  std::vector<int32_t> order;
  for (int h = 0; h < sides; ++h) {
    if (surface.opposite[h / 3][h % 3] < 0) order.push_back(h);
  }
  const int open = static_cast<int>(order.size());
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    if (low(a) != low(b)) return low(a) < low(b);
    if (high(a) != high(b)) return high(a) < high(b);
    if (layer_of(a) != layer_of(b)) return layer_of(a) < layer_of(b);
    return a < b;
  });
  for (int i = 0; i < open;) {
    int end = i + 1;
    while (end < open && low(order[end]) == low(order[i]) && high(order[end]) == high(order[i]) &&
           layer_of(order[end]) == layer_of(order[i])) {
      ++end;
    }
    if (end - i == 2 && from(order[i]) == to(order[i + 1])) {
      const int a = order[i], b = order[i + 1];
      surface.opposite[a / 3][a % 3] = b;
      surface.opposite[b / 3][b % 3] = a;
    }
    i = end;
  }
}

int label_components(const Surface& surface, std::vector<int32_t>& component) {
  component.assign(surface.face_count(), -1);
  int count = 0;
  std::vector<int32_t> stack;
  for (int seed = 0; seed < surface.face_count(); ++seed) {
    if (component[seed] >= 0) continue;
    component[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (int h : surface.opposite[f]) {
        if (h >= 0 && component[h / 3] < 0) {
          component[h / 3] = count;
          stack.push_back(h / 3);
        }
      }
    }
    ++count;
  }
  return count;
}

}  // namespace partuv
