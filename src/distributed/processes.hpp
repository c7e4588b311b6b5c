#pragma once
/// Communication of the MPI ranks of a run. Without MPI, or without an MPI launcher, there is a
/// single process.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "system/hints.hpp"

namespace eses::detail {

/// The indices in [begin, end), such as the indices of consecutive atoms of a file, or offsets.
struct IndexRange {
  std::uint64_t begin = 0, end = 0;

  std::uint64_t count() const { return end - begin; }
};

/// An error that all processes have received, so that one of them can print it and all can exit.
class SharedError : public Error, public Hints {
 public:
  explicit SharedError(const std::string& message, std::vector<std::string> hints = {})
      : Error(message), Hints(std::move(hints)) {}
};

/// The MPI processes of a run. All functions except `rank`, `count`, `is_first`, `range_of`,
/// `become_reporter`, `abort` and the static ones are collective: all processes must call them,
/// from their main threads and outside of parallel loops (MPI_THREAD_FUNNELED). Elements are copied
/// as bytes. In a single process no function communicates.
class Processes {
 public:
  /// Makes a single process, independent of any launcher. Never uses MPI.
  Processes() = default;
  /// Starts MPI if the process was started by a launcher such as mpirun or srun. Throws Error if
  /// MPI cannot be used.
  Processes(int& argc, char**& argv);
  /// Finalizes MPI.
  ~Processes();  // NOLINT(performance-trivially-destructible): with MPI it is not
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_first() const { return rank_ == 0; }

  /// Returns the number of processes that a launcher (Open MPI, MPICH or Slurm's srun) has started
  /// together, by its environment variables; 1 without a launcher.
  static int launched_count();
  /// Advice for an error message if processes were started together but do not share a run.
  static std::string_view advice();

  /// Returns the part of [0, count) that a rank processes. All parts have about the same size and
  /// begin at multiples of `unit`.
  IndexRange range_of(std::uint64_t count, std::uint64_t unit, int rank) const;

  /// How an element of all processes becomes one. The order of summation is unspecified.
  enum class Reduction { min, max, sum };
  /// Replaces each element by its minimum, maximum or sum over all processes.
  void allreduce(std::span<double> values, Reduction reduction) const;
  void allreduce(std::span<std::uint64_t> values, Reduction reduction) const;
  void allreduce_min(std::span<double> values) const { allreduce(values, Reduction::min); }
  void allreduce_max(std::span<double> values) const { allreduce(values, Reduction::max); }
  void add(std::span<double> values) const { allreduce(values, Reduction::sum); }
  void add(std::span<std::uint64_t> values) const { allreduce(values, Reduction::sum); }
  /// Returns the sum over all lower ranks.
  std::uint64_t sum_before(std::uint64_t value) const;
  /// Returns the sum over all processes.
  std::uint64_t sum(std::uint64_t value) const {
    add({&value, 1});
    return value;
  }

  /// Returns the elements of all processes in the order of ranks, in all processes.
  template <class T>
  std::vector<T> gather(std::span<const T> elements) const;
  /// Does the same with texts, which must not contain NUL.
  std::vector<std::string> gather_texts(std::span<const std::string> texts) const;
  /// Returns the text of rank `from`, in all processes.
  std::string broadcast(std::string text, int from = 0) const;
  /// Sends `to[rank]` to each process. Returns the elements sent to this process, in the order of
  /// ranks.
  template <class T>
  std::vector<T> exchange(std::vector<std::vector<T>> to) const;
  /// Passes a value from rank to rank; each process applies `change` to it. Returns the final value
  /// in all processes.
  std::string chain(const std::string& first,
                    const std::function<std::string(const std::string&)>& change) const;

  /// Performs an action that does not communicate. If it throws Error, std::invalid_argument or
  /// std::bad_alloc in any process, all processes throw SharedError with the message and hints of
  /// the lowest such rank. Other exceptions are thrown only in their process. A single process just
  /// performs the action.
  void all_or_throw(const std::function<void()>& action) const;

  /// The processes on this machine, and the number of processors for each of them.
  struct Machine {
    int processes = 1;
    int processors = 1;
  };
  /// Returns the data of this machine. A process uses at most `processors` processors.
  Machine machine(int processors) const;

  /// Typical memory of MPI in a process, in bytes.
  std::uint64_t mpi_memory() const;

  /// Returns ` on NAME` with the name of the machine, for error messages; empty in a single
  /// process.
  std::string on_machine() const;

  /// Called by a process that fails, before it prints its message. Not collective. If several
  /// processes fail at about the same time, it returns in one of them, which must call `abort`, and
  /// the others wait for this. So a full disk gives one message and not one of each process.
  void become_reporter() const;

  /// Ends all processes at once with an exit code.
  [[noreturn]] void abort(int exit_code) const;

 private:
  // Returns the number of elements from each process, if `to` has the number to each process.
  std::vector<std::uint64_t> exchange_counts(std::span<const std::uint64_t> to) const;
  void exchange_elements(const void* sent, std::span<const std::uint64_t> to, void* received,
                         std::span<const std::uint64_t> from, std::size_t element_bytes) const;

  int rank_ = 0, count_ = 1;
  bool has_mpi_ = false;  // whether this object has started MPI
};

template <class T>
std::vector<T> Processes::exchange(std::vector<std::vector<T>> to) const {
  static_assert(std::is_trivially_copyable_v<T>);
  if (count_ == 1) return std::move(to.front());
  std::vector<std::uint64_t> counts;
  std::vector<T> sent;
  counts.reserve(to.size());
  for (const auto& part : to) counts.push_back(part.size());
  sent.reserve(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
  for (auto& part : to) {
    sent.insert(sent.end(), part.begin(), part.end());
    std::vector<T>().swap(part);
  }
  const std::vector<std::uint64_t> from = exchange_counts(counts);
  std::vector<T> received(std::accumulate(from.begin(), from.end(), std::uint64_t{0}));
  exchange_elements(sent.data(), counts, received.data(), from, sizeof(T));
  return received;
}

template <class T>
std::vector<T> Processes::gather(std::span<const T> elements) const {
  if (count_ == 1) return {elements.begin(), elements.end()};
  return exchange(
      std::vector(static_cast<std::size_t>(count_), std::vector(elements.begin(), elements.end())));
}

}  // namespace eses::detail
