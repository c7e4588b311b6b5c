#pragma once
/// @file
/// Areas and volumes of the frames of a trajectory.

#include <cstddef>
#include <functional>
#include <span>

#include "eses/atoms.hpp"
#include "eses/measure.hpp"
#include "eses/surface.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// Sets the centres of the atoms of a frame, in angstrom. The radii are set. Called from several
/// threads at the same time, once for each frame.
using FrameReader = std::function<void(std::size_t frame, std::span<Atom> atoms)>;

/// Receives the result of a frame. Called from several threads at the same time, once for each
/// frame.
using FrameReceiver = std::function<void(std::size_t frame, Measures&& measures)>;

/// Measures `frame_count` frames of atoms with constant radii (angstrom), several frames at a time.
/// Each result is the same as that of measure() for a surface of its own with the options
/// `surface`; threads and callback are those of `options`. Throws std::invalid_argument if an
/// option or an atom is not valid. Then the message begins with the index of the first frame with
/// such an atom. Throws all exceptions of callbacks.
void measure_frames(std::size_t frame_count, std::span<const double> radii, const FrameReader& read,
                    const FrameReceiver& receive, const MeasureOptions& options = {},
                    const SurfaceOptions& surface = {});

}  // namespace eses
#pragma GCC visibility pop
