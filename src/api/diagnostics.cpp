#include "eses/diagnostics.hpp"

#include <array>

#include "system/formatted.hpp"

namespace eses {
namespace {

struct Wording {
  std::string_view name;
  std::string_view one, several;  // text after the count
};

// By DiagnosticKind.
constexpr std::array<Wording, diagnostic_kinds> wordings{{
    {"duplicate", "atom has the centre and radius of an earlier one",
     "atoms have the centre and radius of an earlier one"},
    {"close", "atom is within 0.5 angstrom of an earlier one",
     "atoms are within 0.5 angstrom of an earlier one"},
    {"nested", "atom lies wholly inside another one", "atoms lie wholly inside another one"},
    {"large_radius", "atom has a radius above 4 angstrom", "atoms have a radius above 4 angstrom"},
    {"small_radii", "atom, with a radius below 0.4 angstrom; are lengths in nanometres?",
     "atoms, all with a radius below 0.4 angstrom; are lengths in nanometres?"},
    {"one_atom_residue",
     "residue has a single atom, or CA and CB alone; area and volume are not those of the whole "
     "molecule",
     "residues have a single atom, or CA and CB alone, as in models of C-alpha atoms; area and "
     "volume are not those of the whole molecule"},
    {"foreign_residue",
     "residue is no amino acid, nucleotide or water of its name: it has other atoms or no "
     "backbone, as in coarse-grained models; its elements and radii are guesses",
     "residues are no amino acids, nucleotides or water of their names: they have other atoms or "
     "no "
     "backbone, as in coarse-grained models; their elements and radii are guesses"},
    {"nanometre_coordinates", "atom is within 0.45 angstrom of its nearest neighbour",
     "atoms are within 0.45 angstrom of their nearest neighbours, but their radii are in angstrom; "
     "coordinates look like nanometres; multiply them by 10"},
    {"unread_record",
     "line has coordinates, but its record name is neither ATOM nor HETATM; it is not read",
     "lines have coordinates, but their record names are neither ATOM nor HETATM; they are not "
     "read"},
    {"zero_radius", "of radius 0", "of radius 0"},
    {"nested_usual", "of at most 1.4 angstrom inside another atom",
     "of at most 1.4 angstrom inside another atom"},
    {"water", "of water, which pdb2pqr leaves out with --drop-water",
     "of water, which pdb2pqr leaves out with --drop-water"},
}};

const Wording& wording_of(DiagnosticKind kind) { return wordings[static_cast<std::size_t>(kind)]; }

}  // namespace

std::string_view name_of(DiagnosticKind kind) { return wording_of(kind).name; }

std::string describe(const Diagnostic& diagnostic) {
  const auto& [name, one, several] = wording_of(diagnostic.kind);
  return detail::formatted("{} {}", diagnostic.count, diagnostic.count == 1 ? one : several);
}

}  // namespace eses
