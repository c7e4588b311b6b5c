#pragma once
/// Atoms with a spatial index and diagnostics.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/diagnostics.hpp"

namespace eses::detail {

class AtomTree;
class CellList;

/// Immutable atoms with a spatial index and diagnostics. Copies share their data.
///
/// All constructors throw std::invalid_argument if a coordinate or a radius is not finite, or if a
/// radius is negative. The message names the value and the 0-based index of the first such atom.
///
/// `threads` is the maximum number of threads that build the index; 0 means all that the process
/// may use. Throws std::invalid_argument if it is negative. The result does not depend on it.
class Molecule {
 public:
  /// Implicit, so that a list of atoms can be passed as a molecule.
  Molecule(std::vector<Atom> atoms);  // NOLINT(google-explicit-constructor)

  /// `labels` must be empty or have one element for each atom; otherwise throws Error. `check`, if
  /// it is not empty, is called from time to time, and at least once. `added_radius` is added to
  /// the radii; the diagnostics are those of the atoms without it.
  Molecule(std::vector<Atom> atoms, std::vector<AtomLabel> labels, int threads = 1,
           const CheckCallback& check = {}, double added_radius = 0);

  /// The atoms in input order, with the added radius.
  std::span<const Atom> atoms() const;

  /// The label of each atom; empty if there are no labels.
  std::span<const AtomLabel> labels() const;

  /// The diagnostics with a positive count, in the order of `DiagnosticKind`.
  std::span<const Diagnostic> diagnostics() const;

  /// Returns whether the atom's ball lies in that of another atom. Then its SAS ball does, too, for
  /// any probe radius, and the atom has no influence on the surface. The first of several equal
  /// atoms is not contained in the others.
  bool is_contained(AtomIndex atom) const { return is_contained_[atom] != 0; }

  /// Returns whether the atom and another one are nearly equal, see tolerance::nearly_equal.
  bool has_nearly_equal(AtomIndex atom) const { return has_nearly_equal_[atom] != 0; }

  /// A k-d tree of all atoms, which the first call makes.
  const AtomTree& tree() const;

  /// A cell list of all atoms.
  const CellList& cells() const;

 private:
  struct Parts;
  explicit Molecule(std::shared_ptr<const Parts> parts);
  std::shared_ptr<const Parts> parts_;
  std::span<const std::uint8_t> is_contained_;      // by atom; data of `parts_`
  std::span<const std::uint8_t> has_nearly_equal_;  // by atom; data of `parts_`
};

}  // namespace eses::detail
