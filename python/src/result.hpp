#pragma once
/// Bindings for results in memory.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_result(pybind11::module_& module);

}  // namespace eses::python
