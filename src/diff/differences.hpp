#pragma once
/// Results of the comparison of two directories of ESES files.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "input/eses_reader.hpp"

namespace eses::detail {

/// Values for directories A [0] and B [1].
template <class Value>
using Sides = std::array<Value, 2>;

/// The indices of both sides.
inline constexpr Sides<std::size_t> both_sides{0, 1};

/// The number of items, and the first few of them.
template <class Item>
struct Counted {
  static constexpr std::size_t max_examples = 5;

  std::int64_t count = 0;
  std::vector<Item> first;

  void add(const Item& item) {
    if (first.size() < max_examples) first.push_back(item);
    ++count;
  }
};

/// The common and the different items of two lists. An item is identified by its key.
template <class Key>
struct Matching {
  std::int64_t both = 0;         ///< number of items on both sides
  Sides<Counted<Key>> only;      ///< items on one side only
  Sides<Counted<Key>> repeated;  ///< items whose key occurred before; they are not compared

  /// Returns whether both sides have the same items.
  bool same() const {
    return std::all_of(only.begin(), only.end(), is_empty) &&
           std::all_of(repeated.begin(), repeated.end(), is_empty);
  }

 private:
  static bool is_empty(const Counted<Key>& counted) { return counted.count == 0; }
};

/// The difference of a quantity of one item.
template <class Key>
struct ItemDeviation {
  Key key{};
  double difference = 0;
};

/// The differences of a quantity of the common items.
template <class Key>
struct Deviation {
  ItemDeviation<Key> largest;
  double mean = 0;
  Counted<ItemDeviation<Key>> above;  ///< differences above the tolerance

  /// Adds the difference of an item.
  void add(const Key& key, double difference, double tolerance) {
    mean += (difference - mean) / static_cast<double>(++count_);
    if (difference > largest.difference) largest = {key, difference};
    if (!(difference <= tolerance)) above.add({key, difference});
  }

 private:
  std::int64_t count_ = 0;
};

/// The differences of bounding_box.txt.
struct BoxDifference {
  Sides<BoundingBox> boxes;
  double corners = 0;  ///< maximum difference of a coordinate of the corners, angstrom
  bool same_corners = true, same_size = true;

  bool same() const { return same_corners && same_size; }
};

/// The differences of grid_info.txt.
struct PointDifference {
  Matching<GridIndex> matching;
  Counted<GridRow> other_sign;  ///< points with different signs, with the sign of A

  bool same() const { return matching.same() && other_sign.count == 0; }
};

/// The crossings of an edge on both sides.
struct CrossingPair {
  Crossing a, b;
};

/// The differences of intersection_info.txt.
struct EdgeDifference {
  Matching<GridEdge> matching;
  Deviation<GridEdge> position;       ///< distance of the positions, angstrom
  Deviation<GridEdge> normal;         ///< length of the difference of the normals
  Counted<CrossingPair> other_atoms;  ///< edges with different atoms
  /// Number of edges with different atoms of the same contact, which are not differences: positions
  /// and normals are equal, both sides name three atoms, and the probe touches all named atoms.
  std::int64_t same_contact = 0;
  /// Differences of the areas of atoms (A - B, square angstrom) that are due to these edges; empty
  /// if the spacing is not known.
  std::unordered_map<AtomIndex, double> area_shifts;

  bool same() const {
    return matching.same() && position.above.count == 0 && normal.above.count == 0 &&
           other_atoms.count == 0;
  }
};

/// The differences of partition_area.txt, in square angstrom.
struct AreaDifference {
  Matching<AtomIndex> matching;
  Sides<double> total{};      ///< sum of all lines
  Deviation<AtomIndex> area;  ///< differences of the areas
  /// Differences of the areas after the correction for edges with different atoms of the same
  /// contact, whose shares go to different atoms.
  Deviation<AtomIndex> unexplained;

  bool same() const { return matching.same() && unexplained.above.count == 0; }
};

/// The status of a file in the comparison.
enum class FileStatus {
  compared,
  only_in_a,
  only_in_b,
  in_neither,
  other_grid,  ///< not compared, as the grids have different numbers of points
};

/// The comparison of the files of one kind.
template <class Difference>
struct FileComparison {
  FileStatus status = FileStatus::in_neither;
  Difference found;  ///< empty unless the files are compared

  /// Returns whether there is no difference. A file in only one directory is a difference; a file
  /// in neither directory is not.
  bool same() const {
    return status == FileStatus::in_neither || (status == FileStatus::compared && found.same());
  }
};

/// All differences of two directories.
struct Differences {
  FileComparison<BoxDifference> box;
  FileComparison<PointDifference> points;
  FileComparison<EdgeDifference> edges;
  FileComparison<AreaDifference> areas;

  bool same() const { return box.same() && points.same() && edges.same() && areas.same(); }
};

}  // namespace eses::detail
