#pragma once
/// Matching of two lists that are sorted by key.

#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "diff/differences.hpp"

namespace eses::detail {

/// Sets its argument to the next item. Returns false at the end.
template <class Item>
using ItemStream = std::function<bool(Item&)>;

/// Returns a stream of the items of a list, which must outlive it.
template <class Item>
ItemStream<Item> stream_of(const std::vector<Item>& items) {
  return [&items, next = std::size_t{0}](Item& item) mutable {
    if (next == items.size()) return false;
    item = items[next++];
    return true;
  };
}

/// Calls `both(a, b)` for each pair of items with the same key. Returns the counts of all items.
/// Only the first of several items with the same key is compared.
template <class Item, class KeyOf, class Both>
auto match_in_order(Sides<ItemStream<Item>> lists, KeyOf key_of, Both both) {
  Matching<std::decay_t<decltype(key_of(std::declval<const Item&>()))>> matching;
  Sides<Item> items;
  Sides<bool> more{};
  const auto advance = [&](std::size_t side) {
    const auto last = key_of(items[side]);
    while ((more[side] = lists[side](items[side])) && key_of(items[side]) == last) {
      matching.repeated[side].add(last);
    }
  };
  const auto add_only = [&](std::size_t side) {
    matching.only[side].add(key_of(items[side]));
    advance(side);
  };
  for (const std::size_t side : both_sides) more[side] = lists[side](items[side]);
  while (more[0] || more[1]) {
    if (!more[1] || (more[0] && key_of(items[0]) < key_of(items[1]))) {
      add_only(0);
    } else if (!more[0] || key_of(items[1]) < key_of(items[0])) {
      add_only(1);
    } else {
      ++matching.both;
      both(items[0], items[1]);
      advance(0);
      advance(1);
    }
  }
  return matching;
}

}  // namespace eses::detail
