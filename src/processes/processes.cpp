// What does not depend on how processes reach each other.
#include "processes/processes.hpp"

#include <algorithm>
#include <new>
#include <optional>

namespace eses {

Processes::Share Processes::share_of(std::uint64_t count, std::uint64_t unit, int rank) const {
  const std::uint64_t units = (count + unit - 1) / unit, all = static_cast<std::uint64_t>(count_);
  const auto begin_of = [&](std::uint64_t r) {
    // Without the product of two large numbers.
    return std::min(count, unit * (units / all * r + units % all * r / all));
  };
  const auto r = static_cast<std::uint64_t>(rank);
  return {begin_of(r), begin_of(r + 1)};
}

void Processes::agree(const std::function<void()>& action) const {
  if (count_ == 1) {
    action();
    return;
  }
  std::optional<std::string> failure;
  try {
    action();
  } catch (const SharedError&) {
    throw;
  } catch (const std::bad_alloc&) {
    failure = "out of memory";
  } catch (const Error& error) {
    failure = error.what();
  }
  const std::uint64_t none = static_cast<std::uint64_t>(count_);
  double first = static_cast<double>(failure ? static_cast<std::uint64_t>(rank_) : none);
  take_least({&first, 1});
  if (first == static_cast<double>(none)) return;
  throw SharedError(broadcast(failure.value_or(""), static_cast<int>(first)));
}

}  // namespace eses
