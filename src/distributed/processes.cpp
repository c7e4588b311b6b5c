// The parts of the communication that do not depend on MPI.
#include "distributed/processes.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <new>
#include <optional>
#include <stdexcept>

#include "distributed/packed_texts.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

int Processes::launched_count() {
  int count = 1;
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* const size = std::getenv(name)) count = std::max(count, std::atoi(size));
  return count;
}

IndexRange Processes::range_of(std::uint64_t count, std::uint64_t unit, int rank) const {
  const std::uint64_t units = (count + unit - 1) / unit, all = static_cast<std::uint64_t>(count_);
  const auto begin_of = [&](std::uint64_t r) {
    // This form avoids the product of two large numbers.
    return std::min(count, unit * (units / all * r + units % all * r / all));
  };
  const auto r = static_cast<std::uint64_t>(rank);
  return {begin_of(r), begin_of(r + 1)};
}

void Processes::all_or_throw(const std::function<void()>& action) const {
  if (count_ == 1) {
    action();
    return;
  }
  std::optional<std::vector<std::string>> failure;  // message and hints
  try {
    action();
  } catch (const SharedError&) {
    throw;
  } catch (const std::bad_alloc&) {
    failure = std::vector<std::string>{"out of memory"};
  } catch (const std::invalid_argument& error) {
    failure = std::vector<std::string>{error.what()};
  } catch (const Error& error) {
    failure = std::vector<std::string>{error.what()};
    if (const auto* const hinted = dynamic_cast<const Hints*>(&error))
      failure->insert(failure->end(), hinted->hints().begin(), hinted->hints().end());
  }
  auto first = static_cast<std::uint64_t>(failure ? rank_ : count_);
  allreduce(std::span(&first, 1), Reduction::min);
  if (first == static_cast<std::uint64_t>(count_)) return;
  if (first != static_cast<std::uint64_t>(rank_)) failure.reset();
  std::vector<std::string> texts = gather_texts(failure.value_or(std::vector<std::string>()));
  const std::string message = texts.front();
  texts.erase(texts.begin());
  throw SharedError(message, std::move(texts));
}

std::vector<std::string> Processes::gather_texts(std::span<const std::string> texts) const {
  std::string packed;
  for (const std::string& text : texts) pack(packed, text);
  const std::vector<char> all = gather<char>(packed);
  return unpack({all.begin(), all.end()});
}

std::string Processes::on_machine() const {
  std::array<char, 256> name{};
  if (count_ == 1 || gethostname(name.data(), name.size() - 1) != 0) return {};
  return formatted(" on {}", name.data());
}

}  // namespace eses::detail
