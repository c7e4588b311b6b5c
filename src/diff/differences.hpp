#pragma once
/// What the comparison of two directories of ESES's files finds. [0] is directory A, [1] is B.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/grid.hpp"
#include "io/eses_reader.hpp"

namespace eses::detail {

template <class Value>
using Sides = std::array<Value, 2>;

inline constexpr Sides<std::size_t> both_sides{0, 1};

/// How many there are, and the first few of them.
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

/// Which items two lists have in common; an item is known by its key.
template <class Key>
struct Matching {
  std::int64_t both = 0;
  Sides<Counted<Key>> only;      ///< on one side only
  Sides<Counted<Key>> repeated;  ///< lines with a key that an earlier line has; not looked at

  bool same() const {
    return std::all_of(only.begin(), only.end(), is_empty) &&
           std::all_of(repeated.begin(), repeated.end(), is_empty);
  }
  std::int64_t listed(std::size_t side) const {
    return both + only[side].count + repeated[side].count;
  }

 private:
  static bool is_empty(const Counted<Key>& counted) { return counted.count == 0; }
};

/// How far a quantity of one item differs.
template <class Key>
struct ItemDeviation {
  Key key{};
  double difference = 0;
};

/// How far a quantity differs between the items that both sides have.
template <class Key>
struct Deviation {
  ItemDeviation<Key> largest;
  double mean = 0;
  Counted<ItemDeviation<Key>> above;  ///< above the tolerance

  void add(const Key& key, double difference, double tolerance) {
    mean += (difference - mean) / static_cast<double>(++count_);
    if (difference > largest.difference) largest = {key, difference};
    if (!(difference <= tolerance)) above.add({key, difference});
  }

 private:
  std::int64_t count_ = 0;
};

struct BoxDifference {
  Sides<BoundingBox> boxes;
  double corners = 0;  ///< largest difference of a coordinate of the corners, angstrom
  bool same_corners = true, same_size = true;

  bool same() const { return same_corners && same_size; }
};

struct PointDifference {
  Matching<GridIndex> matching;
  Counted<GridRow> other_sign;  ///< as A has them

  bool same() const { return matching.same() && other_sign.count == 0; }
};

struct EdgeDifference {
  Matching<GridEdge> matching;
  Deviation<GridEdge> position;  ///< distance of the positions, angstrom
  Deviation<GridEdge> normal;    ///< length of the difference of the normals
  Counted<Sides<Crossing>> other_atoms;
  /// Edges that name other atoms of the same contact, which is no difference: position and normal
  /// agree, both sides name three atoms, and the probe there touches all that are named.
  std::int64_t same_contact = 0;

  bool same() const {
    return matching.same() && position.above.count == 0 && normal.above.count == 0 &&
           other_atoms.count == 0;
  }
};

struct AreaDifference {
  Matching<AtomIndex> matching;
  Sides<double> total{};             ///< of all lines, square angstrom
  Deviation<AtomIndex> area;         ///< square angstrom
  Deviation<AtomIndex> unexplained;  ///< what is left of it where edges name other atoms of the
                                     ///< same contact, whose shares then go to other atoms

  bool same() const { return matching.same() && unexplained.above.count == 0; }
};

/// What became of a file.
enum class FileStatus { compared, only_in_a, only_in_b, in_neither, other_grid };

struct Differences {
  std::array<FileStatus, 4> status{};  ///< by EsesFile
  BoxDifference box;
  PointDifference points;
  EdgeDifference edges;
  AreaDifference areas;

  FileStatus status_of(EsesFile file) const { return status[static_cast<std::size_t>(file)]; }
  /// Whether a script may take one directory for the other: a file in one of them only is a
  /// difference, one in neither is none.
  bool same() const {
    const auto is_same = [](FileStatus one) {
      return one == FileStatus::compared || one == FileStatus::in_neither;
    };
    return std::all_of(status.begin(), status.end(), is_same) && box.same() && points.same() &&
           edges.same() && areas.same();
  }
};

}  // namespace eses::detail
