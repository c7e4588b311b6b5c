#pragma once
/// Areas and volumes without a grid.

#include <pybind11/pybind11.h>

#include <eses/eses.hpp>

#include "chosen_surface.hpp"

namespace eses::python {

/// Binds the results of measurements and `measure_frames`, and adds `measure` to the class of
/// surfaces.
void bind_measures(pybind11::module_& module, pybind11::class_<ChosenSurface>& surface);

}  // namespace eses::python
