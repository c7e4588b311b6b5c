#pragma once
/// Runs of molecules in memory in a single process, with the planner and the engine of the product.

#include <filesystem>
#include <utility>
#include <variant>

#include "run/engine.hpp"
#include "run/layer.hpp"
#include "run/planned_run.hpp"

namespace eses::detail::test {

/// The options of the grid of ESES, which the parameters must have.
inline GridOptions& grid_options(Parameters& parameters) {
  return std::get<GridOptions>(parameters.grid);
}
inline const GridOptions& grid_options(const Parameters& parameters) {
  return std::get<GridOptions>(parameters.grid);
}

/// The plan of a run in a single process, with its parameters, schedule and sizes of files.
struct RunPlan : Plan {
  Parameters parameters;
  Schedule schedule;
  FileSizes files;
};

/// Returns the plan of a run.
inline RunPlan make_plan(const Molecule& molecule, const Parameters& parameters,
                         const Outputs& outputs) {
  const PlannedRun run =
      plan_run({.atoms = molecule, .parameters = parameters, .outputs = outputs}, Processes());
  return {run.plan, run.request.parameters, run.largest_schedule, run.file_sizes};
}

/// Performs a run that writes its files into `directory`.
inline Summary run(const Molecule& molecule, const Parameters& parameters, const Outputs& outputs,
                   const std::filesystem::path& directory, const Callbacks& callbacks = {}) {
  PlannedRun planned = plan_run({.atoms = molecule,
                                 .parameters = parameters,
                                 .outputs = outputs,
                                 .output_directory = directory},
                                Processes());
  return execute(planned, callbacks, Processes()).summary;
}

/// Performs a run without files.
inline Summary compute(const Molecule& molecule, const Parameters& parameters,
                       const Callbacks& callbacks = {}) {
  return run(molecule, parameters, Outputs::none(), {}, callbacks);
}

}  // namespace eses::detail::test
