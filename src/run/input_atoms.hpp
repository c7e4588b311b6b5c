#pragma once
/// The input of a run: all atoms, their names and diagnostics.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "eses/diagnostics.hpp"
#include "eses/read_atoms.hpp"
#include "input/atom_names.hpp"
#include "input/grid_reader.hpp"
#include "run/far_atoms.hpp"
#include "run/request.hpp"
#include "surface/molecule.hpp"
#include "system/processes.hpp"
#include "system/resources.hpp"

namespace eses::detail {

/// Diagnostics of the atoms of a file, with the lines of their examples.
struct FileDiagnostics {
  std::vector<Diagnostic> diagnostics;       ///< in the order of `DiagnosticKind`
  std::map<FileIndex, std::uint64_t> lines;  ///< line of each atom that is an example, 1-based
  /// Labels of these atoms, if the file is a PDB or mmCIF file.
  std::map<FileIndex, AtomLabel> labels;

  /// Adds diagnostics of other kinds. `lines_of_atoms` has the line of each atom of the file.
  void add(std::span<const Diagnostic> others, std::span<const std::uint64_t> lines_of_atoms);
};

/// Numbers of an atom's chain and residue in a mesh file, from 0.
struct GroupNumbers {
  std::uint32_t chain = 0, residue = 0;
};

/// The chains and residues of a file.
struct GroupNames {
  bool are_known = false;  ///< whether the file has labels
  /// In the order of their numbers. Only the process that writes the mesh has them.
  std::vector<AtomLabel> chains, residues;

  /// Returns the estimated memory of numbering in bytes: the numbers of the atoms, and temporary
  /// lists of the first atoms of groups.
  static double memory_bytes(double atoms, double groups) {
    return sizeof(GroupNumbers) * atoms + 2 * list_growth * sizeof(AtomIndex) * groups;
  }
};

/// Numbers and lengths of names. A run is a sequence of consecutive atoms with the same residue or
/// chain.
struct LabelTotals {
  std::uint64_t residue_runs = 0, chain_runs = 0;  ///< numbers of runs
  /// Total length of the names of all runs.
  std::uint64_t residue_text_bytes = 0, chain_text_bytes = 0;
  /// Total length of the names and elements of all atoms.
  std::uint64_t atom_text_bytes = 0;
};

/// The names, diagnostics and other properties of the input, without the atoms.
struct InputInfo {
  std::uint64_t atom_count = 0;
  LabelTotals labels;  ///< totals of the labels that were read
  GroupNames groups;   ///< if the mesh names or colours them
  /// Residues of the atoms, if tables of residues are written. Also names of the atoms, if
  /// atoms.csv is written and the file has names; a molecule in memory has labels instead. Only in
  /// the first process.
  AtomNames names;
  /// Radii of all atoms (angstrom), if atoms.csv is written and the slab does not have all atoms.
  /// Only in the first process.
  std::vector<double> radii;
  std::optional<PotentialMap> potential;  ///< of the vertices of the mesh, if it has one
  /// The report of reading a PDB or mmCIF file; only in the first process.
  std::optional<StructureReport> structure;
  std::optional<FarAtomsWarning> far_atoms;
  FileDiagnostics diagnostics;  ///< of all atoms; only in the first process

  /// Returns the memory of labels, names, radii and the potential in bytes.
  std::uint64_t bytes() const;
};

/// All atoms of the input, before they are divided among the processes.
struct InputAtoms {
  InputInfo info;
  std::vector<GroupNumbers> groups;  ///< by atom; empty if groups are not numbered
  /// All atoms in the first process, and if cavities are searched.
  Molecule molecule{std::vector<Atom>()};
  std::vector<Atom> without_index;  ///< all atoms in the other processes

  std::span<const Atom> atoms() const {
    return without_index.empty() ? molecule.atoms() : std::span<const Atom>(without_index);
  }
};

/// Reads the file of a request, or takes its molecule. Each process reads the whole file. All
/// processes must call it. Throws SharedError if the atoms cannot be read, or if the outputs are
/// not possible for them.
InputAtoms take_input(const Request& request, const Share& share, const Processes& processes);

/// Returns what a process keeps of the input with a slab of so many atoms: only the first one
/// writes names.
InputInfo kept_info(InputAtoms input, std::size_t slab_atoms, const Outputs& outputs,
                    const Processes& processes);

/// Returns the memory of labels in bytes.
std::uint64_t memory_of_labels(std::span<const AtomLabel> labels);

}  // namespace eses::detail
