// The parts of the communication that do not depend on MPI.
#include "system/processes.hpp"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <new>
#include <stdexcept>

#include "system/formatted.hpp"
#include "system/resources.hpp"

namespace eses::detail {
namespace {

// Returns the message of an error and its hints.
std::vector<std::string> with_hints(const std::exception& error) {
  std::vector<std::string> texts{error.what()};
  if (const auto* const hinted = dynamic_cast<const Hints*>(&error))
    texts.insert(texts.end(), hinted->hints().begin(), hinted->hints().end());
  return texts;
}

}  // namespace

int Processes::launched_count() {
  int count = 1;
  for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* const size = std::getenv(name)) count = std::max(count, std::atoi(size));
  return count;
}

void Processes::share_failure(const std::function<void()>& action) const {
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
    failure = with_hints(error);
  } catch (const Error& error) {
    failure = with_hints(error);
  }
  const int mine = failure ? rank_ : count_;
  const std::vector<int> ranks = gather(std::span(&mine, 1));
  const int first = *std::min_element(ranks.begin(), ranks.end());
  if (first == count_) return;
  if (first != rank_) failure.reset();
  std::vector<std::string> texts = gather_texts(failure.value_or(std::vector<std::string>()));
  const std::string message = texts.front();
  texts.erase(texts.begin());
  throw SharedError(message, std::move(texts));
}

std::vector<std::string> Processes::gather_texts(std::span<const std::string> texts) const {
  std::string packed;
  for (const std::string& text : texts) packed.append(text).push_back('\0');
  const std::vector<char> all = gather<char>(packed);
  std::vector<std::string> unpacked;
  for (std::size_t at = 0; at < all.size(); at += unpacked.back().size() + 1)
    unpacked.emplace_back(&all[at]);
  return unpacked;
}

// The launcher may bind each process to its own processors, or let all processes use all of them.
Processes::Machine Processes::machine(int processors) const {
  if (count_ == 1) return {1, processors};
  struct Process {
    std::array<char, 256> machine{};
    ProcessorSet allowed;
  } self;
  gethostname(self.machine.data(), self.machine.size() - 1);
  self.allowed = allowed_processors();
  Machine machine{0, 0};
  std::size_t all = 0;  // sum of the numbers of allowed processors
  ProcessorSet together;
  for (const Process& process : gather(std::span<const Process>(&self, 1))) {
    if (process.machine != self.machine) continue;
    ++machine.processes;
    all += process.allowed.count();
    together |= process.allowed;
  }
  const std::size_t share = self.allowed.count() * together.count() / all;
  machine.processors = std::min(processors, std::max(1, static_cast<int>(share)));
  return machine;
}

std::string Processes::on_machine() const {
  std::array<char, 256> name{};
  if (count_ == 1 || gethostname(name.data(), name.size() - 1) != 0) return {};
  return formatted(" on {}", name.data());
}

}  // namespace eses::detail
