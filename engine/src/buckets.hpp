#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

namespace partuv {

/// Items in buckets, those of a bucket in the order in which they were visited.
template <typename Item>
struct Buckets {
  std::vector<int32_t> start;  ///< offsets into `items`, one more than buckets
  std::vector<Item> items;

  int count() const { return static_cast<int>(start.size()) - 1; }
};

/// Sort by counting. each_entry(visit) calls visit(bucket, item) for all entries, the same each
/// time: it is run twice, first to count, then to fill.
template <typename Item, typename EachEntry>
Buckets<Item> grouped(int buckets, const EachEntry& each_entry) {
  Buckets<Item> result;
  result.start.assign(static_cast<size_t>(buckets) + 1, 0);
  each_entry([&](int bucket, const Item&) { ++result.start[bucket + 1]; });
  std::partial_sum(result.start.begin(), result.start.end(), result.start.begin());
  result.items.resize(result.start.back());
  std::vector<int32_t> fill(result.start.begin(), result.start.end() - 1);
  each_entry([&](int bucket, const Item& item) { result.items[fill[bucket]++] = item; });
  return result;
}

}  // namespace partuv
