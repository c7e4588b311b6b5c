#include "geometry/plane_range.hpp"

namespace eses::detail {

std::vector<PlaneRange> remaining(const PlaneRange& planes, std::span<const PlaneRange> done) {
  std::vector<PlaneRange> left;
  std::int64_t begin = planes.begin;
  for (const PlaneRange& range : done) {
    if (range.end <= begin) continue;
    if (range.begin >= planes.end) break;
    if (range.begin > begin) left.push_back({begin, range.begin});
    begin = range.end;
  }
  if (begin < planes.end) left.push_back({begin, planes.end});
  return left;
}

}  // namespace eses::detail
