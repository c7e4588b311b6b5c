#include "input/closest_name.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace eses::detail {
namespace {

/// Returns the number of letters to insert, delete or replace (Levenshtein).
std::size_t distance_of(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view closest_name(std::string_view word, std::span<const std::string> names) {
  constexpr std::size_t min_length = 4;
  const std::size_t letters = word.size() - std::min(word.find_first_not_of('-'), word.size());
  const std::size_t max_distance = letters < min_length ? 1 : 2;
  if (word.size() < min_length) return {};
  std::string_view best;
  std::size_t least = max_distance + 1;
  for (const std::string& name : names) {
    if (name.starts_with(word)) return name;
    if (const std::size_t distance = distance_of(word, name); distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

}  // namespace eses::detail
