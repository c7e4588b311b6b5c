#pragma once
/// The point in which three spheres meet, with more digits than its coordinates have.

#include <array>
#include <optional>

#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// Returns the vector from a rounded point to the point near it in which three spheres meet. Its
/// relative error is small although it is as short as the rounding errors of coordinates, so that
/// it adds digits to the difference of two such points. Returns nothing if the spheres almost touch
/// each other there, or do not meet.
std::optional<Vec3> vector_to_meeting_point(const std::array<SasSphere, 3>& spheres, Vec3 rounded);

}  // namespace eses::detail
