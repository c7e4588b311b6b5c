#pragma once
/// What the surface of a molecule will amount to, from a sample of its atoms: enough to plan by.

#include <cstddef>
#include <vector>

#include "surface/patches.hpp"

namespace eses::detail {

/// Totals of a molecule, extrapolated from its sample.
struct PatchTotals {
  double arcs = 0;
  double placements = 0;
  double face_neighbours = 0;
  double area = 0;  ///< square angstrom; concave patches that cut each other count in full
  double crowded_patches = 0;     ///< of crowded atoms, see CrowdedPatches
  double crowded_neighbours = 0;  ///< sum over crowded atoms
  double max_neighbours = 0;      ///< of any crowded atom that was looked at
};

class SurfaceSurvey {
 public:
  /// Builds the patches of a sample of the atoms, of all of them if they are few. The larger an
  /// atom, the more surely it is in the sample.
  SurfaceSurvey(const Molecule& molecule, double probe_radius);
  /// Likewise for what happens in `box`: the totals are of the patches that are built for it, and
  /// areas of what lies in it.
  SurfaceSurvey(const Molecule& molecule, double probe_radius, const Box& box);

  const PatchTotals& totals() const { return totals_; }
  std::size_t atom_count() const { return surface_.atoms.size(); }
  /// Of the atoms, those that get patches.
  std::size_t patched_count() const { return reach_.empty() ? atom_count() : reach_.size(); }
  double probe_radius() const { return surface_.probe_radius; }

  /// The area between two heights, angstrom.
  double area_between(double low_z, double high_z) const;

  /// The largest area between two planes across z that are `thickness` apart (angstrom), with the
  /// sampling error added twice over.
  double max_slab_area(double thickness) const;

  /// The largest share of the atoms that get patches with centres between two planes across z that
  /// are `thickness` apart (angstrom).
  double max_share(double thickness) const;

  /// Of the atoms that get patches (angstrom).
  double max_radius() const { return max_radius_; }

  /// Numbers of atoms around a box: those whose SAS spheres may reach into it, and those that a
  /// look-up with a ball around the box finds.
  struct AtomsNear {
    std::size_t reaching_box = 0, found = 0;
  };
  /// The maxima for boxes with these half sides around some atoms.
  AtomsNear max_atoms_near(Vec3 half_sides) const;

 private:
  void take_samples();
  AtomIndex patched_atom(std::size_t i) const {
    return reach_.empty() ? static_cast<AtomIndex>(i) : reach_[i];
  }
  struct Strata {
    std::size_t count = 0;
    double size = 0;  // as of size_of
  };
  double size_of(std::size_t patched) const;
  void prepare_bins();
  Strata make_strata() const;
  void visit(AtomIndex i, double weight, AtomPatchScratch& scratch, BuiltPatches& patches);
  void add_convex(AtomIndex i, double weight, std::span<const AtomIndex> neighbours);
  void add_area(double area, double weight, Box box, double patch_area);

  SurfaceModel surface_;
  std::vector<AtomIndex> reach_;  // of a box; all atoms if there is none
  BurialPatches burial_;
  CoveringDirections directions_;
  PatchTotals totals_;
  double low_z_ = 0, bin_ = 1, max_radius_ = 0;
  std::vector<std::size_t> atoms_;  // per bin: those whose centre is in it
  // Per bin: while samples are taken, the steps to it; afterwards, the sums up to it.
  std::vector<double> area_, variance_;
};

}  // namespace eses::detail
