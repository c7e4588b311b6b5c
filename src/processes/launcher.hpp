#pragma once
/// What started this process, as far as the environment tells.

#include <cstdlib>
#include <initializer_list>

namespace eses {

/// How many processes were started together, by the launchers of Open MPI and MPICH, or by Slurm;
/// 1 if there is none.
inline int launched_processes() {
  int most = 1;
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"}) {
    const char* const size = std::getenv(name);
    if (size != nullptr && std::atoi(size) > most) most = std::atoi(size);
  }
  return most;
}

}  // namespace eses
