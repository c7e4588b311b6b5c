#pragma once
/// Runs in a single process, for a molecule in memory.

#include <filesystem>

#include "run/plan.hpp"
#include "run/run_plan.hpp"
#include "run/solved_block.hpp"
#include "run/task.hpp"
#include "surface/molecule.hpp"

namespace eses::detail {

/// Computes the surface and writes the chosen files into `directory`, and the mesh into its own
/// directory. Missing directories are created. The output directory is locked against other runs,
/// and so is the mesh file. If the mesh file is a symbolic link, its target is written.
///
/// The files get their final names when all of them are complete, the bounding box last. Older
/// files of these names are removed before. On failure, and if the verification finds faults, none
/// of the files exists.
///
/// Throws Error if a file cannot be written, if the disk space is insufficient, if another run
/// writes to the directory, if memory use exceeds both `max_memory` and the estimate, or if the
/// outputs need labels that are missing. Throws Error before anything is written if the plan was
/// made for other atoms, or has less than one thread.
Summary run(const Molecule& molecule, const Plan& plan, const Outputs& outputs,
            const std::filesystem::path& directory, const Callbacks& callbacks = {});

/// Computes the surface without writing files. `callbacks.block` receives points and crossings. The
/// plan should be made with `Outputs::none()`, or with the maps of `maps` as outputs.
Summary compute(const Molecule& molecule, const Plan& plan, const Callbacks& callbacks = {},
                const MapsInMemory& maps = {});

}  // namespace eses::detail
