#include <cstdlib>

#include "cli/command.hpp"

namespace {

// Threads of OpenMP that wait for each other spin by default: if other programs use the cores, two
// threads take nearly twice the CPU time of one. The runtime reads its environment before main(),
// which this function precedes if the runtime is linked statically.
[[gnu::constructor(101)]] void let_waiting_threads_sleep() {
  setenv("OMP_WAIT_POLICY", "passive", 0);
}

}  // namespace

int main(int argc, char** argv) { return eses::detail::cli::run_command(argc, argv); }
