#pragma once
/// @file
/// Selections of labelled atoms.

#include <span>
#include <string>
#include <vector>

#include "eses/atoms.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Returns whether each atom is in a selection: names of chains, such as `A` or `A+B`, residues by
/// their name (`ligand:HEM`) or their chain and number (`ligand:A/401`), `ligand` for all atoms of
/// find_ligand_atoms, or gemmi's syntax, such as `//A/10-20/CA` or `(HEM)`. An empty element
/// follows from the names. Throws Error if the syntax is not valid, if there is no such residue, or
/// if the selection names what labels do not have (models, alternate locations, occupancies,
/// B-factors). A build without gemmi has chains and residues by their names.
std::vector<bool> select_atoms(std::span<const AtomLabel> atoms, const std::string& selection);

/// Returns whether each atom belongs to a ligand: to a residue of several atoms other than hydrogen
/// that is no amino acid, nucleotide or water. Throws Error in a build without gemmi.
std::vector<bool> find_ligand_atoms(std::span<const AtomLabel> atoms);

}  // namespace eses
#pragma GCC visibility pop
