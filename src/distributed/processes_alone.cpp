// The communication in a build without MPI, with a single process.
#include <cstdlib>

#include "distributed/processes.hpp"

namespace eses::detail {

Processes::Processes(int&, char**&) {}

Processes::~Processes() = default;

std::string_view Processes::advice() { return "build the program with -DESES_WITH_MPI=ON"; }

void Processes::allreduce(std::span<double>, Reduction) const {}
void Processes::allreduce(std::span<std::uint64_t>, Reduction) const {}
std::uint64_t Processes::sum_before(std::uint64_t) const { return 0; }
std::string Processes::broadcast(std::string text, int) const { return text; }

std::string Processes::chain(const std::string& first,
                             const std::function<std::string(const std::string&)>& change) const {
  return change(first);
}

Processes::Machine Processes::machine(int processors) const { return {1, processors}; }

std::uint64_t Processes::mpi_memory() const { return 0; }

void Processes::become_reporter() const {}

void Processes::abort(int exit_code) const { std::_Exit(exit_code); }

std::vector<std::uint64_t> Processes::exchange_counts(std::span<const std::uint64_t> to) const {
  return {to.begin(), to.end()};
}

// A single process has nothing to exchange.
void Processes::exchange_elements(const void*, std::span<const std::uint64_t>, void*,
                                  std::span<const std::uint64_t>, std::size_t) const {}

}  // namespace eses::detail
