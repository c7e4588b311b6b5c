#pragma once
/// residue_area.csv and chain_area.csv of all processes.

#include <cstdint>
#include <span>
#include <vector>

#include "eses/atom_labels.hpp"
#include "io/output_file.hpp"
#include "processes/processes.hpp"

namespace eses {

/// The residues of consecutive atoms of a file: runs of atoms with the same label.
struct ResidueShare {
  std::vector<AtomLabel> residues;
  std::vector<std::uint64_t> residue_atoms;  ///< of each
  std::uint64_t first = 0, end = 0;          ///< atoms of the file, 0-based
};

/// To be called by all processes. `areas` are those of the atoms [first, first + size); where a
/// process's atoms begin is where those of the one before end, but for the shares of residues that
/// may be other atoms. The first process has the files. Returns the bytes of both.
std::uint64_t write_tables_jointly(const ResidueShare& share, std::span<const double> areas,
                                   std::uint64_t first, OutputFile* residues, OutputFile* chains,
                                   const Processes& processes);

}  // namespace eses
