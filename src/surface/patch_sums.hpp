#pragma once
/// Sums over patches, from which areas, volumes and Euler numbers follow. Positions are relative to
/// an origin near the molecule, in angstrom.

#include "eses/atoms.hpp"

namespace eses::detail {

/// Sums over arcs and placements.
struct PatchSums {
  double saddle = 0, concave = 0;  ///< areas, square angstrom
  double flux = 0;                 ///< integral of position . normal over both kinds of patches
  double curvature = 0;            ///< integral of the curvature over arcs and placements

  PatchSums& operator+=(const PatchSums& other) {
    saddle += other.saddle;
    concave += other.concave;
    flux += other.flux;
    curvature += other.curvature;
    return *this;
  }
};

/// Sums over faces.
struct FaceSums {
  double solid_angle = 0;
  double sas_area = 0, sas_flux = 0;
  double convex_area = 0, convex_flux = 0;

  FaceSums& operator+=(const FaceSums& other) {
    solid_angle += other.solid_angle;
    sas_area += other.sas_area;
    sas_flux += other.sas_flux;
    convex_area += other.convex_area;
    convex_flux += other.convex_flux;
    return *this;
  }
};

/// Returns the sums over a part of an atom's sphere with this solid angle. `along` is the scalar
/// product of the position of the atom's centre and the part's vector area on the unit sphere.
inline FaceSums face_sums(double atom_radius, double probe_radius, double solid_angle,
                          double along) {
  const double r = atom_radius, R = r + probe_radius;
  return {solid_angle, R * R * solid_angle, R * R * (R * solid_angle + along), r * r * solid_angle,
          r * r * (r * solid_angle + along)};
}

}  // namespace eses::detail
