#include "surface/closure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "eses/error.hpp"
#include "surface/patch_sweep.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Bounds of the rounding errors of the total curvature divided by 2 pi. A fault changes it by about
// 1, so the bounds stay far below. Without slack, arcs end at placements that are counted as one
// but are apart, and are seen under an angle that is larger on a small circle.
constexpr double min_curvature_error = 1e-8, min_error_without_slack = 1e-6,
                 max_curvature_error = 1e-3;

// Bounds of the rounding errors of the force. Those of almost equal atoms, whose contact circles
// are not known well, are added.
constexpr double max_force_error = 1e-7;      // square angstrom
constexpr double max_relative_force = 1e-12;  // of the area

// Lengths of boundaries that differ by more than this do not fit (angstrom).
constexpr double max_open_gap = 1e-5;

// An error names at most this number of atoms.
constexpr std::size_t max_named_atoms = 20;

double largest_of(Vec3 v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

// Half the diagonal of the box around the SAS.
double extent_of(const SurfaceModel& surface) {
  Box box{surface.atoms.front().center, surface.atoms.front().center};
  double radius = 0;
  for (const Atom& atom : surface.atoms) {
    box.include(atom.center);
    radius = std::max(radius, atom.radius);
  }
  return 0.5 * norm(box.high - box.low) + radius + std::max(0.0, surface.probe_radius);
}

Closure make_closure(double curvature, double curvature_rounding, double area, double extent,
                     bool has_slack, const PressureLoad& ses, const PressureLoad& sas) {
  Closure closure;
  closure.curvature = std::fabs(curvature - 2 * std::round(curvature / 2));
  closure.force = std::max(largest_of(ses.force), largest_of(sas.force));
  closure.torque = std::max(largest_of(ses.torque), largest_of(sas.torque));
  const double min_error = has_slack ? min_curvature_error : min_error_without_slack;
  closure.max_curvature =
      std::min(min_error + curvature_rounding + ses.rounding, max_curvature_error);
  closure.max_force = max_force_error + max_relative_force * area + ses.rounding;
  closure.max_torque = closure.max_force * std::max(1.0, extent);
  return closure;
}

// Compares the boundaries of neighbouring patches.
class GapFinder {
 public:
  GapFinder(const SurfaceModel& surface, double same_placement)
      : scheduled_(std::make_shared<ScheduledSurface>(surface, everywhere(), false)),
        sweep_(scheduled_, {same_placement, false, false}, 1, check_),
        gaps_(surface.atoms.size()) {}

  std::vector<AtomIndex> find() {
    sweep_.run([&](const SweepLayer& layer) {
      for (ClusterIndex cluster = layer.begin; cluster < layer.end; ++cluster) {
        for (const Arc& arc : sweep_.schedule().patches().of_cluster(cluster).arcs) add_arc(arc);
        for (PlacementNumber k = layer.placements.first_of_cluster(cluster);
             k < layer.placements.end_of_cluster(cluster); ++k)
          if (surface().probe_radius > 0 && layer.placements.is_first(k)) compare(k);
      }
      return true;
    });
    for (AtomIndex i = 0; i < gaps_.size(); ++i)
      if (norm(gaps_[i]) > max_open_gap) open_.push_back(i);
    std::sort(open_.begin(), open_.end());
    open_.erase(std::unique(open_.begin(), open_.end()), open_.end());
    return std::move(open_);
  }

 private:
  static HeightRange everywhere() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {-infinity, infinity};
  }
  const SurfaceModel& surface() const { return sweep_.surface(); }

  // The arcs of a face are closed curves.
  void add_arc(const Arc& arc) {
    const double radius =
        make_contact_circle(surface().sas_sphere(arc.first), surface().sas_sphere(arc.second))
            .radius;
    const Vec3 gap = arc.kind == ArcKind::full ? Vec3() : radius * (arc.end - arc.start);
    gaps_[arc.first] = gaps_[arc.first] + gap;
    gaps_[arc.second] = gaps_[arc.second] - gap;
  }

  // Replaces `angles_` by the angle of the boundary on each cap of a patch.
  void find_angles(ConcavePatch& patch, PlacementNumber number) {
    set_cone(sweep_.placements(), number, scratch_, patch);
    const Vec3 center = sweep_.placements().center(number);
    find_near_large(sweep_.placements(), {center, center}, scratch_.near);
    find_near_small(sweep_.placements(), {center, center}, scratch_.near);
    cut_cone(sweep_.placements(), scratch_, patch);
    scratch_.finder.find(patch.caps);
    angles_.assign(patch.caps.size(), 0);
    for (const RimArc& arc : scratch_.finder.arcs()) angles_[arc.cap] += arc.angle;
  }

  // Compares the boundary of a concave patch with those of the saddles and of its cutters.
  void compare(PlacementNumber number) {
    find_angles(patch_, number);
    if (patch_.cone.solid_angle == 0) return;
    const double p = surface().probe_radius;
    if (patch_.touched.size() == 3)
      for (std::size_t q = 0; q < 3; ++q) {
        const double length = length_of_saddle(patch_.touched[q], patch_.touched[(q + 1) % 3]);
        if (p * std::fabs(angles_[q] - length) > max_open_gap) add_touched(patch_);
      }
    const std::vector<double> angles = angles_;
    for (std::size_t k = 0; k < patch_.cutters.size(); ++k) {
      const SphericalCap cap = patch_.caps[patch_.plane_count() + k];
      find_angles(other_, patch_.cutters[k]);
      double expected = 0;
      for (std::size_t l = 0; l < other_.cutters.size(); ++l)
        if (other_.cutters[l] == number) expected += angles_[other_.plane_count() + l];
      const double difference = std::fabs(angles[patch_.plane_count() + k] - expected);
      if (p * std::sqrt((1 - cap.cosine) * (1 + cap.cosine)) * difference <= max_open_gap) continue;
      add_touched(patch_);
      add_touched(other_);
    }
  }

  // Returns the angle of the end of a saddle, without the part beyond the axis.
  double length_of_saddle(AtomIndex i, AtomIndex j) const {
    const ContactCircle circle =
        make_contact_circle(surface().sas_sphere(i), surface().sas_sphere(j));
    const SaddleOutline outline = make_outline(circle, surface().probe_radius);
    double length = 0;
    outline.for_each_part(outline.contact,
                          [&](const OutlineRange& part) { length += part.length(); });
    return length;
  }

  void add_touched(const ConcavePatch& patch) {
    open_.insert(open_.end(), patch.touched.begin(), patch.touched.end());
  }

  CheckCallback check_;
  std::shared_ptr<ScheduledSurface> scheduled_;
  PatchSweep sweep_;
  std::vector<Vec3> gaps_;  // by atom: between the ends of its arcs
  std::vector<AtomIndex> open_;
  ConcavePatch patch_, other_;
  ConcaveScratch scratch_;
  std::vector<double> angles_;
};

}  // namespace

double Closure::excess() const {
  double largest = 0;
  for (const double ratio : {curvature / max_curvature, force / max_force, torque / max_torque})
    largest = ratio <= largest ? largest : ratio;  // NaN is larger than all numbers
  return std::isnan(largest) ? std::numeric_limits<double>::infinity() : largest;
}

Closure worse_of(const Closure& a, const Closure& b) { return a.excess() < b.excess() ? b : a; }

Closure closure_of(const MeasureSums& sums, const SurfaceModel& surface) {
  return make_closure(sums.result().total_curvature, sums.curvature_rounding(),
                      sums.result().sas_area, extent_of(surface), surface.has_slack,
                      sums.ses_load(), sums.sas_load());
}

Closure closure_of(const Components& components, const SurfaceModel& surface) {
  struct Sums {
    PatchSums patches;
    FaceSums faces;
  };
  std::vector<Sums> sums(components.count);
  for (const Wall& wall : components.walls) {
    if (wall.component == Components::outside && !wall.atom) continue;  // it bounds nothing
    sums[as_number(wall.component)].patches += wall.patches;
    sums[as_number(wall.component)].faces += wall.faces;
  }
  const double extent = extent_of(surface);
  Closure worst;
  for (std::size_t c = 0; c < sums.size(); ++c) {
    auto& [patches, faces] = sums[c];
    patches += components.corrections[c];
    PressureLoad ses = faces.convex_load;
    ses += patches.load;
    const double curvature = (faces.solid_angle + patches.curvature) / (2 * std::numbers::pi);
    const Closure closure = make_closure(curvature, patches.curvature_rounding, faces.sas_area,
                                         extent, surface.has_slack, ses, faces.sas_load);
    worst = c == 0 ? closure : worse_of(worst, closure);
  }
  return worst;
}

std::vector<AtomIndex> find_open_atoms(const SurfaceModel& surface, double same_placement) {
  return GapFinder(surface, same_placement).find();
}

void throw_open(const Closure& closure, const std::vector<AtomIndex>& atoms) {
  std::string message = formatted(
      "the patches of the surface do not fit together: sum of the forces {:.2g} square angstrom, "
      "of the torques {:.2g} cubic angstrom, error of the Euler number {:.2g}",
      closure.force, closure.torque, closure.curvature);
  if (!atoms.empty()) message += "; at atoms";
  for (std::size_t k = 0; k < std::min(atoms.size(), max_named_atoms); ++k)
    message += formatted("{} {}", k == 0 ? "" : ",", atoms[k]);
  if (atoms.size() > max_named_atoms)
    message += formatted(" and {} more", atoms.size() - max_named_atoms);
  if (!atoms.empty()) message += " (counted from 0)";
  throw Error(message + "; please report this molecule");
}

}  // namespace eses::detail
