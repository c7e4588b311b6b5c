#pragma once
/// Integrals over saddle patches.

#include "geometry/contact_circle.hpp"

namespace eses::detail {

/// Integrals over a part of the surface.
struct SurfaceIntegrals {
  double area = 0;
  Vec3 vector_area;  ///< integral of the outward normal
  double flux = 0;   ///< integral of the scalar product of position and outward normal

  SurfaceIntegrals& operator+=(const SurfaceIntegrals& other) {
    area += other.area;
    vector_area = vector_area + other.vector_area;
    flux += other.flux;
    return *this;
  }
};

/// An interval of the angle at the probe's centre, from the direction to the circle's centre
/// towards the second atom (radians). At 0, the probe's outline is nearest to the axis.
struct OutlineRange {
  double low = 0, high = 0;
};

/// The outline of the probe between its points of contact with two atoms.
struct SaddleOutline {
  double rho = 0;        ///< radius of the contact circle, angstrom
  double probe = 0;      ///< radius of the probe, angstrom
  OutlineRange contact;  ///< from the first atom to the second
  double cusp = 0;       ///< the outline between -cusp and cusp is beyond the axis
};

SaddleOutline make_outline(const ContactCircle& circle, double probe);

/// The border between the atoms of a saddle in the power diagram, as an angle of the outline.
struct SaddleBorder {
  double angle = 0, sine = 0;
};

/// Returns the border. The radii are those of both spheres, SAS or van der Waals.
SaddleBorder find_border(const SaddleOutline& outline, const ContactCircle& circle,
                         double first_radius, double second_radius);

/// The arc of a saddle: its angle about the axis, and the integral of the radial unit vector.
struct SweptArc {
  double angle = 0;
  Vec3 radial;
};

/// Returns the integrals over the part of a saddle patch with these angles of the outline, without
/// the part beyond the axis. Positions are relative to the circle's centre.
SurfaceIntegrals saddle_integrals(const SaddleOutline& outline, OutlineRange range, Vec3 axis,
                                  const SweptArc& arc);

}  // namespace eses::detail
