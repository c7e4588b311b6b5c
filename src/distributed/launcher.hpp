#pragma once
/// Detection of MPI launchers from environment variables.

#include <cstdlib>
#include <initializer_list>

namespace eses::detail {

/// Returns the number of processes that a launcher (Open MPI, MPICH or Slurm's srun) has started
/// together; 1 without a launcher.
inline int launched_processes() {
  int processes = 1;
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const char* const size = std::getenv(name);
    if (size != nullptr && std::atoi(size) > processes) processes = std::atoi(size);
  }
  return processes;
}

}  // namespace eses::detail
