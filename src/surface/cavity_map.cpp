#include "surface/cavity_map.hpp"

#include <algorithm>
#include <limits>

#include "surface/patches.hpp"
#include "system/formatted.hpp"
#include "system/hints.hpp"

namespace eses::detail {
namespace {

// Two placements within this distance are the same one, and a probe touches the atoms whose SAS
// spheres are within this distance (angstrom).
constexpr double same = tolerance::touching;

// Atoms whose SAS spheres are equally near to a point, up to rounding (angstrom). It is far below
// the distance of atoms that are not contained in each other, because the face of a nearly equal
// atom in the direction of the point is hidden behind that of the nearest one.
constexpr double equally_near = 1e-12;

// A centre that only the slack exposes is moved out of this number of nearly equal balls, to find a
// ball with a face.
constexpr int max_moves = 10;

// Directions that differ by less than this lead to the same probe (radians).
constexpr double same_direction = 1e-6;

// First distance of a search for the nearest atom (angstrom).
constexpr double first_reach = 2;

}  // namespace

ComponentNumber WallAtom::component_at(Vec3 direction) const {
  for (const Contact& contact : contacts)
    if (squared_norm(contact.direction - direction) <= same_direction * same_direction)
      return contact.component;
  return has_arcs() ? divided.nearest_label(direction) : component;
}

CavityMap::CavityMap(const SurfaceModel& surface, const Components& components,
                     std::span<const ComponentNumber> number_of, std::vector<double> void_volumes,
                     const CheckCallback& check)
    : has_slack_(surface.has_slack),
      void_volumes_(std::move(void_volumes)),
      is_filled_(void_volumes_.size() + 1),
      numbers_(void_volumes_.size() + 1),
      boxes_(void_volumes_.size(), empty_box()) {
  for (std::uint32_t c = 0; c < numbers_.size(); ++c) numbers_[c] = ComponentNumber{c};
  add_atoms(surface, components, number_of);
  add_placements(surface, components, number_of);
  add_surroundings(surface, components, check);
  index_boxes();
}

// A probe centre that is extreme in some direction touches an atom whose centre is farther in this
// direction. The centres of the atoms therefore surround the cavity.
void CavityMap::add_atoms(const SurfaceModel& surface, const Components& components,
                          std::span<const ComponentNumber> number_of) {
  const auto number_of_wall = [&](WallIndex wall) {
    return number_of[as_number(components[wall].component)];
  };
  for (AtomIndex i = 0; i < surface.atoms.size(); ++i) {
    WallAtom atom;
    bool has_cavity = false, is_first = true, is_divided = false;
    components.for_each_wall_of(i, [&](WallIndex wall) {
      const ComponentNumber component = number_of_wall(wall);
      is_divided = is_divided || (!is_first && component != atom.component);
      is_first = false;
      atom.component = component;
      if (component == outside_component) return;
      has_cavity = true;
      box_of(component).include(surface.atoms[i].center);
    });
    if (!has_cavity) continue;
    if (is_divided) {
      const LabelledArcs<WallIndex>& on_walls = *components.divided_arcs_of(i);
      atom.divided.arcs = on_walls.arcs;
      for (const WallIndex wall : on_walls.labels)
        atom.divided.labels.push_back(number_of_wall(wall));
    }
    index_.emplace_back(i, static_cast<std::uint32_t>(atoms_.size()));
    atoms_.push_back(std::move(atom));
  }
}

// A probe that touches more than three atoms, or is trapped, may touch an atom where it has no face
// in the cavity. Rounding would decide whether the direction to the probe is in another face.
void CavityMap::add_placements(const SurfaceModel& surface, const Components& components,
                               std::span<const ComponentNumber> number_of) {
  struct Placement {
    Vec3 center;
    ComponentNumber component{};
  };
  std::vector<Placement> placements;
  std::vector<std::pair<AtomIndex, WallAtom::Contact>> contacts;
  for (const auto& [center, wall] : components.placements) {
    const ComponentNumber component = number_of[as_number(components[wall].component)];
    if (component == outside_component) continue;
    placements.push_back({center, component});
    box_of(component).include(center);
    for (const AtomIndex i : touched_atoms(surface, center)) {
      const WallAtom* const atom = find(i);
      const bool has_face =
          atom != nullptr &&
          (atom->has_arcs()
               ? std::count(atom->divided.labels.begin(), atom->divided.labels.end(), component) > 0
               : atom->component == component);
      if (!has_face)
        contacts.push_back({i, {normalized(center - surface.atoms[i].center), component}});
    }
  }
  std::sort(placements.begin(), placements.end(),
            [](const Placement& a, const Placement& b) { return a.center.x < b.center.x; });
  auto indexed = std::make_shared<Placements>();
  for (const Placement& placement : placements) {
    indexed->centers.push_back(placement.center);
    indexed->components.push_back(placement.component);
  }
  indexed->tree.reset(indexed->centers);
  placements_ = std::move(indexed);
  add_contacts(contacts);
}

void CavityMap::add_contacts(std::span<const std::pair<AtomIndex, WallAtom::Contact>> contacts) {
  std::vector<AtomIndex> added;
  for (const auto& [i, contact] : contacts)
    if (find(i) == nullptr) added.push_back(i);
  std::sort(added.begin(), added.end());
  added.erase(std::unique(added.begin(), added.end()), added.end());
  for (const AtomIndex i : added) {
    index_.emplace_back(i, static_cast<std::uint32_t>(atoms_.size()));
    atoms_.emplace_back();
  }
  std::sort(index_.begin(), index_.end());
  for (const auto& [i, contact] : contacts) {
    const auto found =
        std::lower_bound(index_.begin(), index_.end(), std::pair(i, std::uint32_t{0}));
    atoms_[found->second].contacts.push_back(contact);
  }
}

// A ball without a face is nowhere the nearest one, because others cover it. Where it covers a ball
// with a face of a cavity, one of these others may be the nearest one, so they are needed, too.
void CavityMap::add_surroundings(const SurfaceModel& surface, const Components& components,
                                 const CheckCallback& check) {
  constexpr std::size_t searches_between_checks = 1 << 12;
  std::size_t searches = 0;
  std::vector<AtomIndex> found, open;
  std::vector<std::uint8_t> is_near(surface.atoms.size());
  for (const auto& [atom, position] : index_) open.push_back(atom);
  while (!open.empty()) {
    const SasSphere sphere = surface.sas_sphere(open.back());
    open.pop_back();
    if (check && ++searches % searches_between_checks == 0) check();
    surface.tree().find_reaching(sphere.center,
                                 sphere.radius + surface.probe_radius + look_up_slack, found);
    for (const AtomIndex i : found) {
      if (is_near[i] != 0) continue;
      is_near[i] = 1;
      if (!components.has_face(i)) open.push_back(i);
    }
  }
  std::vector<Atom> balls;
  for (AtomIndex i = 0; i < is_near.size(); ++i) {
    if (is_near[i] == 0 || !components.has_face(i)) continue;
    const auto wall_atom =
        std::lower_bound(index_.begin(), index_.end(), std::pair(i, std::uint32_t{0}));
    const bool has_wall = wall_atom != index_.end() && wall_atom->first == i;
    balls.push_back({surface.atoms[i].center, surface.atoms[i].radius + surface.probe_radius});
    atom_of_ball_.push_back(has_wall ? wall_atom->second : none);
  }
  balls_ = std::make_shared<const Balls>(std::move(balls));
}

void CavityMap::fill(double max_void_volume) {
  std::uint32_t kept = 0;
  for (std::size_t k = 0; k < void_volumes_.size(); ++k) {
    is_filled_[k + 1] = void_volumes_[k] <= max_void_volume ? 1 : 0;
    numbers_[k + 1] = is_filled_[k + 1] != 0 ? outside_component : ComponentNumber{++kept};
  }
  choose_boxes();
}

void CavityMap::keep_only(ComponentNumber component) {
  if (as_number(component) >= is_filled_.size())
    throw HintedError(formatted("there is no cavity {}; the molecule has {} {} for this probe",
                                as_number(component), void_volumes_.size(),
                                void_volumes_.size() == 1 ? "cavity" : "cavities"),
                      {"component"});
  std::fill(is_filled_.begin(), is_filled_.end(), std::uint8_t{1});
  is_filled_[as_number(component)] = 0;
  choose_boxes();
}

void CavityMap::index_boxes() {
  auto indexed = std::make_shared<Middles>();
  for (const Box& box : boxes_) {
    const bool is_empty = box.low.x > box.high.x;
    indexed->middles.push_back(is_empty ? Vec3{} : 0.5 * (box.low + box.high));
    if (!is_empty)
      indexed->max_half_diagonal =
          std::max(indexed->max_half_diagonal, 0.5 * norm(box.high - box.low));
  }
  indexed->tree.reset(indexed->middles);
  middles_ = std::move(indexed);
}

void CavityMap::choose_boxes() {
  boxes_unlike_outside_.clear();
  for (std::size_t k = 0; k < boxes_.size(); ++k)
    if (is_filled_[k + 1] != is_filled_[0])
      boxes_unlike_outside_.push_back(
          grown({boxes_[k].low + offset_, boxes_[k].high + offset_}, same));
}

bool CavityMap::has_filled() const {
  return std::find(is_filled_.begin(), is_filled_.end(), std::uint8_t{1}) != is_filled_.end();
}

std::vector<FilledCavity> CavityMap::filled() const {
  std::vector<FilledCavity> list;
  for (std::size_t k = 0; k < void_volumes_.size(); ++k)
    if (is_filled_[k + 1] != 0) list.push_back({k + 1, void_volumes_[k]});
  return list;
}

void CavityMap::renumber(const std::function<std::optional<AtomIndex>(AtomIndex)>& index_of) {
  std::vector<std::pair<AtomIndex, std::uint32_t>> renumbered;
  for (const auto& [atom, position] : index_)
    if (const auto index = index_of(atom)) renumbered.emplace_back(*index, position);
  std::sort(renumbered.begin(), renumbered.end());
  index_ = std::move(renumbered);
}

void CavityMap::move(Vec3 by) {
  has_slack_ = false;
  offset_ = offset_ + by;
  choose_boxes();
}

const WallAtom* CavityMap::find(AtomIndex atom) const {
  const auto found =
      std::lower_bound(index_.begin(), index_.end(), std::pair(atom, std::uint32_t{0}));
  return found != index_.end() && found->first == atom ? &atoms_[found->second] : nullptr;
}

bool CavityMap::is_filled(const WallAtom* atom) const {
  if (atom == nullptr) return is_filled(outside_component);
  if (!atom->has_arcs()) return is_filled(atom->component);
  return std::all_of(atom->divided.labels.begin(), atom->divided.labels.end(),
                     [&](ComponentNumber component) { return is_filled(component); });
}

// Returns the component of a probe centre that is accessible up to the tolerance:
// `outside_component` if it is not near the cavities.
ComponentNumber CavityMap::component_near(Vec3 center) const {
  const Vec3 here = center - offset_;
  bool is_near = false;
  middles_->tree.for_each_within(
      here, middles_->max_half_diagonal + look_up_slack, [&](std::uint32_t k) {
        is_near = is_near || overlap(grown(boxes_[k], same), {here, here});
      });
  std::vector<AtomIndex> found;
  return is_near ? locate(center, found).component : outside_component;
}

ComponentNumber CavityMap::component_of(const SurfaceModel& surface, const Arc& arc) const {
  if (surface.has_slack && !has_slack_) {
    const SasSphere first = surface.sas_sphere(arc.first);
    const ContactCircle circle = make_contact_circle(first, surface.sas_sphere(arc.second));
    return component_near(first.center +
                          first.radius * middle_of(on_first_sphere(arc, circle, first)));
  }
  const WallAtom* const first = find(arc.first);
  const WallAtom* const second = first != nullptr ? find(arc.second) : nullptr;
  if (second == nullptr) return outside_component;
  if (!first->has_arcs()) return first->component;
  if (!second->has_arcs()) return second->component;
  const SasSphere sphere = surface.sas_sphere(arc.first);
  const ContactCircle circle = make_contact_circle(sphere, surface.sas_sphere(arc.second));
  return first->component_at(middle_of(on_first_sphere(arc, circle, sphere)));
}

ComponentNumber CavityMap::component_of_placement(Vec3 center) const {
  center = center - offset_;
  std::uint32_t first = none;
  placements_->tree.for_each_within(center, same,
                                    [&](std::uint32_t k) { first = std::min(first, k); });
  return first != none ? placements_->components[first] : outside_component;
}

// A placement in a window that a probe just fits need not be known by its centre.
ComponentNumber CavityMap::component_of(std::span<const Atom> atoms,
                                        const ProbePlacement& placement) const {
  const ComponentNumber known = component_of_placement(placement.center);
  if (known != outside_component) return known;
  if (!has_slack_) return component_near(placement.center);
  std::optional<ComponentNumber> common;
  for (const AtomIndex i : placement.atoms) {
    const WallAtom* const atom = find(i);
    if (atom == nullptr) return outside_component;
    const ComponentNumber component =
        atom->component_at(normalized(placement.center - atoms[i].center));
    if (common && component != *common) return outside_component;
    common = component;
  }
  return *common;
}

// All faces of an atom without arcs here are in one component. A placement may touch an atom at a
// point of another component, but placements in cavities are known by their centres.
ComponentNumber CavityMap::number_at(std::span<const Atom> atoms,
                                     std::span<const AtomIndex> touched, Vec3 center) const {
  if (!has_slack_) return numbers_[as_number(component_near(center))];
  if (touched.size() > 2) return numbers_[as_number(component_of_placement(center))];
  const WallAtom* first = nullptr;
  for (const AtomIndex i : touched) {
    const WallAtom* const atom = find(i);
    if (atom == nullptr) return outside_component;
    if (!atom->has_arcs()) return numbers_[as_number(atom->component)];
    if (first == nullptr) first = atom;
  }
  const Vec3 direction = normalized(center - atoms[touched.front()].center);
  return numbers_[as_number(first->divided.nearest_label(direction))];
}

bool CavityMap::meets_box_unlike_outside(const Box& box) const {
  return std::any_of(boxes_unlike_outside_.begin(), boxes_unlike_outside_.end(),
                     [&](const Box& other) { return overlap(other, box); });
}

bool CavityMap::may_be_filled(const Box& box) const {
  return is_filled(outside_component) || meets_box_unlike_outside(box);
}

bool CavityMap::may_be_kept(const Box& box) const {
  return !is_filled(outside_component) || meets_box_unlike_outside(box);
}

double CavityMap::find_nearest_balls(Vec3 center, std::vector<AtomIndex>& found) const {
  const std::span<const Atom> balls = balls_->balls;
  const auto gap_to = [&](AtomIndex i) { return norm(center - balls[i].center) - balls[i].radius; };
  double min_gap = std::numeric_limits<double>::infinity();
  double reach = 0.5 * first_reach;
  do {
    reach *= 2;
    balls_->tree.find_reaching(center, reach + same, found);
    for (const AtomIndex i : found) min_gap = std::min(min_gap, gap_to(i));
  } while (min_gap > reach);
  std::erase_if(found, [&](AtomIndex i) { return gap_to(i) > min_gap + equally_near; });
  return min_gap;
}

CavityMap::Location CavityMap::locate(Vec3 center, std::vector<AtomIndex>& found) const {
  const ComponentNumber known = component_of_placement(center);
  if (known != outside_component) return {known, 0};
  const std::span<const Atom> balls = balls_->balls;
  if (balls.empty()) return {};
  center = center - offset_;
  double gap = find_nearest_balls(center, found);
  for (int move = 0; move < max_moves && gap < -equally_near && gap > -same; ++move) {
    const Atom& deepest = balls[found.front()];
    center = deepest.center + deepest.radius * normalized(center - deepest.center);
    gap = find_nearest_balls(center, found);
  }
  Location location{outside_component, std::max(0.0, gap)};
  for (const AtomIndex i : found) {
    if (atom_of_ball_[i] == none) return {outside_component, location.clearance};
    const Vec3 offset = center - balls[i].center;
    const ComponentNumber component =
        atoms_[atom_of_ball_[i]].component_at(norm(offset) > 0 ? normalized(offset) : offset);
    location.component = std::max(location.component, component);
  }
  return location;
}

}  // namespace eses::detail
