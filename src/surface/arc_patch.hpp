#pragma once
/// The patches at one accessible arc: its saddle, and its part of the boundary of two faces.

#include "geometry/contact_circle.hpp"
#include "geometry/sphere_part.hpp"
#include "surface/saddle.hpp"
#include "surface/sphere_faces.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// An arc with the integrals over its saddle.
struct ArcPatch {
  SasSphere first, second;
  ContactCircle circle;
  SweptArc swept;
  SphericalCap first_cap, second_cap;  ///< on the SAS sphere of each atom, that of the other one
  RimArc first_rim, second_rim;        ///< the arc as it bounds the two faces
  SaddleOutline outline;
  SurfaceIntegrals saddle;  ///< relative to the circle's centre

  /// Estimate of the rounding error of the load of the patches at the arc (square angstrom). The
  /// height of the circle is (R_1 + R_2) (R_1 - R_2) / (2 d) + d / 2 for the distance d.
  double rounding() const;
  /// The integral of the curvature along the arc.
  double curvature() const { return -swept.angle * (first_cap.cosine + second_cap.cosine); }
};

ArcPatch make_arc_patch(const SurfaceModel& surface, const Arc& arc);

/// Returns the area of the part of the saddle that belongs to the first atom.
double area_of_first_atom(const ArcPatch& patch);

}  // namespace eses::detail
