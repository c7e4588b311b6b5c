#include "run/run_alone.hpp"

#include <utility>

#include "distributed/processes.hpp"
#include "eses/error.hpp"
#include "run/engine.hpp"
#include "run/run_plan.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

void require_valid(const Plan& plan, const Molecule& molecule) {
  if (plan.threads < 1)
    throw Error(formatted("the plan has {} threads; it must have 1 or more", plan.threads));
  if (plan.atoms_checksum != checksum_of(molecule.atoms()))
    throw Error("the plan was made for other atoms; make a plan for this molecule");
}

Summary run_alone(const Molecule& molecule, const Plan& plan, const RunTask& task,
                  const Callbacks& callbacks) {
  require_valid(plan, molecule);
  const Processes alone;
  RunResult result =
      execute(task, plan_of_molecule(molecule, plan, task.outputs), {}, callbacks, alone);
  return std::move(result.summary);
}

}  // namespace

Summary run(const Molecule& molecule, const Plan& plan, const Outputs& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks) {
  require_valid(outputs, molecule);
  return run_alone(
      molecule, plan,
      {.parameters = plan.parameters, .outputs = outputs, .output_directory = directory},
      callbacks);
}

Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks,
                const MapsInMemory& maps) {
  return run_alone(molecule, plan,
                   {.parameters = plan.parameters,
                    .outputs = Outputs::none(),
                    .output_directory = {},
                    .maps_in_memory = maps},
                   callbacks);
}

}  // namespace eses::detail
