#pragma once
/// Step 4 of a run: the areas of atoms, residues and chains. Each process has the areas of
/// consecutive atoms of the file.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "distributed/checkpoint.hpp"
#include "distributed/processes.hpp"
#include "output/output_file.hpp"
#include "run/run_plan.hpp"
#include "solve/area_shares.hpp"

namespace eses::detail {

/// The area shares that a process has computed or read.
struct AtomShares {
  std::vector<AreaShare> of_slab;  ///< by atom of the slab; empty if nothing was swept
  std::vector<AtomSum> restored;   ///< shares from the chunks of an earlier run
};

/// The areas of the atoms [first, first + size) of the file, in square angstrom.
struct AreasOfRange {
  std::uint64_t first = 0;
  std::vector<double> areas;

  IndexRange range() const { return {first, first + areas.size()}; }
};

// All processes must call these functions. The first process passes output files, the others pass
// null. `check` is called repeatedly, and may end the run by an exception.

/// Adds up the shares of all processes. Returns the areas of this process's atoms.
AreasOfRange add_up_areas(AtomShares shares, const RunPlan& plan, const Processes& processes);

/// Returns the sum of all areas (square angstrom). Areas are added in the order of the atoms,
/// because floating-point sums depend on the order.
double total_area(const AreasOfRange& areas, const Processes& processes);

/// Writes partition_area.txt and returns its length in bytes.
std::uint64_t write_areas(const AreasOfRange& areas, bool gzip, OutputFile* file,
                          const std::function<void()>& check, const Processes& processes);

/// Writes the tables of residues and chains and returns their length in bytes.
std::uint64_t write_area_tables(const AreasOfRange& areas, const RunPlan& plan,
                                OutputFile* residues, OutputFile* chains,
                                const Processes& processes);

/// Writes atoms.csv and returns its length in bytes.
std::uint64_t write_atom_table(const AreasOfRange& areas, const RunPlan& plan, OutputFile* file,
                               const std::function<void()>& check, const Processes& processes);

}  // namespace eses::detail
