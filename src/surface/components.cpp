#include "surface/components.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/arc_sector.hpp"
#include "surface/atom_loops.hpp"
#include "surface/connect_walls.hpp"

namespace eses::detail {
namespace {

// An arc ends at the nearest placement of its atoms within this distance (angstrom). It is far
// above the errors of positions.
constexpr double end_search = 1e-5;

// Without slack, placements and ends of arcs this close together are connected (angstrom). Rounding
// may hide the arcs between them. With slack, three arcs end at each placement.
constexpr double connected = tolerance::touching;
static_assert(connected <= end_search, "placements are searched within end_search only");

// A node of an atom from here on is an index of a divided atom.
constexpr DisjointSets::Element divided_begin = 0x80000000;

struct ArcMatch {
  std::uint32_t arc;
  PlacementNumber placement;
};

// Finds the placements at the ends of the arcs of a cluster, or only of the arcs whose atoms are
// measured in this layer.
void find_ends(const SurfaceModel& surface, const ClusterPatches& patches, const SweepLayer& layer,
               bool has_all_arcs, std::vector<ArcMatch>& matches) {
  matches.clear();
  for (std::uint32_t k = 0; k < patches.arcs.size(); ++k) {
    const Arc& arc = patches.arcs[k];
    if (arc.kind == ArcKind::full || !(has_all_arcs || layer.is_measured(arc))) continue;
    const ContactCircle circle =
        make_contact_circle(surface.sas_sphere(arc.first), surface.sas_sphere(arc.second));
    for (const Vec3 radial : {arc.start, arc.end}) {
      const Vec3 end = circle.center + circle.radius * radial;
      double min_squared = std::numeric_limits<double>::infinity();
      ArcMatch best{k, {}};
      layer.placements.tree().for_each_within(end, end_search, [&](std::uint32_t found) {
        const PlacementNumber placement{found};
        const double squared = squared_norm(layer.placements.center(placement) - end);
        if (!surface.has_slack && squared < connected * connected)
          matches.push_back({k, placement});
        // The lowest one of several at the same distance is chosen.
        if (std::pair(squared, placement) >= std::pair(min_squared, best.placement)) return;
        const auto& atoms = layer.placements.placement(placement).atoms;
        const auto touches = [&](AtomIndex atom) {
          return std::find(atoms.begin(), atoms.end(), atom) != atoms.end();
        };
        if (!touches(arc.first) || !touches(arc.second)) return;
        min_squared = squared;
        best.placement = placement;
      });
      if (min_squared < std::numeric_limits<double>::infinity()) matches.push_back(best);
    }
  }
}

template <class Action>
void for_each_complete(const SweepLayer& layer, Action&& action) {
  for (ClusterIndex cluster{}; cluster < layer.complete_end; ++cluster)
    if (layer.schedule.is_complete(cluster))
      action(cluster, layer.schedule.patches().of_cluster(cluster));
}

// Calls `action(cluster, arc)` for the arcs of complete clusters that a placement of their two
// atoms lies on. If a probe just fits between the atoms, it need not be an end of these arcs: the
// third atom blocks less of the circle than the tolerance.
template <class Action>
void for_each_arc_through(const SurfaceModel& surface, const SweepLayer& layer,
                          const ProbePlacement& placement, Action&& action) {
  const auto& [a, b, c] = placement.atoms;
  for (const auto& [first, second] : {std::pair(a, b), {a, c}, {b, c}}) {
    const auto [cluster, member] = layer.schedule.patches().clusters().position_of(first);
    if (!layer.schedule.is_complete(cluster)) continue;
    const ClusterPatches& patches = layer.schedule.patches().of_cluster(cluster);
    const ContactCircle circle =
        make_contact_circle(surface.sas_sphere(first), surface.sas_sphere(second));
    for (std::uint32_t k = patches.arc_begin[member]; k < patches.arc_begin[member + 1]; ++k) {
      const Arc& arc = patches.arcs[k];
      if (arc.second == second &&
          projects_onto_arc(make_arc_sector(circle.axis, arc.kind, arc.start, arc.end),
                            placement.center - circle.center))
        action(cluster, k);
    }
  }
}

bool is_split(const DisjointSets& sets, std::span<const DisjointSets::Element> nodes) {
  return std::any_of(nodes.begin(), nodes.end(), [&](DisjointSets::Element node) {
    return sets.root(node) != sets.root(nodes.front());
  });
}

}  // namespace

Box empty_box() {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

Box united(const Box& a, const Box& b) {
  Box box = a;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(a.low[axis], b.low[axis]);
    box.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return box;
}

std::vector<AtomIndex> touched_atoms(const SurfaceModel& surface, Vec3 center) {
  std::vector<AtomIndex> found;
  surface.tree().find_reaching(center, surface.probe_radius + look_up_slack, found);
  std::erase_if(found, [&](AtomIndex i) {
    const SasSphere sphere = surface.sas_sphere(i);
    return std::fabs(norm(center - sphere.center) - sphere.radius) > tolerance::touching ||
           surface.molecule.is_contained(i);
  });
  std::sort(found.begin(), found.end());
  return found;
}

std::optional<WallIndex> Components::wall_at(AtomIndex atom, Vec3 direction) const {
  const std::uint32_t wall = wall_of_atom_[atom];
  if (wall == no_wall) return std::nullopt;
  if (wall < split_begin_) return WallIndex{wall};
  return divided_[wall - split_begin_].arcs.label_of_face(direction);
}

std::optional<WallIndex> Components::nearest_wall(AtomIndex atom, Vec3 direction) const {
  const std::uint32_t wall = wall_of_atom_[atom];
  if (wall == no_wall) return std::nullopt;
  if (wall < split_begin_) return WallIndex{wall};
  return divided_[wall - split_begin_].arcs.nearest_label(direction);
}

ComponentFinder::ComponentFinder(const SurfaceModel& surface, Vec3 origin)
    : surface_(surface), origin_(origin), node_of_atom_(surface.atoms.size(), no_node) {
  const auto bottom = [](const Atom& atom) { return atom.center.z - atom.radius; };
  const auto lowest =
      std::min_element(surface.atoms.begin(), surface.atoms.end(),
                       [&](const Atom& a, const Atom& b) { return bottom(a) < bottom(b); });
  if (lowest != surface.atoms.end())
    lowest_atom_ = static_cast<AtomIndex>(lowest - surface.atoms.begin());
}

void ComponentFinder::begin_layer(const SweepLayer& layer) {
  add_nodes(layer);
  connect_arcs(layer);
  connect_faces_of_atoms(layer);
  find_outside();
}

void ComponentFinder::add_nodes(const SweepLayer& layer) {
  const std::size_t clusters = layer.schedule.patches().clusters().count();
  first_node_.resize(clusters, no_node);
  are_connected_.resize(clusters);
  node_of_placement_.resize(layer.placements.count());
  for_each_complete(layer, [&](ClusterIndex cluster, const ClusterPatches& patches) {
    Node& first = first_node_[as_number(cluster)];
    if (first == no_node)
      first = sets_.add(static_cast<Node>(patches.arcs.size() + patches.placements.size()));
    Node node = first + static_cast<Node>(patches.arcs.size());
    for (PlacementNumber k = layer.placements.first_of_cluster(cluster);
         k < layer.placements.end_of_cluster(cluster); ++k)
      node_of_placement(k) = node++;
  });
}

// Connects each arc with the placements at its ends. If other clusters are not complete yet, only
// the arcs that are measured in this layer are connected, and the others in a later layer.
void ComponentFinder::connect_arcs(const SweepLayer& layer) {
  const AtomClusters& clusters = layer.schedule.patches().clusters();
  std::vector<ClusterIndex> chosen;
  for_each_complete(layer, [&](ClusterIndex cluster, const ClusterPatches&) {
    if (are_connected_[as_number(cluster)] == 0) chosen.push_back(cluster);
  });
  std::vector<std::vector<ArcMatch>> matches(chosen.size());
  for_each_index(chosen.size(), layer.threads, [&](std::size_t k) {
    const double high = clusters.heights(chosen[k]).high + look_up_slack;
    const bool has_all_arcs = clusters.end_below(high) <= layer.complete_end;
    find_ends(surface_, layer.schedule.patches().of_cluster(chosen[k]), layer, has_all_arcs,
              matches[k]);
    are_connected_[as_number(chosen[k])] = has_all_arcs ? 1 : 0;
  });
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (const ArcMatch& match : matches[k])
      sets_.unite(first_node_[as_number(chosen[k])] + match.arc,
                  node_of_placement(match.placement));
  if (surface_.has_slack) return;
  for (PlacementNumber k{}; k < layer.placements.end(); ++k) {
    const Node node = node_of_placement(k);
    for_each_arc_through(surface_, layer, layer.placements.placement(k),
                         [&](ClusterIndex of_arc, std::uint32_t arc) {
                           sets_.unite(first_node_[as_number(of_arc)] + arc, node);
                         });
    layer.placements.tree().for_each_within(
        layer.placements.center(k), connected,
        [&](std::uint32_t other) { sets_.unite(node, node_of_placement(PlacementNumber{other})); });
    sets_.unite(node, node_of_placement(layer.placements.first_of_node(k)));
  }
}

// Sets the nodes of the atoms whose clusters are measured in this layer. All arcs of these atoms
// are known and connected.
void ComponentFinder::connect_faces_of_atoms(const SweepLayer& layer) {
  const Patches& patches = layer.schedule.patches();
  const AtomClusters& clusters = patches.clusters();
  std::vector<std::pair<AtomIndex, LabelledArcs<Node>>> candidates;
  const auto visit = [&](AtomIndex i, Node root) {
    if (!layer.is_measured(i)) return;
    Node& node = node_of_atom_[i];
    if (node == no_node) {
      node = root;
    } else if (node < divided_begin && sets_.root(node) != root) {
      node = divided_begin + static_cast<Node>(candidates.size());
      candidates.push_back({i, {}});
    }
  };
  for_each_complete(layer, [&](ClusterIndex cluster, const ClusterPatches& of) {
    for (std::size_t k = 0; k < of.arcs.size(); ++k) {
      if (!layer.is_measured(of.arcs[k])) continue;
      const Node root = root_of_arc(cluster, k);
      visit(of.arcs[k].first, root);
      visit(of.arcs[k].second, root);
    }
  });
  const auto is_candidate = [&](AtomIndex i) {
    return layer.is_measured(i) && node_of_atom_[i] >= divided_begin && node_of_atom_[i] != no_node;
  };
  const auto keep = [&](AtomIndex i, const SphereArc& arc, Node root) {
    candidates[node_of_atom_[i] - divided_begin].second.add(arc, root);
  };
  for_each_complete(layer, [&](ClusterIndex cluster, const ClusterPatches& of) {
    for (std::size_t k = 0; k < of.arcs.size(); ++k) {
      const Arc& arc = of.arcs[k];
      const bool has_first = is_candidate(arc.first), has_second = is_candidate(arc.second);
      if (!has_first && !has_second) continue;
      const SasSphere first = surface_.sas_sphere(arc.first);
      const SasSphere second = surface_.sas_sphere(arc.second);
      const ContactCircle circle = make_contact_circle(first, second);
      const Node root = root_of_arc(cluster, k);
      if (has_first) keep(arc.first, on_first_sphere(arc, circle, first), root);
      if (has_second) keep(arc.second, on_second_sphere(arc, circle, second), root);
    }
  });
  for (const auto& [atom, candidate] : candidates)
    connect_faces(candidate, [&](Node a, Node b) { sets_.unite(a, b); });
  for (auto& [atom, candidate] : candidates) {
    const bool is_divided = is_split(sets_, candidate.labels);
    node_of_atom_[atom] = is_divided ? divided_begin + static_cast<Node>(divided_.size())
                                     : sets_.root(candidate.labels.front());
    if (is_divided) divided_.emplace_back(atom, std::move(candidate));
  }
  for (ClusterIndex cluster = layer.begin; cluster < layer.end; ++cluster) {
    const std::span<const AtomIndex> members = clusters.members(cluster);
    for (std::size_t m = 0; m < members.size(); ++m)
      if (node_of_atom_[members[m]] == no_node &&
          patches.of_cluster(cluster).exposure[m] == AtomExposure::exposed)
        node_of_atom_[members[m]] = sets_.add();
  }
}

void ComponentFinder::add(const RootSums& sums) { sums_.push_back(sums); }

void ComponentFinder::add(SharedCut cut) { cuts_.push_back(std::move(cut)); }

void ComponentFinder::end_layer() {
  merge_sums();
  std::erase_if(kept_, [&](const auto& kept) { return is_known_outside(sets_.root(kept.node)); });
  std::erase_if(cuts_, [&](const SharedCut& cut) {
    const Node root = sets_.root(cut.node);
    return std::all_of(cut.cutters.begin(), cut.cutters.end(),
                       [&](Node cutter) { return sets_.root(cutter) == root; });
  });
}

void ComponentFinder::find_outside() {
  const Node outside = node_of_atom_[lowest_atom_];
  outside_root_ = outside < divided_begin ? sets_.root(outside) : no_node;
}

// Adds up the sums of nodes that have been united.
void ComponentFinder::merge_sums() {
  for (RootSums& sums : sums_) sums.root = sets_.root(sums.root);
  std::stable_sort(sums_.begin(), sums_.end(),
                   [](const RootSums& a, const RootSums& b) { return a.root < b.root; });
  std::size_t count = 0;
  for (const RootSums& sums : sums_) {
    if (count == 0 || sums_[count - 1].root != sums.root) {
      sums_[count++] = sums;
      continue;
    }
    RootSums& last = sums_[count - 1];
    last.sums += sums.sums;
    last.box = united(last.box, sums.box);
  }
  sums_.resize(count);
}

void ComponentFinder::add_face(Wall& wall, AtomIndex atom, const FaceIntegrals& integrals) const {
  const double r = surface_.atoms[atom].radius, R = r + surface_.probe_radius;
  const Vec3 position = surface_.atoms[atom].center - origin_;
  wall.faces +=
      face_sums(r, surface_.probe_radius, position, integrals.solid_angle, integrals.vector_area);
  // |x|^2 = |a|^2 + R^2 + 2 R a . n, with x = a + R n.
  const Vec3 squares = integrals.moment + (integrals.solid_angle / 3) * position;
  wall.moment = wall.moment +
                (0.5 * R * R) *
                    ((squared_norm(position) + R * R) * integrals.vector_area + (2 * R) * squares);
  if (!wall.atom) wall.atom = atom;
}

// Adds the faces of an atom to several walls. `solid_angle` is that of all faces together.
void ComponentFinder::add_divided_atom(AtomIndex atom, double solid_angle,
                                       const Components::DividedAtom& divided,
                                       std::vector<Wall>& walls) const {
  const bool is_open = solid_angle > 4 * std::numbers::pi - 2 * sphere_part::ambiguous;
  const auto& [arcs, wall_of_arc] = divided.arcs;
  const Vec3 covered = std::min_element(arcs.begin(), arcs.end(), [](const auto& a, const auto& b) {
                         return a.cap.cosine < b.cap.cosine;
                       })->cap.axis;
  for (const WallIndex wall : divided.walls) {
    SpherePart boundary;
    FaceIntegrals integrals;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      if (wall_of_arc[k] != wall) continue;
      const auto& [cap, arc] = arcs[k];
      boundary += boundary_term(cap, arc, covered);
      integrals.moment =
          integrals.moment + second_moment_term(cap, arc, surface_.atoms[atom].center - origin_);
    }
    integrals.vector_area = boundary.vector_area;
    // The nearest arc tells the face of a direction that no cap covers. If caps cover a part of the
    // sphere, no face is almost the whole of it.
    integrals.solid_angle = solid_angle_of(boundary.solid_angle, [&](Vec3 direction) {
      return is_open && divided.arcs.label_of_face(direction) == wall;
    });
    add_face(walls[as_number(wall)], atom, integrals);
  }
}

void ComponentFinder::add_faces(const std::vector<Node>& labels,
                                const std::function<FaceIntegrals(AtomIndex)>& integrals_of,
                                Components& components) {
  components.split_begin_ = static_cast<std::uint32_t>(components.walls.size());
  components.wall_of_atom_.assign(surface_.atoms.size(), Components::no_wall);
  for (AtomIndex i = 0; i < surface_.atoms.size(); ++i) {
    const Node node = node_of_atom_[i];
    if (node == no_node) continue;
    std::uint32_t wall = 0;
    if (node >= divided_begin) {
      auto& [arcs, nodes] = divided_[node - divided_begin].second;
      Components::DividedAtom divided{{std::move(arcs), {}}, {}};
      for (const Node of_arc : nodes) divided.arcs.labels.push_back(WallIndex{labels[of_arc]});
      divided.walls = divided.arcs.labels;
      std::sort(divided.walls.begin(), divided.walls.end());
      divided.walls.erase(std::unique(divided.walls.begin(), divided.walls.end()),
                          divided.walls.end());
      wall = as_number(divided.walls.front());
      if (divided.walls.size() > 1) {
        const double solid_angle = integrals_of ? integrals_of(i).solid_angle : 0;
        add_divided_atom(i, solid_angle, divided, components.walls);
        components.wall_of_atom_[i] =
            components.split_begin_ + static_cast<std::uint32_t>(components.divided_.size());
        components.divided_.push_back(std::move(divided));
        continue;
      }
    } else {
      wall = labels[node];
    }
    components.wall_of_atom_[i] = wall;
    add_face(components.walls[wall], i, integrals_of ? integrals_of(i) : FaceIntegrals());
  }
}

// The void of a component alone is cut by its own placements only.
void ComponentFinder::find_overlaps(const std::vector<Node>& labels, Components& components) {
  const double p = surface_.probe_radius;
  const auto component_of = [&](Node node) { return components.walls[labels[node]].component; };
  components.corrections.resize(components.count);
  SpherePartFinder finder;
  std::vector<SphericalCap> caps;
  for (const SharedCut& cut : cuts_) {
    const ComponentIndex own = component_of(cut.node);
    caps.assign(cut.caps.begin(), cut.caps.begin() + cut.bound_count);
    for (std::size_t k = 0; k < cut.cutters.size(); ++k) {
      const ComponentIndex other = component_of(cut.cutters[k]);
      if (other == own)
        caps.push_back(cut.caps[cut.bound_count + k]);
      else
        components.overlaps.emplace_back(std::min(own, other), std::max(own, other));
    }
    if (caps.size() == cut.caps.size()) continue;
    const SpherePart part = finder.find(caps);
    const double angle = part.solid_angle - cut.part.solid_angle;
    const Vec3 vector_area = p * p * (part.vector_area - cut.part.vector_area);
    PatchSums& correction = components.corrections[as_number(own)];
    correction.concave += p * p * angle;
    correction.flux -= dot(cut.center, vector_area) + p * p * p * angle;
    correction.load += sphere_load(cut.center, -vector_area);
  }
  std::sort(components.overlaps.begin(), components.overlaps.end());
  components.overlaps.erase(std::unique(components.overlaps.begin(), components.overlaps.end()),
                            components.overlaps.end());
}

Components ComponentFinder::finish(const std::function<FaceIntegrals(AtomIndex)>& integrals_of,
                                   const CheckCallback& check) {
  const auto end_step = [&] {
    if (check) check();
  };
  Components components;
  const std::vector<Node> labels = sets_.labels();
  const auto max_label = std::max_element(labels.begin(), labels.end());
  components.walls.resize(max_label == labels.end() ? 0 : *max_label + std::size_t{1});
  for (const RootSums& sums : sums_) {
    Wall& wall = components.walls[labels[sums.root]];
    wall.patches += sums.sums;
    wall.box = united(wall.box, sums.box);
  }
  for (const auto& [center, node] : kept_)
    components.placements.push_back({center, WallIndex{labels[node]}});
  end_step();
  add_faces(labels, integrals_of, components);
  end_step();
  components.piece_of_atom = find_pieces(surface_, check);
  end_step();
  connect_walls(surface_, components);
  end_step();
  find_overlaps(labels, components);
  return components;
}

}  // namespace eses::detail
