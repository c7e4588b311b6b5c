// The communication in a build without MPI, with a single process.
#include <cstdlib>

#include "system/processes.hpp"

namespace eses::detail {

Processes::Processes(int&, char**&) {}

Processes::~Processes() = default;

std::string_view Processes::advice() { return "build the program with -DESES_WITH_MPI=ON"; }

std::vector<char> Processes::gather_bytes(std::span<const char> bytes) const {
  return {bytes.begin(), bytes.end()};
}

std::uint64_t Processes::mpi_memory() const { return 0; }

void Processes::become_reporter() const {}

void Processes::abort(int exit_code) const { std::_Exit(exit_code); }

}  // namespace eses::detail
