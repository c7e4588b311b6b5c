#pragma once
/// Cavities and pockets of a surface.

#include <pybind11/pybind11.h>

#include <eses/eses.hpp>

#include "chosen_surface.hpp"

namespace eses::python {

/// Adds `cavities` and `pockets` to the class of surfaces.
void bind_cavities(pybind11::class_<ChosenSurface>& surface);

}  // namespace eses::python
