#pragma once
/// Which processes were started together with this one, as far as the environment tells.

#include <cstdlib>
#include <initializer_list>

namespace eses::detail {

/// Number of processes that a launcher (that of Open MPI, of MPICH, or Slurm's srun) has started
/// together; 1 without a launcher.
inline int launched_processes() {
  int most = 1;
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const char* const size = std::getenv(name);
    if (size != nullptr && std::atoi(size) > most) most = std::atoi(size);
  }
  return most;
}

}  // namespace eses::detail
