#pragma once
/// Surfaces, and what is computed from them.

#include <pybind11/pybind11.h>

namespace eses::python {

void bind_surface(pybind11::module_& module);

}  // namespace eses::python
