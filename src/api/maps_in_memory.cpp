#include "api/maps_in_memory.hpp"

#include <cstddef>

#include "output/grid_map.hpp"

namespace eses::detail {
namespace {

// Returns a receiver that sets `values[row * points + x]` to `value_at(words of row, x)`. Several
// threads call it for different rows.
template <class Value, class ValueAt>
MapSink receiver(MapQuantity quantity, const GridRegion& region, std::vector<Value>& values,
                 ValueAt value_at) {
  const auto points = static_cast<std::size_t>(region.size()[0]);
  const auto row_words = static_cast<std::size_t>(GridMap::words_of_row(quantity, region.size()));
  return {quantity, [=, &values](std::int64_t first_row, std::span<const std::uint64_t> words,
                                 GridMap::Scratch&) {
            Value* value = values.data() + static_cast<std::size_t>(first_row) * points;
            for (; !words.empty(); words = words.subspan(row_words))
              for (std::size_t x = 0; x < points; ++x) *value++ = value_at(words, x);
          }};
}

}  // namespace

std::vector<MapSink> dielectric_receivers(std::span<const MapChoice> maps, const GridRegion& region,
                                          std::array<std::vector<double>, 3>& values) {
  std::vector<MapSink> receivers;
  for (const MapChoice& map : maps)
    receivers.push_back(receiver(map.quantity, region, values[edge_axis(map.quantity)],
                                 [map](std::span<const std::uint64_t> words, std::size_t x) {
                                   return dielectric_of(
                                       map, fraction_in(words[x / fractions_per_word], x));
                                 }));
  return receivers;
}

MapSink ion_access_receiver(const GridRegion& region, std::vector<std::uint8_t>& values) {
  // The bits are set for points without access.
  const auto has_access = [](std::span<const std::uint64_t> words, std::size_t x) {
    return static_cast<std::uint8_t>((words[x / 64] >> (x % 64) & 1) ^ 1);
  };
  return receiver(MapQuantity::ion_access, region, values, has_access);
}

}  // namespace eses::detail
