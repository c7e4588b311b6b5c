#pragma once
/// Boxes that enclose pieces of the surface.

#include <array>

#include "geometry/box.hpp"
#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// Of the spherical cap { center + radius u : u . pole >= cosine }; `pole` and u are unit vectors.
Box cap_box(Vec3 center, double radius, Vec3 pole, double cosine);

/// Of the spherical triangle with the given corner directions (unit vectors).
Box concave_box(Vec3 center, double radius, const std::array<Vec3, 3>& corners);

/// Of the saddle between two atoms with these van der Waals radii; `directions` are the bounds of
/// its arc's, see direction_bounds.
Box saddle_box(const ContactCircle& circle, const Box& directions,
               const std::array<double, 2>& atom_radii, double probe_radius);

}  // namespace eses::detail
