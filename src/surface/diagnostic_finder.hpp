#pragma once
/// Diagnostics of a set of atoms.

#include <array>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/diagnostics.hpp"

namespace eses::detail {

/// Two atoms whose centres are nearer than this give a diagnostic (angstrom): about half the length
/// of a short bond.
inline constexpr double close_distance = 0.5;

/// Counts and first examples of the diagnostics of some atoms.
class DiagnosticTally {
 public:
  /// Adds a diagnostic, in any order of atoms.
  void add(DiagnosticKind kind, AtomIndex atom, AtomIndex other);

  /// Adds the diagnostics of other atoms.
  void append(const DiagnosticTally& other);

  /// Returns the diagnostics with a positive count, in the order of `DiagnosticKind`.
  std::vector<Diagnostic> found() &&;

 private:
  std::array<Diagnostic, diagnostic_kinds> diagnostics_;
};

/// A search for diagnostics. Several threads may inspect atoms at the same time, each with its own
/// tallies.
class DiagnosticFinder {
 public:
  /// Keeps a view of `atoms`.
  explicit DiagnosticFinder(std::span<const Atom> atoms);

  /// Inspects atom `i`, which has the centre and radius of the earlier atom `first`.
  void inspect_duplicate(AtomIndex i, AtomIndex first, DiagnosticTally& tally) const;

  /// Inspects atom `i`, which is no duplicate. `near` has all other atoms that may lie in it, or
  /// whose centre is within `close_distance`, in any order, except for duplicates.
  void inspect(AtomIndex i, std::span<const AtomIndex> near, DiagnosticTally& tally);

  /// Returns the diagnostics with a positive count, in the order of `DiagnosticKind`. All atoms
  /// must have been inspected. `tallies` are those of disjoint sets of atoms.
  std::vector<Diagnostic> found(std::span<const DiagnosticTally> tallies) const;

 private:
  void inspect_radius(AtomIndex i, DiagnosticTally& tally) const;
  DiagnosticTally find_nested() const;

  std::span<const Atom> atoms_;
  bool are_small_;                // whether all radii are as small as those in nanometres
  std::vector<AtomIndex> outer_;  // by atom: the first atom that contains it, if any
};

}  // namespace eses::detail
