#include "diff/compare_areas.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "diff/match_in_order.hpp"
#include "input/eses_reader.hpp"

namespace eses::detail {
namespace {

std::vector<AtomArea> read_areas(const std::filesystem::path& path) {
  std::vector<AtomArea> areas;
  AtomArea area;
  for (RowReader<AtomArea> reader(path); reader.next(area);) areas.push_back(area);
  std::stable_sort(areas.begin(), areas.end(),
                   [](const AtomArea& a, const AtomArea& b) { return a.atom < b.atom; });
  return areas;
}

double total_of(const std::vector<AtomArea>& areas) {
  double total = 0;
  for (const AtomArea& area : areas) total += area.area;
  return total;
}

}  // namespace

AreaDifference compare_areas(const Sides<std::filesystem::path>& paths, const AreaShifts& shifts,
                             double tolerance) {
  const std::vector<AtomArea> a = read_areas(paths[0]), b = read_areas(paths[1]);
  AreaDifference result;
  result.total = {total_of(a), total_of(b)};
  const auto compare = [&](const AtomArea& in_a, const AtomArea& in_b) {
    const double difference = in_a.area - in_b.area;
    const auto shift = shifts.find(in_a.atom);
    const double explained = shift == shifts.end() ? 0 : shift->second;
    result.area.add(in_a.atom, std::fabs(difference), tolerance);
    result.unexplained.add(in_a.atom, std::fabs(difference - explained), tolerance);
  };
  result.matching = match_in_order<AtomArea>(
      {stream_of(a), stream_of(b)}, [](const AtomArea& area) { return area.atom; }, compare);
  return result;
}

}  // namespace eses::detail
