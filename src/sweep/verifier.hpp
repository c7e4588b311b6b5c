#pragma once
/// Checks random points and edges of a run against the definition of the surface.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "solve/block_solver.hpp"
#include "task/task.hpp"
#include "verify/definition.hpp"
#include "verify/sample.hpp"

namespace eses::detail {

/// The points are drawn before the run, from all in the band between the van der Waals and the SAS
/// surface. Of the edges that are cut, four times as many as wanted are kept while they come. Half
/// of those that are checked are any of these, the others those whose crossings are nearest to
/// where another patch begins.
class Verifier {
 public:
  /// Keeps views of both, which must outlive it.
  Verifier(std::span<const Atom> atoms, const Plan& plan);
  Verifier(const Verifier&) = delete;
  Verifier& operator=(const Verifier&) = delete;

  /// How much more memory a run needs, about, whose surface cuts so many edges.
  static double memory_bytes(std::int64_t checked, int threads, double crossings);

  /// Keeps what a block says of its share of the sample; called once for every block. Two threads
  /// may call it at a time if they give different numbers, in [0, plan.threads).
  void take(const BlockResult& result, std::size_t thread);

  /// After all blocks. Tells `progress`, if there is one, from the calling thread, how many of all
  /// checks are done; what it throws ends the verification.
  Verification check(const ProgressCallback& progress);

 private:
  struct SampledPoint {
    std::int64_t block = 0;  // that owns it, as a number in the tiling
    GridIndex index{};
    std::optional<bool> is_inside;  // none until a block says so
  };

  struct Checks;

  template <class Action>
  void for_each_in_parallel(std::size_t count, Checks& checks, Action&& action);
  std::vector<Crossing> choose(const std::vector<Crossing>& edges, Checks& checks);

  const Plan& plan_;
  verify::Definition definition_;
  std::vector<SampledPoint> points_;             // by block
  std::vector<verify::CrossingSample> samples_;  // per thread
  std::vector<verify::CentreSearch> searches_;
};

}  // namespace eses::detail
