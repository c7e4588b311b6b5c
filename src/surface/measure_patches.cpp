#include "surface/measure_patches.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/cap_list.hpp"
#include "geometry/sphere_part.hpp"
#include "surface/atom_loops.hpp"
#include "surface/cavity_list.hpp"
#include "surface/cavity_map.hpp"
#include "surface/components.hpp"
#include "surface/gradient_terms.hpp"
#include "surface/normal_cone.hpp"
#include "surface/patch_schedule.hpp"
#include "surface/patch_sums.hpp"
#include "surface/point_tree.hpp"
#include "surface/saddle.hpp"
#include "surface/tangent_spheres.hpp"
#include "surface/void_volumes.hpp"

namespace eses::detail {
namespace {

using std::numbers::pi;

// Number of clusters that are measured between two steps along z. It bounds the memory, and is much
// larger than the number of threads.
constexpr ClusterIndex clusters_per_layer = 128;

// How the accessibility of probe centres is decided.
struct Accessibility {
  bool has_slack = true;  // see SurfaceModel
  // The SAS spheres are smaller by this (angstrom), which opens the gaps that a probe just fits,
  // and separates spheres that just touch.
  double shrinkage = 0;
  // Placements within this distance of each other are the same one (angstrom).
  double same_placement = 0;
};

// Without slack, the measures are consistent unless rounding decides, or distances between almost
// equal placements are about as large as `same_placement`.
constexpr std::array<Accessibility, 5> without_slack{{{false, tolerance::accessible, 1e-10},
                                                      {false, 2.3 * tolerance::accessible, 1e-10},
                                                      {false, tolerance::accessible, 1e-12},
                                                      {false, 2.3 * tolerance::accessible, 1e-12},
                                                      {false, tolerance::accessible, 1e-8}}};

// Without slack and shrinkage, only rounding decides.
constexpr Accessibility exact{false, 0, 1e-10};

// The direction between two placements nearer to each other than this follows from a contact circle
// on which both are (angstrom). The difference of their centres has a relative error of the rounding
// error divided by their distance.
constexpr double close_placements = 1e-6;

// Placements nearer than this do not cut each other's patches if they are on no common contact
// circle (angstrom). doc/algorithm.md bounds the error.
constexpr double min_cutting_distance = 3e-8;

// A cap that misses a cone by less than this counts as one that cuts it (angstrom). The value is
// far above rounding errors, so no cap that cuts it is missed.
constexpr double meeting_slack = 1e-9;

// The total curvature of consistent measures is this close to an even number.
constexpr double max_curvature_error = 1e-6;

// The mean of unit vectors has a direction if their sum is longer than this.
constexpr double min_mean_length = 0.1;

// A contribution to the exposed part of the SAS sphere of an atom: the boundary term of an arc.
struct FaceTerm {
  AtomIndex atom;
  SpherePart part;
  Vec3 moment;  // term of the second moment; zero if the arc is known to be outside
};

// The part of a patch that belongs to an atom.
struct AtomShare {
  AtomIndex atom;
  double saddle, concave;  // square angstrom
};

// The results of a cluster.
struct ClusterTerms {
  PatchSums sums;
  std::vector<ComponentFinder::RootSums> roots;  // the same by root, if there are components
  std::vector<SharedCut> cuts;
  std::vector<FaceTerm> faces;
  std::vector<AtomShare> shares;
  GradientTerms gradients;
  bool is_smooth = true;  // see Gradients

  void clear() {
    gradients.clear();
    is_smooth = true;
    sums = {};
    roots.clear();
    cuts.clear();
    faces.clear();
    shares.clear();
  }

  // Adds the sums of an arc or a placement, and returns those of its root.
  ComponentFinder::RootSums& add(const PatchSums& patch, ComponentFinder::Node root) {
    sums += patch;
    auto found = std::find_if(roots.rbegin(), roots.rend(),
                              [&](const auto& entry) { return entry.root == root; });
    if (found == roots.rend()) {
      roots.push_back({root, {}});
      found = roots.rbegin();
    }
    found->sums += patch;
    return *found;
  }
};

// The exposed part of an atom's SAS sphere.
struct Face {
  SpherePart boundary;  // sum of the boundary terms
  double solid_angle = 0;
  bool is_whole = false;
  bool has_arcs = false;
};

// Scratch memory of a thread.
struct MeasureScratch {
  Patches::Scratch patches;
  SpherePartFinder finder;
  std::vector<SphericalCap> caps, shared_caps;
  std::vector<Vec3> toward;
  std::vector<AtomIndex> touched;
  std::vector<AtomIndex> borders;   // atoms whose caps follow those of the patch in `shared_caps`
  std::vector<std::uint32_t> node;  // placements that coincide
  std::vector<std::uint32_t> near;  // placements near a patch
  std::vector<std::uint32_t> cutters;        // placements that cut the cone
  std::vector<SphericalCap> cutter_caps;     // of the cutters
  std::vector<Vec3> tangent;                 // directions to placements that just touch the patch
  std::vector<PlacementParts> cutter_parts;  // parts of the cutters, if there are gradients
  SphereList neighbours;                     // of the face of an atom
  SpherePositions touched_neighbours;
};

// Returns the middle of the box around the centres.
Vec3 middle_of(std::span<const Atom> atoms) {
  Box box{atoms.front().center, atoms.front().center};
  for (const Atom& atom : atoms) box.include(atom.center);
  return 0.5 * box.low + 0.5 * box.high;
}

// Returns the unit vector from the centre of an arc's circle to the middle of the arc.
Vec3 middle_of(const Arc& arc, Vec3 axis) {
  if (arc.kind == ArcKind::full) return any_perpendicular(axis);
  const Vec3 sum = arc.start + arc.end;
  // If the ends are almost opposite, their sum has no direction.
  if (squared_norm(sum) < 0.01) return cross(axis, arc.start);
  return arc.kind == ArcKind::minor ? normalized(sum) : -normalized(sum);
}

// The result that a sweep is for.
enum class Sought : std::uint8_t { measures, components };

class PatchMeasurement {
 public:
  // Measures a surface, or finds its components. The patches need no bounds for it.
  PatchMeasurement(std::shared_ptr<ScheduledSurface> surface, const MeasureSettings& settings,
                   double same_placement, Sought sought = Sought::measures)
      : settings_(settings),
        sought_(sought),
        same_placement_(same_placement),
        scheduled_(std::move(surface)),
        surface_(scheduled_->surface),
        schedule_(scheduled_->schedule),
        origin_(middle_of(surface_.atoms)),
        weights_(settings.weights),
        faces_(surface_.atoms.size()),
        covering_atom_(surface_.atoms.size()),
        has_covering_atoms_(schedule_.patches().clusters().count()),
        scratch_(static_cast<std::size_t>(settings.threads)) {
    if (settings.gradients) {
      Gradients& all = result_.gradients;
      for (Gradient* gradient : gradients()) {
        const bool is_weighted =
            gradient == &all.weighted_sas_area || gradient == &all.weighted_ses_area;
        if (is_weighted && !has_weights()) continue;
        gradient->centers.resize(surface_.atoms.size());
        gradient->radii.resize(surface_.atoms.size());
      }
    }
    if (settings.cavities || sought == Sought::components) {
      components_.emplace(surface_, origin_);
      face_moments_.resize(surface_.atoms.size());
    }
    if (!divides_areas() || sought == Sought::components) return;
    for (auto* areas : {&result_.by_atom.sas, &result_.by_atom.convex, &result_.by_atom.saddle,
                        &result_.by_atom.concave})
      areas->resize(surface_.atoms.size());
  }

  // Returns whether no decision depends on the slack. Otherwise, the result is incomplete.
  bool run() {
    const AtomClusters& clusters = schedule_.patches().clusters();
    for (ClusterIndex begin = 0; begin < clusters.count();) {
      if (settings_.check) settings_.check();
      const ClusterIndex end = std::min(begin + clusters_per_layer, clusters.count());
      if (!measure_layer(begin, end)) return false;
      begin = end;
    }
    if (sought_ == Sought::measures) measure_faces();
    return true;
  }

  // The difference of the total curvature and the Euler number.
  double curvature_error() const {
    return std::fabs(result_.total_curvature - static_cast<double>(result_.euler_number));
  }

  Measures take_result() {
    if (components_) list_cavities();
    if (surface_.cavities) result_.filled_cavities = surface_.cavities->filled();
    return std::move(result_);
  }
  Components take_components();

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  double probe() const { return surface_.probe_radius; }
  bool has_weights() const { return !settings_.weights.empty(); }
  bool divides_areas() const { return settings_.by_atom || has_weights(); }
  // In the order of Quantity, followed by the volume of the SAS.
  std::array<Gradient*, quantity_count + 1> gradients() {
    Gradients& all = result_.gradients;
    return {&all.sas_area,          &all.ses_area,          &all.ses_volume,
            &all.weighted_sas_area, &all.weighted_ses_area, &all.sas_volume};
  }

  bool measure_layer(ClusterIndex begin, ClusterIndex end);
  bool measure_clusters(ClusterIndex begin, ClusterIndex end);
  void connect_patches(ClusterIndex begin, ClusterIndex end, double complete_to);
  void keep_placements(ClusterIndex begin, ClusterIndex end);
  void build_patches(double up_to);
  void index_placements();
  bool is_regular_cluster(ClusterIndex cluster, MeasureScratch& scratch) const;
  Vec3 middle_probe(const Arc& arc) const;
  void measure_cluster(ClusterIndex cluster, MeasureScratch& scratch, ClusterTerms& terms) const;
  void add_terms(ClusterIndex cluster, const ClusterTerms& terms);
  PatchSums add_arc(const Arc& arc, bool has_moments, ClusterTerms& terms) const;
  PatchSums add_placement(std::uint32_t number, MeasureScratch& scratch, ClusterTerms& terms) const;
  void record_shared_cut(std::uint32_t number, const SpherePart& part, MeasureScratch& scratch,
                         ClusterTerms& terms) const;
  void find_node(std::uint32_t number, std::vector<std::uint32_t>& node) const;
  void find_touched(std::span<const std::uint32_t> node, std::vector<AtomIndex>& touched,
                    std::vector<Vec3>& toward) const;
  void divide_node(std::span<const std::uint32_t> node);
  PlacementParts parts_of(std::uint32_t number) const;
  SpherePart find_triangle(const ProbePlacement& placement, MeasureScratch& scratch) const;
  SpherePart find_cone(std::uint32_t number, MeasureScratch& scratch) const;
  void add_cutters(std::uint32_t number, Vec3 center, double distance,
                   MeasureScratch& scratch) const;
  bool may_cut(Vec3 to_other, double squared, const MeasureScratch& scratch) const;
  SpherePart part_of_atom(AtomIndex owner, MeasureScratch& scratch) const;
  void share_among_atoms(const SpherePart& part, MeasureScratch& scratch,
                         ClusterTerms& terms) const;
  void add_patch_gradient(const ProbePlacement& placement, PlacementParts parts,
  void find_cutters(std::uint32_t number, MeasureScratch& scratch) const;
                          const SpherePart& part, MeasureScratch& scratch,
                          ClusterTerms& terms) const;
  std::optional<Vec3> direction_of_chord(std::uint32_t number, std::uint32_t other,
                                         MeasureScratch& scratch) const;
  bool has_tangent_patch(const MeasureScratch& scratch) const;
  void add_node_gradient(std::uint32_t number, MeasureScratch& scratch, ClusterTerms& terms) const;
  void add_face_gradient(AtomIndex i, double angle);
  void finish_areas_by_atom();
  void finish_gradients();
  void measure_faces();
  void list_cavities();
  bool is_filled_face(AtomIndex i, Vec3 direction) const;
  double face_angle(AtomIndex i, std::vector<AtomIndex>& found) const;

  const MeasureSettings& settings_;
  Sought sought_;
  double same_placement_;  // see Accessibility
  std::shared_ptr<ScheduledSurface> scheduled_;
  const SurfaceModel& surface_;
  PatchSchedule& schedule_;
  void find_covering_atoms();
  AtomIndex find_covering_atom(AtomPatches patches, AtomIndex atom) const;
  Vec3 covered_direction(AtomIndex i) const {
    return normalized(surface_.atoms[covering_atom_[i]].center - surface_.atoms[i].center);
  }
  Vec3 origin_;
  AreaWeights weights_, equal_weights_{{}};
  std::vector<Face> faces_;  // by atom
  PatchSums sums_;
  Measures result_;
  std::optional<ComponentFinder> components_;
  std::vector<Vec3> face_moments_;  // by atom; valid only for faces of cavities

  // The placements of the clusters that are complete.
  std::vector<const ProbePlacement*> placements_;
  // By atom with a face: the neighbour with a large cap. The axis of this cap is in no face.
  std::vector<AtomIndex> covering_atom_;
  std::vector<std::uint8_t> has_covering_atoms_;  // by cluster
  std::vector<Vec3> centers_;
  std::vector<std::uint32_t> first_placement_;  // by cluster
  std::vector<std::uint32_t> node_;             // by placement: the first one that coincides
  // The parts of placements that coincide, by the first one, if there are gradients.
  std::unordered_map<std::uint32_t, std::vector<ProbePlacement>> node_parts_;
  PointTree tree_;

  std::vector<MeasureScratch> scratch_;  // by thread
  std::vector<ClusterTerms> terms_;      // by cluster that is measured
};

bool PatchMeasurement::measure_layer(ClusterIndex begin, ClusterIndex end) {
  const AtomClusters& clusters = schedule_.patches().clusters();
  double high = -infinity;
  for (ClusterIndex cluster = begin; cluster < end; ++cluster)
    high = std::max(high, clusters.heights(cluster).high);
  // A concave patch is cut by placements up to twice the probe radius away.
  build_patches(high + probe() + look_up_slack);
  find_covering_atoms();
  index_placements();
  if (components_) connect_patches(begin, end, high + 2 * (probe() + look_up_slack));
  // A single thread adds the terms of each cluster at once, while they are in the cache. Several
  // threads measure all clusters first.
  const ClusterIndex at_once = settings_.threads == 1 ? 1 : end - begin;
  for (ClusterIndex next = begin; next < end; next += at_once)
    if (!measure_clusters(next, std::min(next + at_once, end))) return false;
  if (components_) {
    if (sought_ == Sought::components) keep_placements(begin, end);
    components_->end_layer();
  }
  double low = infinity;
  for (ClusterIndex cluster = end; cluster < clusters.count(); ++cluster)
    low = std::min(low, clusters.heights(cluster).low);
  schedule_.pass(low - probe() - look_up_slack);
  return true;
}

// Measures clusters of a layer. Returns false if a decision depends on the slack.
bool PatchMeasurement::measure_clusters(ClusterIndex begin, ClusterIndex end) {
  std::atomic<bool> is_regular = true;
  terms_.resize(std::max<std::size_t>(terms_.size(), end - begin));
  parallel_for(end - begin, std::min<int>(settings_.threads, static_cast<int>(end - begin)),
               [&](std::int64_t k, int thread) {
                 const auto index = static_cast<std::size_t>(k);
                 const ClusterIndex cluster = begin + static_cast<ClusterIndex>(k);
                 MeasureScratch& scratch = scratch_[static_cast<std::size_t>(thread)];
                 if (sought_ == Sought::measures && surface_.has_slack &&
                     !is_regular_cluster(cluster, scratch))
                   is_regular = false;
                 if (!is_regular) return;
                 terms_[index].clear();
                 measure_cluster(cluster, scratch, terms_[index]);
               });
  if (!is_regular) return false;
  // The order of the sums does not depend on the threads.
  for (ClusterIndex cluster = begin; cluster < end; ++cluster)
    add_terms(cluster, terms_[cluster - begin]);
  return true;
}

// All clusters that begin at or below `complete_to` are complete.
void PatchMeasurement::connect_patches(ClusterIndex begin, ClusterIndex end, double complete_to) {
  components_->begin_layer({schedule_, begin, end,
                            schedule_.patches().clusters().count_below(complete_to), placements_,
                            centers_, first_placement_, node_, settings_.threads});
}

void PatchMeasurement::keep_placements(ClusterIndex begin, ClusterIndex end) {
  for (ClusterIndex cluster = begin; cluster < end; ++cluster) {
    const std::size_t count = schedule_.patches().of_cluster(cluster).placements.size();
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t number = first_placement_[cluster] + k;
      components_->keep(components_->root_of_placement(number), centers_[number]);
    }
  }
}

void PatchMeasurement::build_patches(double up_to) {
  Patches& patches = schedule_.patches();
  std::vector<BuildStep> steps;
  while (!schedule_.is_ready(up_to)) {
    steps.clear();
    while (const auto step = schedule_.take(up_to)) steps.push_back(*step);
    const auto count = static_cast<std::int64_t>(steps.size());
    parallel_for(count, std::min<int>(settings_.threads, static_cast<int>(count)),
                 [&](std::int64_t k, int thread) {
                   const BuildStep& step = steps[static_cast<std::size_t>(k)];
                   if (step.kind == BuildStep::Kind::find_arcs) {
                     patches.find_arcs(step.cluster,
                                       scratch_[static_cast<std::size_t>(thread)].patches);
                   } else {
                     patches.complete(step.cluster);
                   }
                 });
    for (const BuildStep& step : steps) schedule_.finish(step);
  }
}

// Returns the neighbour with the first cap of a face that is large, or else with the largest one.
AtomIndex PatchMeasurement::find_covering_atom(AtomPatches patches, AtomIndex atom) const {
  constexpr double large_cosine = 0.5;
  const SasSphere sphere = surface_.sas_sphere(atom);
  AtomIndex largest = atom;
  double min_height = infinity;
  for (const AtomIndex k : patches.face_neighbours()) {
    const double height = make_cap(sphere, surface_.sas_sphere(k)).height;
    if (height >= min_height) continue;
    min_height = height;
    largest = k;
    if (height <= large_cosine * sphere.radius) break;
  }
  return largest;
}

// Finds the covering atoms of all complete clusters.
void PatchMeasurement::find_covering_atoms() {
  const Patches& patches = schedule_.patches();
  for_each_index(patches.clusters().count(), settings_.threads, [&](std::size_t index) {
    const auto cluster = static_cast<ClusterIndex>(index);
    if (has_covering_atoms_[cluster] != 0 || !schedule_.is_complete(cluster)) return;
    has_covering_atoms_[cluster] = 1;
    const std::span<const AtomIndex> members = patches.clusters().members(cluster);
    for (std::uint32_t m = 0; m < members.size(); ++m)
      if (patches.of_cluster(cluster).exposure[m] == AtomExposure::exposed)
        covering_atom_[members[m]] =
            find_covering_atom({&patches.of_cluster(cluster), m}, members[m]);
  });
}

  for (std::uint32_t k = 0; k < node_.size(); ++k) {
    if (node_[k] != k) continue;
    find_node(k, node);
    for (const std::uint32_t other : node) node_[other] = k;
    if (settings_.gradients && node.size() > 1) divide_node(node);
  }
}
void PatchMeasurement::index_placements() {
  const Patches& patches = schedule_.patches();
  placements_.clear();
  centers_.clear();
  first_placement_.resize(patches.clusters().count());
  for (ClusterIndex cluster = 0; cluster < patches.clusters().count(); ++cluster) {
    first_placement_[cluster] = static_cast<std::uint32_t>(placements_.size());
    if (!schedule_.is_complete(cluster)) continue;
    for (const ProbePlacement& placement : patches.of_cluster(cluster).placements) {
      placements_.push_back(&placement);
      centers_.push_back(placement.center);
    }
  }
  // Only measures need the placements that cut a patch. Without a probe there are none.
  const bool has_cuts = probe() > 0 && sought_ == Sought::measures;
  if (has_cuts || !surface_.has_slack) tree_.reset(centers_);
  node_.resize(placements_.size());
  std::iota(node_.begin(), node_.end(), 0U);
  if (surface_.has_slack) return;
  node_parts_.clear();
  std::vector<std::uint32_t> node;

// Replaces `node` by the placements that coincide with a placement, directly or through others.
void PatchMeasurement::find_node(std::uint32_t number, std::vector<std::uint32_t>& node) const {
  node.assign(1, number);
  for (std::size_t k = 0; k < node.size(); ++k)
    tree_.for_each_within(centers_[node[k]], same_placement_, [&](std::uint32_t other) {
      if (std::find(node.begin(), node.end(), other) == node.end()) node.push_back(other);
    });
}

// Replaces `touched` by the atoms that the placements touch, and `toward` by the directions to
// them.
void PatchMeasurement::find_touched(std::span<const std::uint32_t> node,
                                    std::vector<AtomIndex>& touched,
                                    std::vector<Vec3>& toward) const {
  touched.clear();
  for (const std::uint32_t k : node)
    touched.insert(touched.end(), placements_[k]->atoms.begin(), placements_[k]->atoms.end());
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  toward.clear();
  for (const AtomIndex i : touched)
    toward.push_back(normalized(surface_.atoms[i].center - centers_[node.front()]));
}

// Finds the parts of placements that coincide: those into which they divide if the atoms grow, each
// of them much more than all later ones. Their cones divide the cone.
void PatchMeasurement::divide_node(std::span<const std::uint32_t> node) {
  std::vector<AtomIndex> touched;
  std::vector<Vec3> toward;
  find_touched(node, touched, toward);
  std::vector<ProbePlacement>& parts = node_parts_[node.front()];
  for (const auto& [a, b, c] : divide_cone(toward))
    parts.push_back({centers_[node.front()], {touched[a], touched[b], touched[c]}});
}

PlacementParts PatchMeasurement::parts_of(std::uint32_t number) const {
  const auto found = node_parts_.find(number);
  return found != node_parts_.end() ? PlacementParts(found->second)
                                    : PlacementParts(placements_[number], 1);
}

// Returns whether no decision about the cluster's patches depends on the slack. If the circles of
// several pairs of atoms coincide, the arcs of all pairs coincide, too. Then the probe at the
// middle of each arc touches further atoms, which are neighbours of the face of the first one.
bool PatchMeasurement::is_regular_cluster(ClusterIndex cluster, MeasureScratch& scratch) const {
  const ClusterPatches& patches = schedule_.patches().of_cluster(cluster);
  if (!patches.is_regular) return false;
  SphereList& spheres = scratch.neighbours;
  SpherePositions& touched = scratch.touched_neighbours;
  for (std::size_t m = 0; m + 1 < patches.arc_begin.size(); ++m) {
    const AtomPatches of_atom{&patches, static_cast<std::uint32_t>(m)};
    if (of_atom.arcs().empty()) continue;
    spheres.clear();
    for (const AtomIndex k : of_atom.face_neighbours()) spheres.push_back(surface_.sas_sphere(k));
    for (const Arc& arc : of_atom.arcs()) {
      const Vec3 center = middle_probe(arc);
      find_near_box({center, center}, 2 * tolerance::accessible, spheres, touched);
      if (touched.count > 1) return false;  // more than the second atom of the arc
    }
  }
  return true;
}

// Returns the centre of the probe at the middle of an arc.
Vec3 PatchMeasurement::middle_probe(const Arc& arc) const {
  const ContactCircle circle =
      make_contact_circle(surface_.sas_sphere(arc.first), surface_.sas_sphere(arc.second));
  return circle.center + circle.radius * middle_of(arc, circle.axis);
}

void PatchMeasurement::measure_cluster(ClusterIndex cluster, MeasureScratch& scratch,
                                       ClusterTerms& terms) const {
  const ClusterPatches& patches = schedule_.patches().of_cluster(cluster);
  if (sought_ == Sought::components) {
    for (std::uint32_t k = 0; k < patches.placements.size(); ++k) {
      const std::uint32_t number = first_placement_[cluster] + k;
      terms.add({}, components_->root_of_placement(number)).box.include(centers_[number]);
    }
    return;
  }
  if (settings_.gradients && surface_.has_slack)
    terms.is_smooth = !has_tangent_spheres(surface_, weights_, schedule_.patches(), cluster);
  for (std::size_t k = 0; k < patches.arcs.size(); ++k) {
    const ComponentFinder::Node root = components_ ? components_->root_of_arc(cluster, k) : 0;
    // Only cavities have a centroid.
    const bool has_moments = components_ && !components_->is_known_outside(root);
    terms.add(add_arc(patches.arcs[k], has_moments, terms), root);
  }
  const std::uint32_t first = first_placement_[cluster];
  for (std::uint32_t k = first; k < first + patches.placements.size(); ++k)
    terms.add(add_placement(k, scratch, terms), components_ ? components_->root_of_placement(k) : 0)
        .box.include(centers_[k]);
}

void PatchMeasurement::add_terms(ClusterIndex cluster, const ClusterTerms& terms) {
  const Patches& patches = schedule_.patches();
  const std::span<const AtomIndex> members = patches.clusters().members(cluster);
  for (std::size_t m = 0; m < members.size(); ++m)
    faces_[members[m]].is_whole = patches.of_cluster(cluster).exposure[m] == AtomExposure::exposed;
  sums_ += terms.sums;
  for (const FaceTerm& term : terms.faces) {
    Face& face = faces_[term.atom];
    face.boundary += term.part;
    face.has_arcs = true;
    if (components_) face_moments_[term.atom] = face_moments_[term.atom] + term.moment;
  }
  if (components_) {
    for (const ComponentFinder::RootSums& sums : terms.roots) components_->add(sums);
    for (const SharedCut& cut : terms.cuts) components_->add(cut);
  }
  for (const GradientTerm& term : terms.gradients.atoms) {
    Gradient& gradient = *gradients()[term.quantity];
    gradient.centers[term.atom] = gradient.centers[term.atom] + term.center;
    gradient.radii[term.atom] += term.sas_radius;
  }
  if (settings_.gradients) {
    for (std::size_t q = 0; q < quantity_count; ++q)
      gradients()[q]->probe += terms.gradients.probe[q];
    result_.gradients.are_smooth = result_.gradients.are_smooth && terms.is_smooth;
  }
  for (const AtomShare& share : terms.shares) {
    result_.by_atom.saddle[share.atom] += share.saddle;
    result_.by_atom.concave[share.atom] += share.concave;
  }
}

PatchSums PatchMeasurement::add_arc(const Arc& arc, bool has_moments, ClusterTerms& terms) const {
  const SasSphere first = surface_.sas_sphere(arc.first), second = surface_.sas_sphere(arc.second);
  const ContactCircle circle = make_contact_circle(first, second);
  const SweptArc swept = sweep(arc, circle.axis);
  const SphericalCap first_cap{circle.axis, circle.first_height / first.radius};
  const SphericalCap second_cap{-circle.axis, circle.second_height / second.radius};
  const RimArc first_rim{0, swept.angle, arc.start, arc.end};
  const RimArc second_rim{0, swept.angle, arc.end, arc.start};
  terms.faces.push_back(
      {arc.first, boundary_term(first_cap, first_rim, covered_direction(arc.first)), {}});
  terms.faces.push_back(
      {arc.second, boundary_term(second_cap, second_rim, covered_direction(arc.second)), {}});
  if (has_moments) {
    const auto moment = [&](const SphericalCap& cap, const RimArc& rim, const SasSphere& sphere) {
      return second_moment_term(cap, rim, sphere.center - origin_);
    };
    terms.faces.end()[-2].moment = moment(first_cap, first_rim, first);
    terms.faces.end()[-1].moment = moment(second_cap, second_rim, second);
  }
  PatchSums sums;
  sums.curvature -= swept.angle * (first_cap.cosine + second_cap.cosine);
  const SaddleOutline outline = make_outline(circle, std::max(0.0, probe()));
  const SurfaceIntegrals whole = saddle_integrals(outline, outline.contact, circle.axis, swept);
  const double distance = circle.first_height + circle.second_height;
  if (settings_.gradients && first.radius + second.radius - distance > separated_overlap) {
    const ArcShape shape{arc, circle, swept};
    add_arc_area_gradient(surface_, shape, outline, equal_weights_, sas_area_quantity,
                          ses_area_quantity, terms.gradients);
    add_arc_volume_gradient(surface_, shape, whole, terms.gradients);
    if (has_weights())
      add_arc_area_gradient(surface_, shape, outline, weights_, weighted_sas_area_quantity,
                            weighted_ses_area_quantity, terms.gradients);
  }
  if (probe() <= 0) return sums;
  sums.saddle += whole.area;
  sums.flux += whole.flux + dot(circle.center - origin_, whole.vector_area);
  if (!divides_areas()) return sums;
  const SaddleBorder border = find_border(outline, circle, first.radius, second.radius);
  const double first_area =
      saddle_integrals(outline, {outline.contact.low, border.point}, circle.axis, swept).area;
  terms.shares.push_back({arc.first, first_area, 0});
  terms.shares.push_back({arc.second, std::max(0.0, whole.area - first_area), 0});
  return sums;
}

PatchSums PatchMeasurement::add_placement(std::uint32_t number, MeasureScratch& scratch,
                                          ClusterTerms& terms) const {
  PatchSums sums;
  if (node_[number] != number) return sums;
  const Vec3 center = centers_[number];
  SpherePart part = find_cone(number, scratch);
  sums.curvature += part.solid_angle;
  if (probe() <= 0 || part.solid_angle == 0) return sums;
  find_cutters(number, scratch);
  if (!scratch.cutters.empty()) part = scratch.finder.find(scratch.caps);
  if (components_) record_shared_cut(number, part, scratch, terms);
  sums.concave += probe() * probe() * part.solid_angle;
  sums.flux -=
      probe() * probe() * (dot(center - origin_, part.vector_area) + probe() * part.solid_angle);
  if (divides_areas()) share_among_atoms(part, scratch, terms);
  if (!settings_.gradients) return sums;
  if (has_tangent_patch(scratch)) terms.is_smooth = false;
  scratch.cutter_parts.clear();
  for (const std::uint32_t cutter : scratch.cutters)
    scratch.cutter_parts.push_back(parts_of(cutter));
  if (scratch.touched.size() > 3) {
    add_node_gradient(number, scratch, terms);
  } else {
    scratch.finder.find(scratch.caps);
    const ProbePlacement& placement = *placements_[number];
    add_patch_gradient(placement, {&placement, 1}, part, scratch, terms);
  }
  return sums;
}

// Adds the derivatives at a placement that touches more than three atoms: those of its parts.
void PatchMeasurement::add_node_gradient(std::uint32_t number, MeasureScratch& scratch,
                                         ClusterTerms& terms) const {
  const auto first_cutter =
      scratch.caps.end() - static_cast<std::ptrdiff_t>(scratch.cutters.size());
  const std::vector<SphericalCap> cutter_caps(first_cutter, scratch.caps.end());
  const PlacementParts parts = parts_of(number);
  for (const ProbePlacement& placement : parts) {
    find_triangle(placement, scratch);
    scratch.caps.insert(scratch.caps.end(), cutter_caps.begin(), cutter_caps.end());
    const SpherePart part = scratch.finder.find(scratch.caps);
    add_patch_gradient(placement, parts, part, scratch, terms);
  }
}

// Adds the derivatives of areas and volumes by the motion of a placement that touches three atoms.
// It is one of `parts`. `scratch.finder` has the arcs that bound its patch.
void PatchMeasurement::add_patch_gradient(const ProbePlacement& placement, PlacementParts parts,
                                          const SpherePart& part, MeasureScratch& scratch,
                                          ClusterTerms& terms) const {
  add_saddle_end_gradient(surface_, placement, equal_weights_, ses_area_quantity, terms.gradients);
  add_concave_area_gradient(
      surface_,
      {placement, part, scratch.caps, scratch.finder.arcs(), scratch.cutter_parts, parts, 0, {}}, 1,
      ses_area_quantity, terms.gradients);
  add_concave_volume_gradient(surface_, placement, part, terms.gradients);
  if (!has_weights()) return;
  add_saddle_end_gradient(surface_, placement, weights_, weighted_ses_area_quantity,
                          terms.gradients);
  for (const AtomIndex owner : scratch.touched) {
    const SpherePart own = part_of_atom(owner, scratch);
    add_concave_area_gradient(surface_,
                              {placement, own, scratch.shared_caps, scratch.finder.arcs(),
                               scratch.cutter_parts, parts, owner, scratch.borders},
                              weights_[owner], weighted_ses_area_quantity, terms.gradients);
  }
}

// Keeps a patch that placements cut which may belong to other components.
void PatchMeasurement::record_shared_cut(std::uint32_t number, const SpherePart& part,
                                         MeasureScratch& scratch, ClusterTerms& terms) const {
  const ComponentFinder::Node root = components_->root_of_placement(number);
  const std::vector<std::uint32_t>& cutters = scratch.cutters;
  if (std::all_of(cutters.begin(), cutters.end(), [&](std::uint32_t cutter) {
        return components_->root_of_placement(cutter) == root;
      }))
    return;
  SharedCut cut{root, centers_[number] - origin_, 0, scratch.caps, {}, part};
  cut.bound_count = static_cast<std::uint32_t>(scratch.caps.size() - cutters.size());
  for (const std::uint32_t cutter : cutters)
    cut.cutters.push_back(components_->root_of_placement(cutter));
  terms.cuts.push_back(std::move(cut));
}

// Sets the touched atoms, the directions to them and the caps that bound their cone.
SpherePart PatchMeasurement::find_triangle(const ProbePlacement& placement,
                                           MeasureScratch& scratch) const {
  scratch.touched.assign(placement.atoms.begin(), placement.atoms.end());
  std::array<Vec3, 3> toward;
  for (std::size_t q = 0; q < 3; ++q)
    toward[q] = normalized(surface_.atoms[placement.atoms[q]].center - placement.center);
  scratch.toward.assign(toward.begin(), toward.end());
  const auto& [a, b, c] = toward;
  const double sign = dot(a, cross(b, c)) < 0 ? 1 : -1;
  scratch.caps.clear();
  for (const Vec3 normal : {cross(a, b), cross(b, c), cross(c, a)}) {
    const double length = norm(normal);
    if (length == 0) return {};
    scratch.caps.push_back({(sign / length) * normal, 0});
  }
  return triangle_part(a, b, c);
}

// Does the same for all placements that coincide with this one.
SpherePart PatchMeasurement::find_cone(std::uint32_t number, MeasureScratch& scratch) const {
  if (surface_.has_slack) return find_triangle(*placements_[number], scratch);
  find_node(number, scratch.node);
  if (scratch.node.size() == 1) return find_triangle(*placements_[number], scratch);
  find_touched(scratch.node, scratch.touched, scratch.toward);
  switch (bound_cone(scratch.toward, scratch.caps)) {
    case ConeShape::flat:
      return {};
    case ConeShape::whole:
      return {4 * pi, {}};
    case ConeShape::solid:
      break;
  }
  return scratch.finder.find(scratch.caps);
}

// Returns whether the cap towards another placement may reach into the cone that the caps bound.
// The cone's direction nearest to the axis is the axis itself, its projection onto a bounding
// plane, or an edge. Lengths are those of `to_other`, whose square is `squared`.
bool PatchMeasurement::may_cut(Vec3 to_other, double squared, const MeasureScratch& scratch) const {
  const double limit = 4 * probe() * probe();
  bool is_within = true;
  for (const SphericalCap& plane : scratch.caps) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) continue;
    is_within = false;
    if ((squared - height * height) * limit <= squared * squared) return false;
  }
  if (is_within) return true;
  const double min_along = squared / (2 * probe()) - meeting_slack;
  for (const Vec3 edge : scratch.toward)
    if (dot(to_other, edge) > min_along) return true;
  return std::any_of(scratch.caps.begin(), scratch.caps.end(), [&](const SphericalCap& plane) {
    const double height = dot(to_other, plane.axis);
    if (height <= 0) return false;
    const Vec3 projection = to_other - height * plane.axis;
    return std::all_of(scratch.caps.begin(), scratch.caps.end(), [&](const SphericalCap& other) {
      return dot(projection, other.axis) <= meeting_slack;
    });
  });
}

// Finds the other placements that cut the cone which the caps bound, and then adds their caps. They
// are nearer than `distance` to `center`. Also finds those that touch the patch from outside.
void PatchMeasurement::add_cutters(std::uint32_t number, Vec3 center, double distance,
                                   MeasureScratch& scratch) const {
  const Vec3 from = centers_[number];
  const double limit = 4 * probe() * probe();
// Finds the placements that cut the cone which `scratch.caps` bound, and adds their caps. They are
// nearer than twice the probe radius. If no edge of the cone is more than a right angle away from
// the mean of the edges, the cone lies in the cap around the mean that reaches to the farthest edge,
// because this cap is convex. Points of the patch are then nearer to the point on the mean than the
// chord of the cap, and a placement that cuts the patch is nearer to some point of it than the
// probe radius.
void PatchMeasurement::find_cutters(std::uint32_t number, MeasureScratch& scratch) const {
  const Vec3 center = centers_[number];
  Vec3 mean;
  for (const Vec3 direction : scratch.toward) mean = mean + direction;
  const double length = norm(mean);
  double cosine = length > min_mean_length ? 1 : -1;
  if (cosine > 0) mean = (1 / length) * mean;
  for (const Vec3 direction : scratch.toward) cosine = std::min(cosine, dot(mean, direction));
  if (cosine <= 0) return add_cutters(number, center, 2 * probe(), scratch);
  const double chord = std::sqrt(2 * (1 - cosine));
  add_cutters(number, center + probe() * mean, probe() * (1 + chord), scratch);
}

// Returns the direction from a placement to another one that is close to it, or nothing if no contact
// circle has both. The chord of a circle is at right angles to its axis, and to the line from its
// centre to the middle of the chord. `scratch.touched` are the atoms of the first placement.
std::optional<Vec3> PatchMeasurement::direction_of_chord(std::uint32_t number, std::uint32_t other,
                                                         MeasureScratch& scratch) const {
  const Vec3 from = centers_[number], to = centers_[other], middle = 0.5 * (from + to);
  std::vector<AtomIndex> common;
  std::vector<std::uint32_t> node;
  find_node(other, node);
  for (const AtomIndex i : scratch.touched)
    if (std::any_of(node.begin(), node.end(), [&](std::uint32_t k) {
          const auto& atoms = placements_[k]->atoms;
          return std::find(atoms.begin(), atoms.end(), i) != atoms.end();
        }))
      common.push_back(i);
  Vec3 direction;
  double max_distance = 0.5 * norm(to - from);  // the chord is a diameter
  bool is_found = false;
  for (std::size_t a = 0; a < common.size(); ++a)
    for (std::size_t b = a + 1; b < common.size(); ++b) {
      const ContactCircle circle =
          make_contact_circle(surface_.sas_sphere(common[a]), surface_.sas_sphere(common[b]));
      const Vec3 across = cross(circle.axis, middle - circle.center);
      const double distance = norm(across);
      is_found = true;
      if (distance <= max_distance) continue;
      max_distance = distance;
      direction = (1 / distance) * across;
    }
  if (!is_found) return std::nullopt;
  if (direction == Vec3()) return normalized(to - from);
  return dot(direction, to - from) < 0 ? -direction : direction;
}

  const double reach = distance + tolerance::touching;
  scratch.cutters.clear();
  scratch.tangent.clear();
  scratch.near.clear();
  tree_.for_each_within(center, reach, [&](std::uint32_t k) { scratch.near.push_back(k); });
  for (const std::uint32_t other : scratch.near) {
    if (other == number || node_[other] != other) continue;
    Vec3 to_other = centers_[other] - from;
    const double squared = squared_norm(to_other);
  scratch.cutter_caps.clear();
    if (std::fabs(squared - limit) < 4 * probe() * tolerance::touching)
      scratch.tangent.push_back((1 / (2 * probe())) * to_other);
    if (squared >= limit || squared == 0) continue;
    const double length = std::sqrt(squared);
    Vec3 direction = (1 / length) * to_other;
    if (length < close_placements && !surface_.has_slack) {
      const std::optional<Vec3> chord = direction_of_chord(number, other, scratch);
      if (!chord && length < min_cutting_distance) continue;
      if (chord) direction = *chord;
      to_other = length * direction;
    }
    if (!may_cut(to_other, squared, scratch)) continue;
    scratch.cutters.push_back(other);
  }
  scratch.caps.insert(scratch.caps.end(), scratch.cutter_caps.begin(), scratch.cutter_caps.end());
}
    scratch.cutter_caps.push_back({direction, length / (2 * probe())});

// Returns whether another placement just touches the patch that `scratch.caps` bound.
bool PatchMeasurement::has_tangent_patch(const MeasureScratch& scratch) const {
  const double slack = tolerance::touching / probe();
  return std::any_of(scratch.tangent.begin(), scratch.tangent.end(), [&](Vec3 direction) {
    return std::none_of(scratch.caps.begin(), scratch.caps.end(), [&](const SphericalCap& cap) {
      return dot(direction, cap.axis) > cap.cosine + slack;
    });
  });
}

// Returns the part of a concave patch that belongs to an atom. A direction n belongs to the touched
// atom with the smallest value of radius - n . (center of the atom - center of the probe).
SpherePart PatchMeasurement::part_of_atom(AtomIndex owner, MeasureScratch& scratch) const {
  scratch.shared_caps = scratch.caps;
  scratch.borders.clear();
  for (const AtomIndex other : scratch.touched) {
    if (other == owner) continue;
    const Vec3 toward = surface_.atoms[other].center - surface_.atoms[owner].center;
    const double length = norm(toward);
    scratch.borders.push_back(other);
    scratch.shared_caps.push_back(
        {(1 / length) * toward,
         (surface_.atoms[other].radius - surface_.atoms[owner].radius) / length});
  }
  return scratch.finder.find(scratch.shared_caps);
}

void PatchMeasurement::share_among_atoms(const SpherePart& part, MeasureScratch& scratch,
                                         ClusterTerms& terms) const {
  if (part.solid_angle == 0) return;
  double rest = part.solid_angle;
  for (std::size_t a = 0; a < scratch.touched.size(); ++a) {
    double share = std::max(0.0, rest);
    if (a + 1 < scratch.touched.size()) {
      share = part_of_atom(scratch.touched[a], scratch).solid_angle;
      rest -= share;
    }
    terms.shares.push_back({scratch.touched[a], 0, probe() * probe() * share});
  }
}

bool PatchMeasurement::is_filled_face(AtomIndex i, Vec3 direction) const {
  if (!surface_.cavities) return false;
  const WallAtom* const atom = surface_.cavities->find(i);
  return atom != nullptr && surface_.cavities->is_filled(atom->component_at(direction));
}

double PatchMeasurement::face_angle(AtomIndex i, std::vector<AtomIndex>& found) const {
  const Face& face = faces_[i];
  if (!face.has_arcs) return face.is_whole ? 4 * pi : 0;
  return solid_angle_of(face.boundary.solid_angle, [&](Vec3 direction) {
    if (is_filled_face(i, direction)) return false;
    const SasSphere sphere = surface_.sas_sphere(i);
    const Vec3 point = sphere.center + sphere.radius * direction;
    surface_.tree().find_reaching(point, probe() + look_up_slack, found);
    return std::none_of(found.begin(), found.end(), [&](AtomIndex k) {
      const SasSphere other = surface_.sas_sphere(k);
      return k != i && !surface_.molecule.is_contained(k) &&
             norm(point - other.center) < other.radius;
    });
  });
}

// Adds the derivatives of areas by the radii of faces, and of volumes by the motion of faces.
void PatchMeasurement::add_face_gradient(AtomIndex i, double angle) {
  const double r = surface_.atoms[i].radius, R = r + probe();
  const Vec3 vector = faces_[i].boundary.vector_area;
  Gradients& all = result_.gradients;
  all.sas_area.radii[i] += 2 * R * angle;
  all.sas_volume.radii[i] = R * R * angle;
  all.sas_volume.centers[i] = (R * R) * vector;
  all.ses_volume.centers[i] = all.ses_volume.centers[i] + (r * r) * vector;
  if (has_weights()) all.weighted_sas_area.radii[i] += 2 * weights_[i] * R * angle;
}

// Adds the derivatives by the probe radius at constant radii of the atoms: all SAS radii grow. The
// radii of the convex patches do not.
void PatchMeasurement::finish_gradients() {
  for (Gradient* gradient : gradients())
    gradient->probe += std::accumulate(gradient->radii.begin(), gradient->radii.end(), 0.0);
  Gradients& all = result_.gradients;
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
    const double r = surface_.atoms[i].radius, angle = faces_[i].solid_angle;
    all.ses_area.radii[i] += 2 * r * angle;
    all.ses_volume.radii[i] += r * r * angle;
    if (has_weights()) all.weighted_ses_area.radii[i] += 2 * weights_[i] * r * angle;
  }
  all.are_smooth = all.are_smooth && surface_.has_slack;
}

// Adds the weighted areas, and removes the areas by atom unless they are wanted.
void PatchMeasurement::finish_areas_by_atom() {
  AtomAreas& areas = result_.by_atom;
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
    result_.weighted_sas_area += weights_[i] * areas.sas[i];
    result_.weighted_ses_area +=
        weights_[i] * (areas.convex[i] + areas.saddle[i] + areas.concave[i]);
  }
  if (!settings_.by_atom) areas = {};
}

void PatchMeasurement::measure_faces() {
  const std::span<const Atom> atoms = surface_.atoms;
  std::vector<FaceSums> sums(loop_range_count(atoms.size()));
  for_loop_ranges(
      atoms.size(), settings_.threads, [&](std::size_t range, AtomIndex begin, AtomIndex end) {
        std::vector<AtomIndex> found;
        for (AtomIndex i = begin; i < end; ++i) {
          const double angle = faces_[i].solid_angle = face_angle(i, found);
          if (angle == 0) continue;
          const double along = dot(atoms[i].center - origin_, faces_[i].boundary.vector_area);
          const FaceSums face = face_sums(atoms[i].radius, probe(), angle, along);
          sums[range] += face;
          if (settings_.gradients) add_face_gradient(i, angle);
          if (!divides_areas()) continue;
          result_.by_atom.sas[i] = face.sas_area;
          result_.by_atom.convex[i] = face.convex_area;
        }
      });
  FaceSums total;
  for (const FaceSums& sum : sums) total += sum;
  result_.sas_area = total.sas_area;
  result_.sas_volume = std::max(0.0, total.sas_flux / 3);
  result_.ses_areas = {total.convex_area, sums_.saddle, sums_.concave};
  result_.ses_area = result_.ses_areas.total();
  result_.ses_volume = std::max(0.0, (total.convex_flux + sums_.flux) / 3);
  result_.total_curvature = (total.solid_angle + sums_.curvature) / (2 * pi);
  if (settings_.gradients) finish_gradients();
  if (has_weights()) finish_areas_by_atom();
  result_.euler_number = 2 * std::llround(result_.total_curvature / 2);
}

Components PatchMeasurement::take_components() {
  std::function<ComponentFinder::FaceIntegrals(AtomIndex)> integrals_of;
  if (sought_ == Sought::measures)
    integrals_of = [&](AtomIndex i) {
      return ComponentFinder::FaceIntegrals{faces_[i].solid_angle, faces_[i].boundary.vector_area,
                                            face_moments_[i]};
    };
  Components components = components_->finish(integrals_of);
  components_.reset();
  return components;
}

void PatchMeasurement::list_cavities() {
  const Components components = take_components();
  list_components(surface_, origin_, settings_.probe_radius, settings_.threads, components,
                  settings_.largest_probes, result_.cavities, result_.pieces);
}

SurfaceModel make_surface(const Molecule& molecule, double probe_radius,
                          const Accessibility& accessibility) {
  SurfaceModel surface(molecule, probe_radius - accessibility.shrinkage);
  surface.has_slack = accessibility.has_slack;
  return surface;
}

std::shared_ptr<ScheduledSurface> schedule_surface(const SurfaceModel& surface, bool has_bounds) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return std::make_shared<ScheduledSurface>(surface, HeightRange{-infinity, infinity}, has_bounds);
}

// Finds the cavities of a surface whose patches have not been built.
std::shared_ptr<const CavityMap> find_cavities(const std::shared_ptr<ScheduledSurface>& surface,
                                               const MeasureSettings& settings) {
  PatchMeasurement sweep(surface, settings, 0, Sought::components);
  sweep.run();
  const Components components = sweep.take_components();
  const SurfaceModel& model = surface->surface;
  const std::vector<Cavity> cavities = measure_voids(model, settings, components);
  std::vector<ComponentNumber> number_of(components.count);
  std::vector<double> volumes;
  for (const std::size_t c : order_by_void(cavities)) {
    volumes.push_back(cavities[c].void_volume);
    number_of[c + 1] = static_cast<ComponentNumber>(volumes.size());
  }
  const auto map = std::make_shared<CavityMap>(model, components, number_of, std::move(volumes));
  if (settings.max_filled_void) map->fill(*settings.max_filled_void);
  if (settings.kept_component) map->keep_only(*settings.kept_component);
  return map;
}

// Schedules the measurement of a surface, without the cavities that are filled.
std::unique_ptr<PatchMeasurement> make_measurement(const Molecule& molecule,
                                                   const MeasureSettings& settings,
                                                   const Accessibility& accessibility) {
  SurfaceModel surface = make_surface(molecule, settings.probe_radius, accessibility);
  if (settings.max_filled_void)
    surface.cavities = find_cavities(schedule_surface(surface, false), settings);
  return std::make_unique<PatchMeasurement>(schedule_surface(surface, false), settings,
                                            accessibility.same_placement);
}

// Completes a measurement with slack, or returns one without slack if a decision depends on it.
std::unique_ptr<PatchMeasurement> measure_consistently(const Molecule& molecule,
                                                       const MeasureSettings& settings,
                                                       std::unique_ptr<PatchMeasurement> best) {
  if (best->run()) return best;
  best.reset();
  for (const Accessibility& accessibility : without_slack) {
    auto next = make_measurement(molecule, settings, accessibility);
    next->run();
    if (best && next->curvature_error() >= best->curvature_error()) continue;
    best = std::move(next);
    if (best->curvature_error() < max_curvature_error) break;
  }
  return best;
}

std::unique_ptr<PatchMeasurement> measure_consistently(const Molecule& molecule,
                                                       const MeasureSettings& settings) {
  return measure_consistently(molecule, settings,
                              make_measurement(molecule, settings, Accessibility()));
}

Measures measure_here(const Molecule& molecule, const MeasureSettings& settings) {
  return measure_consistently(molecule, settings)->take_result();
}

// Coordinates larger than this are rounded too much for placements that are close together
// (angstrom).
constexpr double far_away = 1024;

bool is_far_away(const Molecule& molecule) { return norm(middle_of(molecule.atoms())) >= far_away; }

}  // namespace

// The difference of a large coordinate and a whole number near it has no rounding error.
Measures measure_patches(const Molecule& molecule, const MeasureSettings& settings) {
  if (!is_far_away(molecule)) return measure_here(molecule, settings);
  const std::span<const Atom> atoms = molecule.atoms();
  Vec3 middle = middle_of(atoms);
  for (std::size_t axis = 0; axis < 3; ++axis) middle[axis] = std::round(middle[axis]);
  std::vector<Atom> moved(atoms.begin(), atoms.end());
  for (Atom& atom : moved) atom.center = atom.center - middle;
  Measures measures = measure_here(Molecule(std::move(moved), {}, settings.threads), settings);
  for (Cavity& cavity : measures.cavities)
    for (Vec3* point : {&cavity.centroid, &cavity.low, &cavity.high, &cavity.largest_probe_center})
      *point = *point + middle;
  return measures;
}

std::shared_ptr<ScheduledSurface> schedule_patches(const Molecule& molecule, double probe_radius) {
  return schedule_surface(make_surface(molecule, probe_radius, {}), true);
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

FoundCavities find_cavities(const Molecule& molecule, const MeasureSettings& settings,
                            bool keeps_patches) {
  auto surface = schedule_surface(make_surface(molecule, settings.probe_radius, {}), keeps_patches);
  if (keeps_patches) surface->schedule.keep_passed();
  FoundCavities found{find_cavities(surface, settings), nullptr};
  if (!keeps_patches) return found;
  surface->schedule.rewind();
  if (found.map->has_filled()) {
    surface->surface.cavities = found.map;
    Patches& patches = surface->schedule.patches();
    for_each_index(patches.clusters().count(), settings.threads, [&](std::size_t cluster) {
      patches.drop_filled(static_cast<ClusterIndex>(cluster));
    });
  }
  found.patches = std::move(surface);
  return found;
}

Components find_components(const Molecule& molecule, const MeasureSettings& settings) {
  MeasureSettings with_cavities = settings;
  with_cavities.cavities = true;
  return measure_consistently(molecule, with_cavities)->take_components();
}

}  // namespace eses::detail
