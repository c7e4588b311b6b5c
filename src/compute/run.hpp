#pragma once
/// Runs for a molecule in memory, in a process that is alone.

#include <filesystem>

#include "plan/plan.hpp"
#include "surface/molecule.hpp"
#include "sweep/solved_block.hpp"
#include "task/task.hpp"

namespace eses::detail {

/// Computes the surface and writes the chosen files into `directory`, which it locks against other
/// runs, and the mesh, for which it locks only that file, into its own directory; both are created
/// if missing. A symbolic link in the mesh's place stays, and the file to which it leads is
/// written. The files appear under their names
/// only when all of them are complete, the bounding box last, and older ones are removed before; on
/// failure none appears, nor if the verification that `plan.parameters` asks for finds a fault.
/// Throws Error on write failures, lack of disk space, if another run is writing there, and where
/// memory exceeds `max_memory` after all: the plan's figure is an estimate. Areas by residue need
/// the molecule's labels; without them that, too, throws Error. Before anything is written it
/// throws Error if the plan is of other atoms than `molecule` has, or has less than one thread.
Summary run(const Molecule& molecule, const Plan& plan, const Outputs& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks = {});

/// The same without any file; what is to be known about points and crossings, `callbacks.block`
/// gets. The plan is best made with `Outputs::none()`.
Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks = {});

}  // namespace eses::detail
