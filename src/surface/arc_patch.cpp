#include "surface/arc_patch.hpp"

#include <algorithm>
#include <limits>

namespace eses::detail {

ArcPatch make_arc_patch(const SurfaceModel& surface, const Arc& arc) {
  ArcPatch patch;
  patch.first = surface.sas_sphere(arc.first);
  patch.second = surface.sas_sphere(arc.second);
  patch.circle = make_contact_circle(patch.first, patch.second);
  const ContactCircle& circle = patch.circle;
  patch.swept = sweep(arc, circle.axis);
  patch.first_cap = {circle.axis, circle.first_height / patch.first.radius};
  patch.second_cap = {-circle.axis, circle.second_height / patch.second.radius};
  patch.first_rim = {0, patch.swept.angle, arc.start, arc.end};
  patch.second_rim = {0, patch.swept.angle, arc.end, arc.start};
  patch.outline = make_outline(circle, std::max(0.0, surface.probe_radius));
  if (surface.probe_radius > 0)
    patch.saddle = saddle_integrals(patch.outline, patch.outline.contact, circle.axis, patch.swept);
  return patch;
}

double ArcPatch::rounding() const {
  const double distance = circle.first_height + circle.second_height;
  const double sum = first.radius + second.radius;
  return std::numeric_limits<double>::epsilon() * sum * sum / distance * sum * swept.angle;
}

double area_of_first_atom(const ArcPatch& patch) {
  const SaddleBorder border =
      find_border(patch.outline, patch.circle, patch.first.radius, patch.second.radius);
  return saddle_integrals(patch.outline, {patch.outline.contact.low, border.point},
                          patch.circle.axis, patch.swept)
      .area;
}

}  // namespace eses::detail
