#pragma once

#include <pybind11/pybind11.h>

namespace eses::python {

/// Adds an overload to each public function, constructor and method of a module. It takes all
/// arguments that the function does not take, and raises TypeError, which names the wrong one.
void explain_arguments(pybind11::module_& module);

}  // namespace eses::python
