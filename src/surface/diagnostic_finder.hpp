#pragma once
/// Finds what is odd in a set of atoms, one atom after the other.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/diagnostics.hpp"

namespace eses::detail {

/// Atoms that overlap so deeply are odd (angstrom): half of any bond's length.
inline constexpr double close_distance = 0.5;

/// What is odd in some atoms, in ascending order: how many, and the first ones.
class DiagnosticTally {
 public:
  void add(DiagnosticKind kind, AtomIndex atom, AtomIndex other);

  /// Adds what is odd in later atoms.
  void append(const DiagnosticTally& later);

  /// All kinds that there are, in the order of `DiagnosticKind`.
  std::vector<Diagnostic> found() &&;

 private:
  std::array<Diagnostic, diagnostic_kinds> diagnostics_;
};

/// Threads may look at atoms at the same time, each with tallies of its own.
class DiagnosticFinder {
 public:
  /// Keeps a view of `atoms`, and tells only of those that `is_own` accepts, if it is not empty.
  DiagnosticFinder(std::span<const Atom> atoms, std::function<bool(const Atom&)> is_own);

  /// Tells that atom `i` equals the earlier `first`.
  void inspect_duplicate(AtomIndex i, AtomIndex first, DiagnosticTally& tally) const;

  /// Looks at atom `i`, which is no duplicate; `near` are all others whose centre is within its
  /// radius or within `close_distance`, in any order, but for those that equal an earlier one.
  void inspect(AtomIndex i, std::span<const AtomIndex> near, DiagnosticTally& tally);

  /// All kinds that there are, in the order of `DiagnosticKind`, once all atoms have been looked
  /// at. Each of the tallies has consecutive atoms, the first of them the first ones.
  std::vector<Diagnostic> found(std::span<const DiagnosticTally> tallies) const;

 private:
  void add(DiagnosticKind kind, AtomIndex atom, AtomIndex other, DiagnosticTally& tally) const;
  void inspect_radius(AtomIndex i, DiagnosticTally& tally) const;
  DiagnosticTally find_nested() const;

  std::span<const Atom> atoms_;
  std::function<bool(const Atom&)> is_own_;
  bool are_small_;                // all radii
  std::vector<AtomIndex> outer_;  // of the atoms in which an atom lies the first, if any
};

}  // namespace eses::detail
