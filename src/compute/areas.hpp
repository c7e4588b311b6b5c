#pragma once
/// Step 4 of a run: the areas of atoms, residues and chains. Each process has the areas of a share
/// of the atoms, in the order of the file.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "checkpoint/checkpoint.hpp"
#include "compute/run_plan.hpp"
#include "distributed/processes.hpp"
#include "output/output_file.hpp"
#include "solve/area_shares.hpp"

namespace eses::detail {

/// The atoms' shares of the area, as far as a process has them.
struct AtomShares {
  std::vector<AreaShare> of_slab;  ///< by atom of the slab; empty if nothing was swept
  std::vector<AtomSum> restored;   ///< from chunks that an earlier run has left
};

/// The areas of atoms [first, first + size) of the file, square angstrom.
struct AtomAreas {
  std::uint64_t first = 0;
  std::vector<double> areas;

  AtomRange range() const { return {first, first + areas.size()}; }
};

/// Adds up the shares of all processes; to be called by all of them. Returns the areas of this
/// process's share of the atoms: all atoms if it is alone.
AtomAreas add_up_areas(AtomShares shares, const RunPlan& plan, const Processes& processes);

/// The sum of all areas in the order of the atoms, as the sum of floating-point numbers depends on
/// it; to be called by all processes.
double total_area(const AtomAreas& areas, const Processes& processes);

/// Each of these writes its files and returns their length; to be called by all processes. Only the
/// first process has output files; the others pass null. `check` is called now and then, and may
/// end the run by an exception.
std::uint64_t write_areas(const AtomAreas& areas, bool gzip, OutputFile* file,
                          const std::function<void()>& check, const Processes& processes);
std::uint64_t write_area_tables(const AtomAreas& areas, const RunPlan& plan, OutputFile* residues,
                                OutputFile* chains, const Processes& processes);

}  // namespace eses::detail
