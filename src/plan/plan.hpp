#pragma once
/// Plans for a machine of which it is told what memory is left.

#include <cstdint>
#include <span>
#include <string>

#include "eses/run.hpp"
#include "plan/memory.hpp"

namespace eses {

/// make_plan where `available` bytes of memory are free: the plan keeps them as it keeps
/// `max_memory`.
Plan make_plan_within(std::uint64_t available, const Molecule& molecule,
                      const Parameters& parameters, const OutputChoice& outputs);

/// What `Plan::atoms_checksum` is for these atoms.
std::uint64_t checksum_of(std::span<const Atom> atoms);

/// The first half of it: the grid around atoms with these bounds, and the region to compute.
Plan plan_grid(const SphereBounds& bounds, const Parameters& parameters);

/// What a process has when it plans.
struct Circumstances {
  std::uint64_t available = 0;  ///< bytes of memory that are free
  std::uint64_t held = 0;       ///< bytes that a process which is alone would not hold
  LabelTotals labels;           ///< of the atoms, as far as this process holds them
};

/// The second half, for the region of `plan.tiling`, of which `molecule` must hold the atoms that
/// matter there.
void plan_work(const Circumstances& circumstances, const Molecule& molecule,
               const OutputChoice& outputs, Plan& plan);

/// Of bounding_box.txt: exact.
std::uint64_t expected_box_bytes(const Grid& grid, bool gzip);
/// Of grid_info.txt and partition_area.txt: upper bounds, or estimates if they are gzipped.
std::uint64_t expected_grid_bytes(const GridRegion& region, bool gzip);
std::uint64_t expected_area_bytes(std::uint64_t atoms, bool gzip);

/// Of residue_area.csv and chain_area.csv together: an estimate.
std::uint64_t expected_table_bytes(const LabelTotals& labels);

/// Tells the plan about the map of this name of the plan's region.
void expect_map(const std::string& name, Plan& plan);

}  // namespace eses
