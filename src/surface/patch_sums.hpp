#pragma once
/// Sums over patches, from which areas, volumes and Euler numbers follow. Positions are relative to
/// an origin near the molecule, in angstrom.

#include "eses/atoms.hpp"

namespace eses::detail {

/// Integrals of the outward normal n and of x cross n over a surface. They are the force and the
/// torque of a uniform pressure, and the sums of the derivatives of the volume by the centres of
/// the atoms (Hadamard). A closed surface has neither.
struct PressureLoad {
  Vec3 force;           ///< square angstrom
  Vec3 torque;          ///< cubic angstrom
  double rounding = 0;  ///< estimate of the rounding error of `force`, where it may be large

  PressureLoad& operator+=(const PressureLoad& other) {
    force = force + other.force;
    torque = torque + other.torque;
    rounding += other.rounding;
    return *this;
  }
};

/// Sums over arcs and placements.
struct PatchSums {
  double saddle = 0, concave = 0;  ///< areas, square angstrom
  double flux = 0;                 ///< integral of position . normal over both kinds of patches
  double curvature = 0;            ///< integral of the curvature over arcs and placements
  double curvature_rounding = 0;   ///< estimate of the rounding error of `curvature`
  PressureLoad load;               ///< of both kinds of patches

  PatchSums& operator+=(const PatchSums& other) {
    saddle += other.saddle;
    concave += other.concave;
    flux += other.flux;
    curvature += other.curvature;
    curvature_rounding += other.curvature_rounding;
    load += other.load;
    return *this;
  }
};

/// Sums over faces.
struct FaceSums {
  double solid_angle = 0;
  double sas_area = 0, sas_flux = 0;
  double convex_area = 0, convex_flux = 0;
  PressureLoad sas_load, convex_load;

  FaceSums& operator+=(const FaceSums& other) {
    solid_angle += other.solid_angle;
    sas_area += other.sas_area;
    sas_flux += other.sas_flux;
    convex_area += other.convex_area;
    convex_flux += other.convex_flux;
    sas_load += other.sas_load;
    convex_load += other.convex_load;
    return *this;
  }
};

/// Returns the load of a part of a sphere with this centre and vector area, both in angstrom.
inline PressureLoad sphere_load(Vec3 center, Vec3 vector_area) {
  return {vector_area, cross(center, vector_area), 0};
}

/// Returns the sums over a part of an atom's sphere with this solid angle. `vector_area` is that of
/// the part on the unit sphere.
inline FaceSums face_sums(double atom_radius, double probe_radius, Vec3 center, double solid_angle,
                          Vec3 vector_area) {
  const double r = atom_radius, R = r + probe_radius, along = dot(center, vector_area);
  return {solid_angle,
          R * R * solid_angle,
          R * R * (R * solid_angle + along),
          r * r * solid_angle,
          r * r * (r * solid_angle + along),
          sphere_load(center, R * R * vector_area),
          sphere_load(center, r * r * vector_area)};
}

}  // namespace eses::detail
