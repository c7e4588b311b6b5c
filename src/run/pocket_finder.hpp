#pragma once
/// Pockets from the planes of a grid.
///
/// The difference of two surfaces has the points outside of the surface of the small probe and
/// inside that of the large probe. A center is such a point where the small probe's centre can be.
/// Centers that are at most two spacings apart are connected. A pocket has the points of the
/// difference whose nearest center belongs to the same connected set, and is at most the probe
/// radius plus half a spacing away.

#include <array>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "eses/place.hpp"
#include "eses/pockets.hpp"
#include "geometry/block_crossing.hpp"
#include "solve/area_shares.hpp"
#include "system/disjoint_sets.hpp"

namespace eses::detail {

/// Both surfaces in one plane of the grid. Bits are in rows [y] of words; bit i % 64 of word i / 64
/// is point i.
struct PocketPlane {
  /// A crossing with an edge whose lower end is in the plane.
  struct Edge {
    std::int64_t x = 0, y = 0;  ///< index of the lower end
    std::uint8_t axis = 0;
    bool lower_is_inside = false;
    std::uint8_t atom_count = 0;
    std::array<AtomIndex, 3> atoms{};  ///< adjacent atoms; the first `atom_count` are set
    std::int64_t share = 0;            ///< |n_axis| in units of `area_share_unit`
  };

  std::vector<std::uint64_t> small, large;  ///< points inside the surfaces
  std::vector<std::uint64_t> covered;       ///< points where the small probe's centre cannot be
  std::vector<Edge> walls;                  ///< crossings of the small probe's surface
  std::vector<Edge> mouths;                 ///< crossings of the large probe's surface
};

/// Finds pockets in planes that arrive in ascending order. Keeps the planes within the reach of a
/// probe, and sums of each pocket.
class PocketFinder {
 public:
  /// Keeps a pointer to `place`, which is null if no place is searched.
  PocketFinder(const Grid& grid, double probe_radius, int threads, const Place* place = nullptr);

  /// Returns the memory of the planes in bytes.
  static double memory_bytes(const Grid& grid, double probe_radius);

  /// Returns a plane without inside points and crossings.
  PocketPlane empty_plane() const;
  /// Adds the next plane. Its lists of bits have the sizes of those of `empty_plane()`.
  void add(PocketPlane plane);

  /// Returns the pockets with at least this volume (cubic angstrom), after the last plane.
  Pockets finish(double min_volume);
  /// Returns the pockets at the place with at least this volume, after the last plane.
  PlacedPockets finish_at_place(double min_volume);

 private:
  using Element = DisjointSets::Element;
  static constexpr Element none = 0xffffffff;
  static constexpr std::int64_t no_index = std::int64_t{1} << 62;

  /// The points [x - half, x + half] of a row, at an offset.
  struct RowOffset {
    std::int64_t y = 0, z = 0, half = 0;
  };
  struct Plane : PocketPlane {
    std::vector<std::uint64_t> centers;
    std::vector<std::uint8_t> has_centers;  // by row
    // By point: the set of centers, the set of centers at mouths, and the set of the nearest
    // center. Without elements if all are `none`.
    std::vector<Element> center, mouth, owner;
  };
  struct Sums {
    std::int64_t points = 0, centers = 0;
    std::array<std::int64_t, 3> indices{};  // of the points
    AreaShare mouth = 0;
    // Only with a place: its points, and the corners of the box around all points.
    std::int64_t points_at_place = 0;
    GridIndex low{no_index, no_index, no_index}, high{-1, -1, -1};

    void add(const Sums& other);
  };
  // The sums of all elements of a pocket.
  struct Found : Sums {
    std::size_t mouth_count = 0;
    std::vector<AtomIndex> atoms;
    std::vector<Vec3> centers_at_mouths, all_centers;  // only with a place
  };
  // A point of the grid and its element.
  struct Center {
    std::array<std::int32_t, 3> index;
    Element element;
  };

  Plane& plane(std::int64_t z) { return planes_[static_cast<std::size_t>(z - first_z_)]; }
  std::size_t row_begin(std::int64_t y) const { return static_cast<std::size_t>(y) * words_; }
  bool is_row(std::int64_t y) const { return y >= 0 && y < grid_.size[1]; }
  Element element_at(const std::vector<Element>& elements, std::int64_t x, std::int64_t y) const;
  Element united(DisjointSets& sets, std::vector<Element> Plane::*elements, const GridIndex& at);
  template <class Action>
  void find_sets(std::int64_t z, const std::vector<std::uint64_t>& bits, DisjointSets& sets,
                 std::vector<Element> Plane::*elements, Action&& action);
  void find_centers(std::int64_t z);
  std::uint64_t at_mouth(std::int64_t y, std::int64_t z, std::size_t word);
  void find_mouths(std::int64_t z);
  void find_owners(std::int64_t z);
  void find_owners(std::int64_t y, std::int64_t z);
  Element nearest_center(const GridIndex& at);
  void add_points(std::int64_t z);
  void add_crossings(std::int64_t z);
  Element owner_of_end(const PocketPlane::Edge& edge, std::int64_t z, bool is_inside);
  void remove_repeated_contacts();
  void add_place(std::int64_t z);
  void keep_center(std::vector<Center>& list, const GridIndex& at, Element element) const;
  std::vector<Found> collect();
  Pocket pocket_of(const Found& found) const;
  double point_volume() const { return grid_.spacing * grid_.spacing * grid_.spacing; }
  Vec3 point(const GridIndex& index) const;
  template <class Action>
  void for_each_point(const std::vector<std::uint64_t>& bits, Action&& action) const;

  Grid grid_;
  int threads_;
  std::size_t words_;  // of a row
  std::int64_t planes_within_reach_;
  // Differences of the indices of points.
  std::vector<GridIndex> before_;        // to neighbours that are connected, and precede a point
  std::vector<GridIndex> within_reach_;  // ascending in distance
  std::vector<RowOffset> rows_within_reach_;
  std::deque<Plane> planes_;
  std::int64_t first_z_;  // of `planes_`
  DisjointSets centers_, mouths_;
  std::vector<Sums> sums_;                               // by element of `centers_`
  std::vector<Element> center_of_mouth_;                 // by element of `mouths_`
  std::vector<std::pair<Element, AtomIndex>> contacts_;  // of owners and atoms
  std::size_t contacts_to_keep_ = 0;  // number of contacts when repetitions were removed
  std::int64_t difference_points_ = 0;
  const Place* place_;
  std::vector<Center> place_centers_, place_mouths_;  // of all pockets, if there is a place
  std::int64_t place_inside_ = 0, place_outside_ = 0, place_shallow_ = 0;  // points
};

}  // namespace eses::detail
