// MPI: A Message-Passing Interface Standard, version 3.1, https://www.mpi-forum.org/docs/
#include <mpi.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <thread>
#include <utility>

#include "system/formatted.hpp"
#include "system/processes.hpp"

namespace eses::detail {
namespace {

// Returns whether an MPI launcher has started this process. Starting MPI takes a fifth of a second,
// so it is not started without a launcher.
bool was_launched() {
  constexpr std::array names{"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMI_RANK", "PMIX_RANK"};
  return std::any_of(names.begin(), names.end(),
                     [](const char* name) { return std::getenv(name) != nullptr; });
}

// Throws Error if an MPI function has failed.
void require_success(int error, const char* what) {
  if (error == MPI_SUCCESS) return;
  std::array<char, MPI_MAX_ERROR_STRING> text{};
  int length = 0;
  MPI_Error_string(error, text.data(), &length);
  throw Error(formatted("MPI cannot {}: {}", what,
                        std::string_view(text.data(), static_cast<std::size_t>(length))));
}

int small_count(std::uint64_t count) {
  if (count > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw Error(
        "the processes have to exchange more bytes than MPI can count; use fewer processes");
  return static_cast<int>(count);
}

}  // namespace

Processes::Processes(int& argc, char**& argv) {
  if (!was_launched()) return;
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &count_);
  has_mpi_ = true;
  if (provided < MPI_THREAD_FUNNELED)
    throw Error("this MPI does not allow threads beside it (MPI_THREAD_FUNNELED)");
}

Processes::~Processes() {
  if (has_mpi_) MPI_Finalize();
}

std::string_view Processes::advice() { return "start them with mpirun or srun --mpi=pmix"; }

std::vector<char> Processes::gather_bytes(std::span<const char> bytes) const {
  const int size = small_count(bytes.size());
  const auto ranks = static_cast<std::size_t>(count_);
  std::vector<int> sizes(ranks), begins(ranks);
  require_success(MPI_Allgather(&size, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD),
                  "gather");
  std::uint64_t all = 0;
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    begins[rank] = small_count(all);
    all += static_cast<std::uint64_t>(sizes[rank]);
  }
  std::vector<char> gathered(static_cast<std::size_t>(small_count(all)));
  require_success(MPI_Allgatherv(bytes.data(), size, MPI_BYTE, gathered.data(), sizes.data(),
                                 begins.data(), MPI_BYTE, MPI_COMM_WORLD),
                  "gather");
  return gathered;
}

// The value was measured with Open MPI 4.1: its libraries and shared memory.
std::uint64_t Processes::mpi_memory() const {
  constexpr std::uint64_t mebibyte = 1 << 20;
  return has_mpi_ ? 14 * mebibyte : 0;
}

// A process that fails tells all others, and waits for the same message of a lower rank. The lowest
// rank tells all others that it reports the failure. Processes that have not failed need not
// receive the messages, as they are computing.
void Processes::become_reporter() const {
  if (count_ == 1 || std::exchange(is_reporter_, true)) return;
  using namespace std::chrono_literals;
  constexpr int failure = 2, report = 3;  // tags
  const auto tell_others = [this](int tag) {
    for (int rank = 0; rank < count_; ++rank) {
      if (rank == rank_) continue;
      MPI_Request request = MPI_REQUEST_NULL;
      MPI_Isend(nullptr, 0, MPI_BYTE, rank, tag, MPI_COMM_WORLD, &request);
      MPI_Request_free(&request);
    }
  };
  // Receives a message and returns the rank of its sender, or `count_` if there is none.
  const auto receive = [this](int tag) {
    int is_there = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, tag, MPI_COMM_WORLD, &is_there, &status);
    if (is_there == 0) return count_;
    MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return status.MPI_SOURCE;
  };
  const auto has_other_reporter = [&] {
    if (receive(report) < count_) return true;
    for (int rank = receive(failure); rank < count_; rank = receive(failure))
      if (rank < rank_) return true;
    return false;
  };
  tell_others(failure);
  for (int waits = 0; waits < 200; ++waits) {
    if (has_other_reporter()) {
      std::this_thread::sleep_for(10s);  // normally, `abort` of the reporter ends this process
      break;
    }
    std::this_thread::sleep_for(1ms);
  }
  tell_others(report);
}

void Processes::abort(int exit_code) const {
  if (count_ > 1) MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::_Exit(exit_code);
}

}  // namespace eses::detail
