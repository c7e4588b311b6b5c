#pragma once
/// The patches of a block by place.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solve/block_features.hpp"

namespace eses::detail {

/// Cells over a block's box, each with the patches whose accessible probe centres can be nearest to
/// a point in it.
class PatchIndex {
 public:
  /// Features by their indices: first the placements, then the arcs, then the faces.
  struct Cell {
    std::span<const std::uint32_t> placements, arcs, faces;
  };

  /// Keeps a reference to `features`, which were collected for `box`.
  void reset(const BlockFeatures& features, const Box& box);
  const BlockFeatures& features() const { return *features_; }

  /// Side of a cell, in angstrom.
  double cell_side() const { return cell_side_; }

  /// The cell of a point, or for a point outside the box, the nearest.
  Cell cell_at(Vec3 point) const;

 private:
  /// One kind of patch: those of cell c are `items[begin[c]], ...` up to begin[c + 1].
  struct Lists {
    std::vector<std::uint32_t> begin, items;

    std::span<const std::uint32_t> of(std::size_t cell) const {
      return std::span(items).subspan(begin[cell], begin[cell + 1] - begin[cell]);
    }
  };
  using CellIndex = std::array<std::size_t, 3>;

  CellIndex cell_index(Vec3 point) const;
  template <class Feature, class BoxOf>
  void fill(std::span<const Feature> features, BoxOf&& box_of, Lists& lists);

  const BlockFeatures* features_ = nullptr;
  Box box_;
  double cell_side_ = 1;
  CellIndex size_{};
  Lists placements_, arcs_, faces_;
};

}  // namespace eses::detail
