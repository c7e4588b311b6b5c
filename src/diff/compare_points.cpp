#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "diff/compare_directories.hpp"
#include "eses/error.hpp"
#include "input/eses_reader.hpp"
#include "system/bytes_text.hpp"
#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

/// Advances `point` to the next one, x fastest. After the last point, z equals the size.
void advance(GridIndex& point, const GridIndex& size) {
  if (++point[0] < size[0]) return;
  point[0] = 0;
  if (++point[1] < size[1]) return;
  point[1] = 0;
  ++point[2];
}

/// Compares the files line by line. Returns nothing if a file is not in ESES's order, or does not
/// list each point once.
std::optional<PointDifference> compare_in_lock_step(const Sides<std::filesystem::path>& paths,
                                                    const GridIndex& size) {
  RowReader<GridRow> reader_a(paths[0], size), reader_b(paths[1], size);
  PointDifference result;
  GridRow a, b;
  for (GridIndex expected{}; expected[2] < size[2]; advance(expected, size)) {
    if (!reader_a.next(a) || !reader_b.next(b)) return std::nullopt;
    if (a.point != expected || b.point != expected) return std::nullopt;
    if (a.inside != b.inside) result.other_sign.add(a);
    ++result.matching.both;
  }
  if (reader_a.next(a) || reader_b.next(b)) return std::nullopt;
  return result;
}

/// The points of a file, with two bits for each point of the grid.
class PointTable {
 public:
  explicit PointTable(const GridIndex& size)
      : size_(size), listed_(point_count()), inside_(point_count()) {}

  void read(const std::filesystem::path& path, Counted<GridIndex>& repeated) {
    GridRow row;
    for (RowReader<GridRow> reader(path, size_); reader.next(row);) {
      const std::size_t index = index_of(row.point);
      if (listed_[index]) {
        repeated.add(row.point);
      } else {
        listed_[index] = true;
        inside_[index] = row.inside;
      }
    }
  }
  bool lists(const GridIndex& point) const { return listed_[index_of(point)]; }
  bool is_inside(const GridIndex& point) const { return inside_[index_of(point)]; }

 private:
  std::size_t point_count() const {
    return static_cast<std::size_t>(size_[0] * size_[1] * size_[2]);
  }
  std::size_t index_of(const GridIndex& point) const {
    return static_cast<std::size_t>((point[2] * size_[1] + point[1]) * size_[0] + point[0]);
  }

  GridIndex size_;
  std::vector<bool> listed_, inside_;
};

void require_memory(const std::filesystem::path& path, const GridIndex& size) {
  double bytes = 2 * 2.0 / 8;  // two bits for each point and side
  for (const std::int64_t n : size) bytes *= static_cast<double>(n);
  if (bytes < static_cast<double>(available_memory())) return;
  throw Error(
      formatted("{}: the {} points are not all listed in ESES's order; comparing them needs {} of "
                "memory",
                path.string(), fmt::join(size, " x "),
                bytes_text(static_cast<std::uint64_t>(std::min(bytes, 1e19)))));
}

PointDifference compare_in_any_order(const Sides<std::filesystem::path>& paths,
                                     const GridIndex& size) {
  require_memory(paths[0], size);
  PointDifference result;
  Matching<GridIndex>& matching = result.matching;
  PointTable a(size), b(size);
  a.read(paths[0], matching.repeated[0]);
  b.read(paths[1], matching.repeated[1]);
  for (GridIndex point{}; point[2] < size[2]; advance(point, size)) {
    const bool in_a = a.lists(point), in_b = b.lists(point);
    if (in_a != in_b) matching.only[in_a ? 0 : 1].add(point);
    if (!in_a || !in_b) continue;
    ++matching.both;
    if (a.is_inside(point) != b.is_inside(point)) {
      result.other_sign.add({point, a.is_inside(point)});
    }
  }
  return result;
}

}  // namespace

PointDifference compare_points(const Sides<std::filesystem::path>& paths, const GridIndex& size) {
  std::optional<PointDifference> result = compare_in_lock_step(paths, size);
  return result ? *result : compare_in_any_order(paths, size);
}

GridIndex extent_of_points(const std::filesystem::path& path) {
  GridIndex size{};
  GridRow row;
  for (RowReader<GridRow> reader(path); reader.next(row);) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      size[axis] = std::max(size[axis], row.point[axis] + 1);
  }
  return size;
}

}  // namespace eses::detail
