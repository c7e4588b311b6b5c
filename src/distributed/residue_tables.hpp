#pragma once
/// residue_area.csv and chain_area.csv of all processes.

#include <cstdint>
#include <span>

#include "distributed/atom_share.hpp"
#include "distributed/processes.hpp"
#include "output/output_file.hpp"

namespace eses {

/// To be called by all processes. `runs` are the residues of the atoms in `atoms`, `areas` the
/// areas of those in `areas_of`; in both each process goes on where the one before ends. The first
/// process has the files. Returns the bytes of both.
std::uint64_t write_tables_jointly(const ResidueRuns& runs, const AtomRange& atoms,
                                   std::span<const double> areas, const AtomRange& areas_of,
                                   OutputFile* residues, OutputFile* chains,
                                   const Processes& processes);

}  // namespace eses
