#pragma once
/// Iteration over the blocks of a grid.

#include <pybind11/pybind11.h>

namespace eses::python {

/// Needs the types of bind_crossings.
void bind_blocks(pybind11::module_& module);

}  // namespace eses::python
