#pragma once
/// Areas of atoms: their sums, and the files that contain them.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "output/output_file.hpp"
#include "run/planned_run.hpp"
#include "solve/area_shares.hpp"

namespace eses::detail {

/// Returns the area of each atom of the file, in square angstrom.
std::vector<double> areas_of(std::span<const AreaShare> shares, double spacing);

// These functions write a file and return its length in bytes. `areas` has an area for each atom.
// `check` is called repeatedly, and may end the run by an exception.

/// Writes partition_area.txt.
std::uint64_t write_areas(std::span<const double> areas, bool gzip, OutputFile& file,
                          const std::function<void()>& check);

/// Writes the tables of residues and chains.
std::uint64_t write_area_tables(std::span<const double> areas, const PlannedRun& run,
                                OutputFile& residues, OutputFile& chains);

/// Writes atoms.csv.
std::uint64_t write_atom_table(std::span<const double> areas, const PlannedRun& run,
                               OutputFile& file, const std::function<void()>& check);

}  // namespace eses::detail
