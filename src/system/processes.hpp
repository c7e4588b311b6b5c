#pragma once
/// Communication of the MPI ranks of a run. Without MPI, or without an MPI launcher, there is a
/// single process.

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "system/hints.hpp"

namespace eses::detail {

/// An error that all processes have received, so that one of them can print it and all can exit.
class SharedError : public HintedError {
 public:
  using HintedError::HintedError;
};

/// The MPI processes of a run. All functions except `rank`, `count`, `is_first`, `become_reporter`,
/// `abort` and the static ones are collective: all processes must call them, from their main
/// threads and outside of parallel loops (MPI_THREAD_FUNNELED). In a single process no function
/// communicates.
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

  /// Returns the elements of all processes in the order of ranks, in all processes. Elements are
  /// copied as bytes.
  template <class T>
  std::vector<T> gather(std::span<const T> elements) const;
  /// Does the same with texts, which must not contain NUL.
  std::vector<std::string> gather_texts(std::span<const std::string> texts) const;

  /// Return the sum and the maximum of the values of all processes, in all processes.
  template <class T>
  T sum(const T& value) const {
    const std::vector<T> values = gather(std::span(&value, 1));
    return std::accumulate(values.begin(), values.end(), T{});
  }
  template <class T>
  T max(const T& value) const {
    const std::vector<T> values = gather(std::span(&value, 1));
    return *std::max_element(values.begin(), values.end());
  }

  /// Returns when all processes have called it.
  void wait_for_all() const { sum(0); }

  /// Performs an action that does not communicate, and returns its result. If it throws Error,
  /// std::invalid_argument or std::bad_alloc in any process, all processes throw SharedError with
  /// the message and hints of the lowest such rank. Other exceptions are thrown only in their
  /// process. A single process just performs the action.
  template <class Action>
  auto all_or_throw(Action&& action) const {
    using Result = decltype(action());
    if constexpr (std::is_void_v<Result>) {
      share_failure(action);
    } else {
      std::optional<Result> result;
      share_failure([&] { result.emplace(action()); });
      return std::move(*result);
    }
  }

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
  // Performs the action of all_or_throw.
  void share_failure(const std::function<void()>& action) const;
  // Returns the bytes of all processes in the order of ranks.
  std::vector<char> gather_bytes(std::span<const char> bytes) const;

  int rank_ = 0, count_ = 1;
  bool has_mpi_ = false;              // whether this object has started MPI
  mutable bool is_reporter_ = false;  // see become_reporter
};

template <class T>
std::vector<T> Processes::gather(std::span<const T> elements) const {
  static_assert(std::is_trivially_copyable_v<T>);
  if (count_ == 1) return {elements.begin(), elements.end()};
  const std::vector<char> bytes =
      gather_bytes({reinterpret_cast<const char*>(elements.data()), elements.size_bytes()});
  std::vector<T> all(bytes.size() / sizeof(T));
  std::memcpy(all.data(), bytes.data(), bytes.size());
  return all;
}

}  // namespace eses::detail
