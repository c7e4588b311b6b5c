#pragma once
/// A spatial index of the patches of a block.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/block_features.hpp"

namespace eses::detail {

/// A grid of cells over a block's box. Each cell lists the patches whose probe centres can be the
/// nearest to a point of the cell.
class PatchIndex {
 public:
  /// The patches of a cell, as indices into the lists of BlockFeatures.
  struct Cell {
    std::span<const std::uint32_t> placements, arcs, faces;
  };

  /// Replaces the index. Keeps a reference to `features`, which were collected for `box`.
  void reset(const BlockFeatures& features, const Box& box);
  const BlockFeatures& features() const { return *features_; }

  /// Side of a cell, in angstrom.
  double cell_side() const { return cell_side_; }

  /// Returns the cell of a point, or the nearest cell if the point is outside the box.
  Cell cell_at(Vec3 point) const;

 private:
  /// Patches of one kind: cell c has the elements [begin[c], begin[c + 1]) of `items`.
  struct Lists {
    std::vector<std::uint32_t> begin, items;

    std::span<const std::uint32_t> of(std::size_t cell) const {
      return std::span(items).subspan(begin[cell], begin[cell + 1] - begin[cell]);
    }
  };
  using CellIndex = std::array<std::uint32_t, 3>;
  struct CellRange {
    CellIndex low, high;
  };

  CellIndex cell_index(Vec3 point) const;
  template <class Feature, class BoxOf>
  void fill(std::span<const Feature> features, BoxOf&& box_of, Lists& lists);

  const BlockFeatures* features_ = nullptr;
  Box box_;
  double cell_side_ = 1, inverse_side_ = 1;
  std::array<std::size_t, 3> size_{};
  std::vector<CellRange> ranges_;  // scratch memory: the cells of each patch of one kind
  Lists placements_, arcs_, faces_;
};

}  // namespace eses::detail
