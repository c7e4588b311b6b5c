#pragma once
/// The processes of one run, MPI ranks, and how they exchange data. Without MPI, or where nothing
/// has started several processes, there is one: a process alone.

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

#include "eses/error.hpp"

namespace eses::detail {

/// A failure that all processes know, so that one of them can print it and all end in order.
class SharedError : public Error {
  using Error::Error;
};

/// Everything here but `rank`, `count`, the action of `all_or_throw` and `abort` must be called by
/// all processes alike, from their main threads, outside of parallel loops (MPI_THREAD_FUNNELED).
/// Elements are copied as bytes. A process that is alone has nothing to exchange.
class Processes {
 public:
  /// A process that is alone, whatever has started it. Never uses MPI.
  Processes() = default;
  /// Joins the other processes if MPI knows of any: if this one was started by mpirun, srun or the
  /// like. Throws Error if MPI cannot be used.
  Processes(int& argc, char**& argv);
  /// Leaves them; they must not be in need of this one any more.
  ~Processes();  // NOLINT(performance-trivially-destructible): with MPI it is not
  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  int rank() const { return rank_; }
  int count() const { return count_; }
  bool is_first() const { return rank_ == 0; }

  /// What makes processes that were started together share one run, where they do not: the advice
  /// of an error message.
  static std::string_view advice();

  /// The part [begin, end) of `count` things that a process gets: all get about the same number, in
  /// multiples of `unit`.
  struct Share {
    std::uint64_t begin = 0, end = 0;
  };
  Share share_of(std::uint64_t count, std::uint64_t unit, int rank) const;

  /// Minima, maxima and sums over all processes, element by element.
  void allreduce_min(std::span<double> values) const;
  void allreduce_max(std::span<double> values) const;
  void allreduce_min(std::span<std::uint64_t> values) const;
  void allreduce_max(std::span<std::uint64_t> values) const;
  void add(std::span<std::uint64_t> values) const;
  /// Must not be used where the order of the summands matters.
  void add(std::span<double> values) const;
  /// The sum over all processes before this one.
  std::uint64_t sum_before(std::uint64_t value) const;
  std::uint64_t sum(std::uint64_t value) const {
    add({&value, 1});
    return value;
  }

  /// The elements of all processes, in the order of ranks.
  template <class T>
  std::vector<T> gather(std::span<const T> own) const;
  /// What process `from` has.
  std::string broadcast(std::string text, int from = 0) const;
  /// Sends `to[rank]` to each process, and returns what they sent here, in the order of ranks.
  template <class T>
  std::vector<T> exchange(std::vector<std::vector<T>> to) const;
  /// Passes a value from each process to the next: each one changes it in turn. Returns the value
  /// that the last process has made of it, in all processes.
  std::string chain(const std::string& first,
                    const std::function<std::string(const std::string&)>& change) const;
  double chain(double value, const std::function<double(double)>& change) const;

  /// Performs an action, which must not communicate. If it throws Error or std::bad_alloc in any
  /// process, all throw SharedError with the message of the first such process. Other exceptions
  /// leave the process in which they are thrown. A process that is alone performs the action only.
  void all_or_throw(const std::function<void()>& action) const;

  /// How many of the processes run on this machine, and of its processors how many a process has
  /// for its own if all have as many.
  struct Machine {
    int processes = 1;
    int processors = 1;
  };
  /// `processors` are those that this process may use at most.
  Machine machine(int processors) const;

  /// Bytes that a process holds for messages and the like, typically.
  std::uint64_t own_memory() const;

  /// ` on NAME`, behind an action that failed, where there may be several machines; else empty.
  std::string place() const;

  /// Ends all processes at once with an exit code.
  [[noreturn]] void abort(int exit_code) const;

 private:
  // How many elements come from each process if `to` says how many go to each.
  std::vector<std::uint64_t> exchange_counts(std::span<const std::uint64_t> to) const;
  void exchange_elements(const void* sent, std::span<const std::uint64_t> to, void* received,
                         std::span<const std::uint64_t> from, std::size_t element_bytes) const;

  int rank_ = 0, count_ = 1;
  bool has_mpi_ = false;  // started by this object, which also ends it
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
std::vector<T> Processes::gather(std::span<const T> own) const {
  if (count_ == 1) return {own.begin(), own.end()};
  return exchange(
      std::vector(static_cast<std::size_t>(count_), std::vector(own.begin(), own.end())));
}

}  // namespace eses::detail
