#pragma once
/// Results with what they were computed from.

#include <eses/eses.hpp>
#include <memory>
#include <utility>

#include "chosen_surface.hpp"

namespace eses::python {

/// A result from which more can be computed.
struct ComputedResult : Result {
  ComputedResult(Result result, ChosenSurface its_surface, RunOptions its_options)
      : Result(std::move(result)),
        surface(std::move(its_surface)),
        options(std::move(its_options)) {}

  ChosenSurface surface;
  RunOptions options;  ///< without callbacks
};

}  // namespace eses::python
