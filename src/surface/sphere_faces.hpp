#pragma once
/// The faces into which accessible arcs divide a SAS sphere.
///
/// Two arcs of a sphere bound the same face if a path on the sphere leads from one to the other
/// without leaving the face. All arcs that bound a face from one side are connected by placements,
/// so only arcs in different sets need a test. The test follows great circles through a fixed point
/// and through an arc of each set. Between an arc where such a circle leaves the caps and the next
/// one, it runs in a face, and both arcs bound it. The fixed point is in the same face for all
/// circles. This finds all connections: what a circle meets between leaving a face and the next
/// return to it lies behind a single set of that face.

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "geometry/sphere_part.hpp"
#include "surface/atom_patches.hpp"
#include "surface/saddle.hpp"
#include "system/disjoint_sets.hpp"

namespace eses::detail {

/// An accessible arc on a SAS sphere.
struct SphereArc {
  SphericalCap cap;  ///< cap of the neighbour, whose rim the arc is on
  RimArc arc;        ///< the index of the cap is not used
};

/// Returns the angle of an arc, and the integral of its radial unit vector.
SweptArc sweep(const Arc& arc, Vec3 axis);

/// Returns the arc as it bounds the first, or the second, of its two SAS spheres. `circle` is the
/// contact circle of both.
SphereArc on_first_sphere(const Arc& arc, const ContactCircle& circle, const SasSphere& first);
SphereArc on_second_sphere(const Arc& arc, const ContactCircle& circle, const SasSphere& second);

/// Returns the position of an arc that bounds the face in this direction from the sphere's centre.
/// Returns nothing if the direction is in a cap, or if rounding decides.
std::optional<std::size_t> find_arc_of_face(std::span<const SphereArc> arcs, Vec3 direction);

/// Returns the position of the arc nearest to a direction. If the direction is not in a cap, this
/// arc bounds its face: the way to the nearest arc crosses no other one. There must be an arc.
std::size_t find_nearest_arc(std::span<const SphereArc> arcs, Vec3 direction);

/// The arcs of a sphere, each with a label that tells its face from others.
template <class Label>
struct LabelledArcs {
  std::vector<SphereArc> arcs;
  std::vector<Label> labels;  ///< by arc

  void add(const SphereArc& arc, Label label) {
    arcs.push_back(arc);
    labels.push_back(label);
  }
  /// Returns the label of the face in a direction, as find_arc_of_face.
  std::optional<Label> label_of_face(Vec3 direction) const {
    const auto found = find_arc_of_face(arcs, direction);
    return found ? std::optional(labels[*found]) : std::nullopt;
  }
  /// Returns the label of the arc nearest to a direction, as find_nearest_arc.
  Label nearest_label(Vec3 direction) const { return labels[find_nearest_arc(arcs, direction)]; }
};

/// Calls `unite` for pairs of labels of arcs that bound the same face, such that all arcs of each
/// face are connected. Arcs in the same set must have equal labels.
void connect_faces(const LabelledArcs<DisjointSets::Element>& arcs,
                   const std::function<void(DisjointSets::Element, DisjointSets::Element)>& unite);

/// Returns the direction to the middle of an arc.
Vec3 middle_of(const SphereArc& arc);

}  // namespace eses::detail
