#pragma once
/// @file
/// Diagnostics of atoms: valid but suspicious input. It does not affect the accuracy of the
/// results.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "eses/atoms.hpp"

namespace eses {

/// The kinds of suspicious atoms.
enum class DiagnosticKind : std::uint8_t {
  duplicate,     ///< The atom has the centre and the radius of an earlier atom.
  close,         ///< The centre is within 0.5 angstrom of an earlier one; both radii are positive.
  nested,        ///< The atom is larger than a hydrogen and lies wholly inside another atom.
  large_radius,  ///< The radius is above 4 angstrom.
  small_radii,   ///< All radii are below 0.4 angstrom; lengths may be in nanometres.
  /// The atom is alone in its residue, or CA with CB alone, as in most residues of the polymers of
  /// a PDB or mmCIF file. Atoms are missing, as in models of C-alpha atoms.
  one_atom_residue,
  /// The atom is the first one of a residue with the name of an amino acid or nucleotide, but with
  /// atoms that it cannot have or without its backbone, as in coarse-grained models, or a bead of
  /// water of such a model. Elements and radii are guesses.
  foreign_residue,
  /// Most atoms are within 0.45 angstrom of their nearest neighbour, and their radii are not those
  /// of small_radii: the coordinates are probably in nanometres. It replaces close and nested.
  nanometre_coordinates,
  unread_record,  ///< A line with coordinates has neither the name ATOM nor HETATM; see `line`.
  zero_radius,    ///< The radius is 0, as for hydrogens of some force fields; usual.
  nested_usual,   ///< A hydrogen, of radius up to 1.4 angstrom, lies inside another atom; usual.
  water,          ///< The atom belongs to a water molecule of a PQR file; usual.
};

/// Number of kinds of diagnostics.
inline constexpr std::size_t diagnostic_kinds = 12;

/// Returns whether such atoms also occur in correct files.
constexpr bool is_usual(DiagnosticKind kind) { return kind >= DiagnosticKind::zero_radius; }

/// All atoms with a diagnostic of one kind. An atom may have several diagnostics, but a duplicate
/// or close atom has no other diagnostic of the same pair.
struct Diagnostic {
  /// An atom with this diagnostic.
  struct Example {
    AtomIndex atom = 0;  ///< The atom.
    /// The atom that it repeats, is close to or lies in; `atom` itself if there is none.
    AtomIndex other = 0;
    /// Line of the file, from 1, if it is not an atom that is suspicious; 0 otherwise.
    std::uint64_t line = 0;

    /// Compares all members.
    friend bool operator==(const Example&, const Example&) = default;
  };
  /// The largest number of examples.
  static constexpr std::size_t max_examples = 5;

  DiagnosticKind kind = DiagnosticKind::duplicate;  ///< What is suspicious.
  std::uint64_t count = 0;                          ///< Number of atoms with this diagnostic.
  std::vector<Example> examples;  ///< The first of these atoms, ascending by `atom`.

  /// Compares all members.
  friend bool operator==(const Diagnostic&, const Diagnostic&) = default;
};

#pragma GCC visibility push(default)

/// Returns the name of a kind, such as `one_atom_residue`.
std::string_view name_of(DiagnosticKind kind);

/// Returns what is suspicious, such as "3 atoms have a radius above 4 angstrom".
std::string describe(const Diagnostic& diagnostic);

#pragma GCC visibility pop

}  // namespace eses
