#pragma once
/// The atoms of a molecule, and what their places tell about them.

#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/check.hpp"
#include "eses/diagnostics.hpp"

namespace eses::detail {

class AtomTree;
class CellList;

/// Atoms with an index of which are near each other: made once, read by whatever looks at them.
/// Copies share what they hold, none of which changes.
///
/// Every way to make a molecule throws Error if a centre or a radius is not finite or a radius is
/// negative. The message names the first such atom by its 0-based index, with the value.
///
/// Where `threads` is a parameter so many make it, or fewer if there are few atoms, and it is the
/// same with any number; 0: all that the process may use. Throws Error if it is negative.
class Molecule {
 public:
  /// Not explicit: a list of atoms may stand wherever a molecule is asked for.
  Molecule(std::vector<Atom> atoms);  // NOLINT(google-explicit-constructor)

  /// `labels` of all atoms, or of none. Throws Error if there are some, but not as many as atoms.
  /// `check`, if it is not empty, is called from time to time, and at least once.
  Molecule(std::vector<Atom> atoms, std::vector<AtomLabel> labels, int threads = 1,
           const CheckCallback& check = {});

  /// A part of a larger molecule: diagnostics are told only of the atoms that `is_own` accepts,
  /// while the others, around them, are what they are odd beside. `is_own` is called by all
  /// threads.
  static Molecule part(std::vector<Atom> atoms, const std::function<bool(const Atom& atom)>& is_own,
                       int threads = 1);

  /// In input order.
  std::span<const Atom> atoms() const;

  /// Chains and residues, by atom; empty if they are not known.
  std::span<const AtomLabel> labels() const;

  /// The diagnostics of the atoms: all kinds of which there is at least one, in the order of
  /// `DiagnosticKind`.
  std::span<const Diagnostic> diagnostics() const;

  /// Whether the atom's ball lies in that of another one. Then so does its SAS ball, whatever the
  /// probe, and the atom takes no part in the surface. Of equal atoms the first is not contained.
  bool is_contained(AtomIndex atom) const;

  /// For use within the library.
  const AtomTree& tree() const;
  const CellList& cells() const;

 private:
  struct Parts;
  explicit Molecule(std::shared_ptr<const Parts> parts) : parts_(std::move(parts)) {}
  std::shared_ptr<const Parts> parts_;
};

}  // namespace eses::detail
