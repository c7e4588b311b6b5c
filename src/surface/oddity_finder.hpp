#pragma once
/// Finds what is odd in a set of atoms, one atom after the other.

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/oddities.hpp"

namespace eses {

/// Atoms that overlap so deeply are odd (angstrom): half of any bond's length.
inline constexpr double close_distance = 0.5;

class OddityFinder {
 public:
  /// Keeps a view of `atoms`, and tells only of those that `is_own` accepts, if it is not empty.
  OddityFinder(std::span<const Atom> atoms, std::function<bool(const Atom&)> is_own);

  /// Tells that atom `i` equals the earlier `first`. This, too, in the order of `i`.
  void add_duplicate(AtomIndex i, AtomIndex first);

  /// Looks at atom `i`; `near` are all others whose centre is within its radius or within
  /// `close_distance`, in any order, but for those that equal an earlier one. To be called for
  /// ascending `i`, which are no duplicates themselves.
  void look(AtomIndex i, std::span<const AtomIndex> near);

  /// All kinds that there are, in the order of `OddityKind`.
  std::vector<Oddity> found() &&;

 private:
  void add(OddityKind kind, AtomIndex atom, AtomIndex other);
  void add_nested();
  void add_radii();

  std::span<const Atom> atoms_;
  std::function<bool(const Atom&)> is_own_;
  std::vector<AtomIndex> outer_;  // of the atoms in which an atom lies the first, if any
  std::array<Oddity, oddity_kinds> oddities_;
};

}  // namespace eses
