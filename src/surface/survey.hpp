#pragma once
/// Estimates of the patches and the area of a molecule, from a sample of its atoms.
///
/// The number of atoms alone does not give them. The area for each atom of separate spheres is
/// seven times that for each atom of a protein, and a large atom may have more area, or more
/// neighbours, than all others together. Crossings, and with them the memory of a layer and the
/// sizes of files, are proportional to the area.

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/box.hpp"
#include "surface/patches.hpp"

namespace eses::detail {

/// Estimated totals of a molecule.
struct PatchTotals {
  double arcs = 0;
  double placements = 0;
  double face_neighbours = 0;
  double area = 0;                ///< square angstrom
  double crowded_patches = 0;     ///< patches of crowded atoms, see CrowdedPatches
  double crowded_neighbours = 0;  ///< sum of the numbers of neighbours of crowded atoms
  double max_neighbours = 0;      ///< maximum number of neighbours of a sampled crowded atom
};

/// A survey: the patches of a sample of the atoms.
class SurfaceSurvey {
 public:
  /// Builds the patches of a sample of the atoms, or of all atoms if there are few. With a box,
  /// only the patches that are needed for the points in it, and the area in it, are estimated.
  SurfaceSurvey(const Molecule& molecule, double probe_radius,
                const std::optional<Box>& box = std::nullopt);

  const PatchTotals& totals() const { return totals_; }
  std::size_t atom_count() const { return surface_.atoms.size(); }
  /// Number of atoms whose patches are built.
  std::size_t patched_count() const { return patched_.size(); }

  /// Returns the maximum area (square angstrom) between two planes across z that are `thickness`
  /// apart (angstrom), with slack for the error of a sample.
  double max_slab_area(double thickness) const;

  /// Returns the estimated memory in bytes of the patches that are needed at the same time, while
  /// points between two planes across z that are `height` apart (angstrom) are solved by `threads`
  /// threads. Includes the keys of placements in incomplete clusters, and scratch memory.
  double patch_bytes(double height, int threads) const;

  /// Numbers of atoms near the box of a block.
  struct AtomsNear {
    std::size_t reaching_box = 0;  ///< atoms whose SAS ball may meet the box
    std::size_t found = 0;         ///< atoms that a search for patches near the box finds
  };
  /// Returns the numbers for the blocks that have some of the atoms, most atoms first. `box_of`
  /// returns the box of the block at a point.
  std::vector<AtomsNear> atoms_near_blocks(const std::function<Box(const Vec3&)>& box_of) const;

 private:
  void take_samples();
  double max_fraction(double thickness) const;
  std::size_t bin_of(double z) const;
  void prepare_bins();
  void visit(AtomIndex i, double weight, AtomPatchScratch& scratch, BuiltPatches& patches);
  void add_area_of(AtomIndex i, double weight, const CapList& caps);
  void add_area(double area, Box box);

  SurfaceModel surface_;
  std::vector<AtomIndex> patched_;  // atoms with patches
  const BurialPatches& burial_;
  PatchTotals totals_;
  double low_z_ = 0, bin_ = 1, max_radius_ = 0;
  std::vector<std::size_t> atoms_;  // per bin: number of atoms whose centre is in it
  // Per bin: the step from the previous bin while samples are taken, and then the sum up to the
  // bin.
  std::vector<double> area_;
  double slack_ = 1;
};

}  // namespace eses::detail
