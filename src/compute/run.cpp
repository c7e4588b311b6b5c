#include "compute/run.hpp"

#include <fmt/format.h>

#include <utility>

#include "compute/engine.hpp"
#include "compute/run_plan.hpp"
#include "distributed/processes.hpp"
#include "eses/error.hpp"

namespace eses::detail {
namespace {

void require_valid(const Plan& plan, const Molecule& molecule) {
  if (plan.threads < 1)
    throw Error(fmt::format("the plan has {} threads; it must have 1 or more", plan.threads));
  if (plan.atoms_checksum != checksum_of(molecule.atoms()))
    throw Error("the plan was made for other atoms; make a plan for this molecule");
}

}  // namespace

Summary run(const Molecule& molecule, const Plan& plan, const Outputs& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks) {
  require_valid(plan, molecule);
  require_valid(outputs, molecule);
  const Processes alone;
  const RunTask task{
      .parameters = plan.parameters, .outputs = outputs, .output_directory = directory};
  RunResult result = execute(task, plan_of_molecule(molecule, plan, outputs), {}, callbacks, alone);
  return std::move(result.summary);
}

Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks) {
  return run(molecule, plan, Outputs::none(), {}, callbacks);
}

}  // namespace eses::detail
