// MPI: A Message-Passing Interface Standard, version 3.1, https://www.mpi-forum.org/docs/
#include <sched.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <thread>

#include "distributed/mpi_errors.hpp"
#include "distributed/processes.hpp"
#include "system/formatted.hpp"

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
  if (error != MPI_SUCCESS)
    throw Error(formatted("MPI cannot {}: {}", what, mpi_error_text(error)));
}

int small_count(std::uint64_t count) {
  if (count > static_cast<std::uint64_t>(std::numeric_limits<int>::max()))
    throw Error(
        "more is to be exchanged between two processes than MPI can count; use more of them");
  return static_cast<int>(count);
}

MPI_Op operation_of(Processes::Reduction reduction) {
  using Reduction = Processes::Reduction;
  return reduction == Reduction::min ? MPI_MIN : reduction == Reduction::max ? MPI_MAX : MPI_SUM;
}

template <class Value>
void reduce(std::span<Value> values, MPI_Datatype type, MPI_Op operation) {
  require_success(MPI_Allreduce(MPI_IN_PLACE, values.data(), small_count(values.size()), type,
                                operation, MPI_COMM_WORLD),
                  "reduce");
}

// An MPI datatype of contiguous bytes.
class ByteType {
 public:
  explicit ByteType(std::size_t bytes) {
    MPI_Type_contiguous(small_count(bytes), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ~ByteType() { MPI_Type_free(&type_); }
  ByteType(const ByteType&) = delete;
  ByteType& operator=(const ByteType&) = delete;
  MPI_Datatype get() const { return type_; }

 private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

// Counts and offsets of each process's elements.
struct Layout {
  std::vector<int> counts, begins;

  explicit Layout(std::span<const std::uint64_t> sizes) {
    std::uint64_t begin = 0;
    for (const std::uint64_t size : sizes) {
      counts.push_back(small_count(size));
      begins.push_back(small_count(begin));
      begin += size;
    }
  }
};

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

void Processes::allreduce(std::span<double> values, Reduction reduction) const {
  if (count_ > 1) reduce(values, MPI_DOUBLE, operation_of(reduction));
}

void Processes::allreduce(std::span<std::uint64_t> values, Reduction reduction) const {
  if (count_ > 1) reduce(values, MPI_UINT64_T, operation_of(reduction));
}

std::uint64_t Processes::sum_before(std::uint64_t value) const {
  if (count_ == 1) return 0;
  std::uint64_t before = 0;
  require_success(MPI_Exscan(&value, &before, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD), "add");
  return rank_ == 0 ? 0 : before;  // MPI_Exscan leaves the result of rank 0 undefined
}

std::string Processes::broadcast(std::string text, int from) const {
  if (count_ == 1) return text;
  std::uint64_t size = text.size();
  require_success(MPI_Bcast(&size, 1, MPI_UINT64_T, from, MPI_COMM_WORLD), "broadcast");
  text.resize(size);
  require_success(MPI_Bcast(text.data(), small_count(size), MPI_CHAR, from, MPI_COMM_WORLD),
                  "broadcast");
  return text;
}

std::string Processes::chain(const std::string& first,
                             const std::function<std::string(const std::string&)>& change) const {
  if (count_ == 1) return change(first);
  constexpr int tag = 1;
  std::string value = first;
  if (rank_ > 0) {
    MPI_Status status;
    int size = 0;
    require_success(MPI_Probe(rank_ - 1, tag, MPI_COMM_WORLD, &status), "receive");
    MPI_Get_count(&status, MPI_CHAR, &size);
    value.resize(static_cast<std::size_t>(size));
    require_success(
        MPI_Recv(value.data(), size, MPI_CHAR, rank_ - 1, tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE),
        "receive");
  }
  value = change(value);
  if (rank_ + 1 < count_)
    require_success(
        MPI_Send(value.data(), small_count(value.size()), MPI_CHAR, rank_ + 1, tag, MPI_COMM_WORLD),
        "send");
  return broadcast(std::move(value), count_ - 1);
}

// The launcher may bind each process to its own processors, or let all processes use all of them.
Processes::Machine Processes::machine(int processors) const {
  if (count_ == 1) return {1, processors};
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, rank_, MPI_INFO_NULL, &machine);
  int processes = 1;
  MPI_Comm_size(machine, &processes);
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  const int of_process = std::max(1, CPU_COUNT(&allowed));
  int all = of_process;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_INT, MPI_SUM, machine);
  MPI_Allreduce(MPI_IN_PLACE, &allowed, sizeof allowed, MPI_BYTE, MPI_BOR, machine);
  MPI_Comm_free(&machine);
  const int together = std::max(1, CPU_COUNT(&allowed));
  return {processes, std::min(processors, std::max(1, of_process * together / all))};
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
  if (count_ == 1) return;
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

std::vector<std::uint64_t> Processes::exchange_counts(std::span<const std::uint64_t> to) const {
  std::vector<std::uint64_t> from(to.size());
  require_success(
      MPI_Alltoall(to.data(), 1, MPI_UINT64_T, from.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD),
      "exchange");
  return from;
}

void Processes::exchange_elements(const void* sent, std::span<const std::uint64_t> to,
                                  void* received, std::span<const std::uint64_t> from,
                                  std::size_t element_bytes) const {
  const Layout out(to), in(from);
  const ByteType element(element_bytes);
  require_success(MPI_Alltoallv(sent, out.counts.data(), out.begins.data(), element.get(), received,
                                in.counts.data(), in.begins.data(), element.get(), MPI_COMM_WORLD),
                  "exchange");
}

}  // namespace eses::detail
