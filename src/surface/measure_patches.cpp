#include "surface/measure_patches.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "surface/cavity_list.hpp"
#include "surface/closure.hpp"
#include "surface/cluster_terms.hpp"
#include "surface/find_cavities.hpp"
#include "surface/measure_sums.hpp"
#include "surface/near_origin.hpp"
#include "surface/patch_sweep.hpp"
#include "surface/sphere_union.hpp"
#include "system/parallel.hpp"

namespace eses::detail {
namespace {

// How the accessibility of probe centres is decided.
struct Accessibility {
  bool has_slack = true;  // see SurfaceModel
  // The SAS spheres are smaller by this (angstrom), which opens the gaps that a probe just fits,
  // and separates spheres that just touch.
  double shrinkage = 0;
  // Placements within this distance of each other are the same one (angstrom).
  double same_placement = 0;
};

// These are tried until the patches fit together. A shrinkage can make other atoms degenerate, so
// there are two. Placements about as far apart as `same_placement` can be joined with some of their
// neighbours and not with others, so there are three distances.
constexpr std::array<Accessibility, 5> without_slack{{{false, tolerance::accessible, 1e-10},
                                                      {false, 2.3 * tolerance::accessible, 1e-10},
                                                      {false, tolerance::accessible, 1e-12},
                                                      {false, 2.3 * tolerance::accessible, 1e-12},
                                                      {false, tolerance::accessible, 1e-8}}};

// With a larger sum of forces, the next one is tried as well, and the best one is taken (square
// angstrom).
constexpr double small_force = 1e-8;

// Without slack and shrinkage, rounding decides about degenerate atoms.
constexpr std::array<Accessibility, 3> exact{
    {{false, 0, 1e-10}, {false, 0, 1e-8}, {false, 0, 1e-12}}};

// Values that differ by a larger fraction are those of different surfaces: a gap is open only with
// the shrinkage. Without such a gap, the shrinkage s moves ends of arcs by up to sqrt(2 R s), where
// a sphere of radius R grazes a circle, and changes the values by a fraction of about sqrt(s / R).
constexpr double max_effect_of_shrinkage = 1e-4;

// A measurement of a surface.
class PatchMeasurement {
 public:
  PatchMeasurement(const std::shared_ptr<ScheduledSurface>& scheduled,
                   const MeasureSettings& settings, double same_placement)
      : settings_(settings),
        same_placement_(same_placement),
        surface_(scheduled->surface),
        sweep_(scheduled, {same_placement, settings.cavities, settings.gradients}, settings.threads,
               settings.check),
        origin_(middle_of(surface_.atoms)),
        sums_(surface_, scheduled->schedule.patches(), settings, origin_),
        scratch_(static_cast<std::size_t>(settings.threads)) {
    if (surface_.has_slack) sweep_.stop_if_irregular();
    if (settings.cavities) finder_.emplace(surface_, origin_);
  }

  // Returns whether no decision depends on the slack, and all patches fit together. If a decision
  // depends on the slack, the result is incomplete.
  bool run() {
    if (!sweep_.run([&](const SweepLayer& layer) { return measure(layer); })) return false;
    sums_.finish();
    closure_ = closure_of(sums_, surface_);
    if (finder_) {
      components_ = finder_->finish(
          [&](AtomIndex i) {
            const AtomFace& face = sums_.faces()[i];
            return ComponentFinder::FaceIntegrals{face.solid_angle, face.boundary.vector_area,
                                                  sums_.faces().moment_of(i)};
          },
          settings_.check);
      finder_.reset();
      closure_ = worse_of(closure_, closure_of(components_, surface_));
    }
    return closure_.is_closed();
  }

  const Closure& closure() const { return closure_; }

  // Returns whether another measurement has the same cavities, as far as they are known, and its
  // values differ by no more than the effect of a shrinkage.
  bool is_near(const PatchMeasurement& other) const {
    const auto filled_count = [](const SurfaceModel& surface) {
      return surface.cavities ? surface.cavities->filled().size() : 0;
    };
    const Measures &a = sums_.result(), &b = other.sums_.result();
    const auto are_near = [](double x, double y, double scale) {
      return std::fabs(x - y) <= max_effect_of_shrinkage * scale;
    };
    return a.euler_number == b.euler_number && components_.count == other.components_.count &&
           filled_count(surface_) == filled_count(other.surface_) &&
           are_near(a.ses_area, b.ses_area, b.sas_area) &&
           are_near(a.sas_area, b.sas_area, b.sas_area) &&
           are_near(a.ses_volume, b.ses_volume, b.sas_volume) &&
           are_near(a.sas_volume, b.sas_volume, b.sas_volume);
  }

  // Throws Error if the patches do not fit together.
  void require_closed() const {
    if (!closure_.is_closed()) throw_open(closure_, find_open_atoms(surface_, same_placement_));
  }

  const SurfaceModel& surface() const { return surface_; }

  // Replaces the derivatives by those of another measurement.
  void take_gradients(PatchMeasurement& other) {
    sums_.result().gradients = std::move(other.sums_.result().gradients);
  }

  Measures take_result() {
    Measures& result = sums_.result();
    if (settings_.cavities)
      list_components(surface_, origin_, settings_, components_, result.cavities, result.pieces);
    if (surface_.cavities) result.filled_cavities = surface_.cavities->filled();
    return std::move(result);
  }
  Components take_components() { return std::move(components_); }

 private:
  bool measure(const SweepLayer& layer) {
    sums_.faces().find_caps(layer.schedule, settings_.threads);
    if (finder_) finder_->begin_layer(layer);
    // A single thread adds the terms of each cluster at once, while they are in the cache. Several
    // threads measure all clusters first.
    const std::uint32_t end = as_number(layer.end);
    const std::uint32_t at_once = settings_.threads == 1 ? 1 : end - as_number(layer.begin);
    for (std::uint32_t next = as_number(layer.begin); next < end; next += at_once)
      if (!measure_clusters(ClusterIndex{next}, std::min(at_once, end - next))) return false;
    if (finder_) finder_->end_layer();
    return true;
  }

  // Returns false if a decision depends on the slack.
  bool measure_clusters(ClusterIndex begin, std::uint32_t count) {
    const Patches& patches = sweep_.schedule().patches();
    const ClusterMeasurement measurement(sweep_.placements(), sums_.faces(), settings_, origin_,
                                         finder_ ? &*finder_ : nullptr);
    std::atomic<bool> is_regular_so_far = true;
    terms_.resize(std::max<std::size_t>(terms_.size(), count));
    parallel_for(count, settings_.threads, [&](std::int64_t k, int thread) {
      // A layer can take long. The calling thread serves signals.
      if (thread == 0 && settings_.check) settings_.check();
      const ClusterIndex cluster{as_number(begin) + static_cast<std::uint32_t>(k)};
      ClusterScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
      if (surface_.has_slack && !is_regular(surface_, patches.of_cluster(cluster), scratch))
        is_regular_so_far = false;
      if (!is_regular_so_far) return;
      measurement.measure(patches, cluster, scratch, terms_[static_cast<std::size_t>(k)]);
    });
    if (!is_regular_so_far) return false;
    // The order of the sums does not depend on the threads.
    for (std::uint32_t k = 0; k < count; ++k) {
      const ClusterTerms& terms = terms_[k];
      sums_.add(patches, ClusterIndex{as_number(begin) + k}, terms);
      if (!finder_) continue;
      for (const ComponentFinder::RootSums& sums : terms.roots) finder_->add(sums);
      for (const SharedCut& cut : terms.cuts) finder_->add(cut);
    }
    return true;
  }

  const MeasureSettings& settings_;
  double same_placement_;  // see Accessibility
  const SurfaceModel& surface_;
  PatchSweep sweep_;
  Vec3 origin_;
  MeasureSums sums_;
  std::optional<ComponentFinder> finder_;  // during the sweep, if there are cavities
  Components components_;
  Closure closure_;
  std::vector<ClusterScratch> scratch_;  // by thread
  std::vector<ClusterTerms> terms_;      // by cluster that is measured
};

// Schedules the measurement of a surface, without the cavities that are filled. All measurements of
// a molecule share the voids of its cavities.
std::unique_ptr<PatchMeasurement> make_measurement(const Molecule& molecule,
                                                   const MeasureSettings& settings,
                                                   const Accessibility& accessibility,
                                                   MeasuredVoids& voids) {
  SurfaceModel surface(molecule, settings.probe_radius - accessibility.shrinkage);
  surface.has_slack = accessibility.has_slack;
  if (settings.max_filled_void)
    surface.cavities = find_cavities(schedule_patches(surface, false), settings, voids);
  return std::make_unique<PatchMeasurement>(schedule_patches(surface, false), settings,
                                            accessibility.same_placement);
}

// Returns the measurement without slack and with shrinkage whose patches fit together best.
std::unique_ptr<PatchMeasurement> measure_with_shrinkage(const Molecule& molecule,
                                                         const MeasureSettings& settings,
                                                         MeasuredVoids& voids) {
  std::unique_ptr<PatchMeasurement> best;
  for (const Accessibility& accessibility : without_slack) {
    auto next = make_measurement(molecule, settings, accessibility, voids);
    next->run();
    if (best && next->closure().excess() >= best->closure().excess()) continue;
    best = std::move(next);
    if (best->closure().is_closed() && best->closure().force <= small_force) break;
  }
  return best;
}

// Returns a measurement without slack. Where a sphere grazes a circle, the shrinkage moves ends of
// arcs by its square root. The exact radii have no such error. They decide, unless a gap is open
// only with the shrinkage, or rounding decides.
std::unique_ptr<PatchMeasurement> measure_without_slack(const Molecule& molecule,
                                                        const MeasureSettings& settings,
                                                        MeasuredVoids& voids) {
  auto best = measure_with_shrinkage(molecule, settings, voids);
  best->require_closed();
  for (const Accessibility& accessibility : exact) {
    auto with_exact_radii = make_measurement(molecule, settings, accessibility, voids);
    if (!with_exact_radii->run() || !with_exact_radii->is_near(*best)) continue;
    with_exact_radii->take_gradients(*best);
    return with_exact_radii;
  }
  return best;
}

// Completes a measurement with slack, or returns one without slack if a decision depends on it.
std::unique_ptr<PatchMeasurement> measure_consistently(const Molecule& molecule,
                                                       const MeasureSettings& settings,
                                                       std::unique_ptr<PatchMeasurement> first,
                                                       MeasuredVoids voids = {}) {
  if (first->run()) return first;
  first.reset();
  return measure_without_slack(molecule, settings, voids);
}

std::unique_ptr<PatchMeasurement> measure_consistently(const Molecule& molecule,
                                                       const MeasureSettings& settings) {
  MeasuredVoids voids;
  auto first = make_measurement(molecule, settings, Accessibility(), voids);
  return measure_consistently(molecule, settings, std::move(first), std::move(voids));
}

}  // namespace

Measures measure_patches(const Molecule& molecule, const MeasureSettings& settings) {
  const MovedMolecule moved = near_origin(molecule, settings.threads);
  Measures measures = measure_consistently(moved.molecule, settings)->take_result();
  for (Cavity& cavity : measures.cavities)
    for (Vec3* point : {&cavity.centroid, &cavity.low, &cavity.high, &cavity.largest_probe_center})
      *point = *point + moved.offset;
  return measures;
}

Measures measure_sas(const Molecule& molecule, const MeasureSettings& settings) {
  Measures result;
  std::optional<SphereUnion> sas;
  if (!settings.max_filled_void)
    sas = measure_union(SurfaceModel(molecule, settings.probe_radius), settings.threads,
                        settings.check);
  if (sas) {
    result.sas_area = sas->area;
    result.sas_volume = sas->volume;
    if (settings.by_atom) result.by_atom.sas = std::move(sas->areas);
    return result;
  }
  Measures all = measure_patches(molecule, settings);
  result.sas_area = all.sas_area;
  result.sas_volume = all.sas_volume;
  result.by_atom.sas = std::move(all.by_atom.sas);
  result.filled_cavities = std::move(all.filled_cavities);
  return result;
}

Measures measure_kept_patches(const std::shared_ptr<ScheduledSurface>& kept,
                              const MeasureSettings& settings) {
  const Molecule& molecule = kept->surface.molecule;
  if (is_far_away(molecule)) return measure_patches(molecule, settings);
  kept->schedule.keep_passed();
  auto first = std::make_unique<PatchMeasurement>(kept, settings, 0);
  Measures measures = measure_consistently(molecule, settings, std::move(first))->take_result();
  kept->schedule.rewind();
  return measures;
}

SurfaceModel consistent_surface(const Molecule& molecule, const MeasureSettings& settings) {
  MeasureSettings with_cavities = settings;
  with_cavities.cavities = true;
  with_cavities.largest_probes = false;
  with_cavities.max_filled_void.reset();
  MeasuredVoids voids;  // nothing is filled
  return measure_with_shrinkage(molecule, with_cavities, voids)->surface();
}

Components find_components(const Molecule& molecule, const MeasureSettings& settings) {
  MeasureSettings with_cavities = settings;
  with_cavities.cavities = true;
  return measure_consistently(molecule, with_cavities)->take_components();
}

}  // namespace eses::detail
