#pragma once
/// Bindings for the iteration over the blocks of a grid.

#include <pybind11/pybind11.h>

namespace eses::python {

/// Registers the types. bind_crossings must be called before.
void bind_blocks(pybind11::module_& module);

}  // namespace eses::python
