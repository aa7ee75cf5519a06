// A sort that keeps the order of equal keys. std::stable_sort does the same by a temporary buffer that newer
// standard libraries have deprecated, of which clang 19 warns.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace kerf::cuda {

/// The places of the items in ascending order of `key(place)`, of places from 0 to `count` - 1. Where keys
/// are equal, the lower place is first.
template <class Key>
std::vector<std::size_t> places_by_key(std::size_t count, const Key& key) {
  std::vector<std::pair<decltype(key(count)), std::size_t>> keyed;
  keyed.reserve(count);
  for (std::size_t place = 0; place < count; ++place) keyed.emplace_back(key(place), place);
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::size_t> places;
  places.reserve(count);
  for (const auto& [value, place] : keyed) places.push_back(place);
  return places;
}

/// Sorts `items` by `key(item)`. Items with the same key keep their order.
template <class Item, class Key>
void sort_by_key(std::vector<Item>& items, const Key& key) {
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const std::size_t place : places_by_key(items.size(), [&](std::size_t i) { return key(items[i]); }))
    sorted.push_back(items[place]);
  items = std::move(sorted);
}

}  // namespace kerf::cuda
