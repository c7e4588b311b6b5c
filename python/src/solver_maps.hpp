#pragma once
/// Maps for Poisson-Boltzmann solvers.

#include <pybind11/pybind11.h>

#include "computed_result.hpp"

namespace eses::python {

/// Adds the methods that compute maps to the class of results.
void bind_solver_maps(pybind11::class_<ComputedResult, std::shared_ptr<ComputedResult>>& result);

}  // namespace eses::python
