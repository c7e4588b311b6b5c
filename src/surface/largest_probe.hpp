#pragma once
/// The largest sphere that fits into a cavity.

#include <span>

#include "geometry/box.hpp"
#include "surface/components.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

struct LargestProbe {
  Vec3 center;
  double radius = 0;  ///< angstrom
};

/// Finds the largest sphere with its centre in a component that overlaps no atom, by branch and
/// bound: the radius of the largest sphere around a point changes by at most the distance by which
/// the point moves. The error is at most 1e-9 angstrom, unless the search reaches its limit of
/// evaluations. A probe that fits only by the tolerance is the largest one, with its own radius.
/// `centers` is a box around the component, and `atoms` are the atoms that its probes touch. Calls
/// `check` repeatedly, if it is not empty.
LargestProbe find_largest_probe(const SurfaceModel& surface, const Components& components,
                                ComponentIndex component, const Box& centers,
                                std::span<const AtomIndex> atoms, const CheckCallback& check);

}  // namespace eses::detail
