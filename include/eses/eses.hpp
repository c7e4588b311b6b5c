#pragma once
/// @file
/// Includes all headers of the library.
///
///     const eses::AtomFile file = eses::read_atoms("1ubq.pqr");
///     const eses::Surface surface(file, {.probe_radius = 1.4});
///     const eses::Grid grid = eses::make_grid(surface, {.spacing = 0.4, .margin = 0.8});
///     const eses::Result result = eses::compute(surface, grid);
///
/// All names are in namespace eses. Lengths are in angstrom, and indices start from 0.

#include "eses/atoms.hpp"
#include "eses/cavities.hpp"
#include "eses/check.hpp"
#include "eses/compute.hpp"
#include "eses/crossing.hpp"
#include "eses/diagnostics.hpp"
#include "eses/error.hpp"
#include "eses/far_atoms.hpp"
#include "eses/grid.hpp"
#include "eses/interface.hpp"
#include "eses/maps.hpp"
#include "eses/measure.hpp"
#include "eses/measure_frames.hpp"
#include "eses/outputs.hpp"
#include "eses/place.hpp"
#include "eses/pockets.hpp"
#include "eses/radii.hpp"
#include "eses/read_atoms.hpp"
#include "eses/residue_areas.hpp"
#include "eses/run_options.hpp"
#include "eses/select_atoms.hpp"
#include "eses/summary.hpp"
#include "eses/surface.hpp"
#include "eses/vec3.hpp"
#include "eses/version.hpp"
