#include "surface/molecule.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include "geometry/box.hpp"
#include "geometry/cap_list.hpp"
#include "geometry/float_spheres.hpp"
#include "geometry/tolerances.hpp"
#include "surface/atom_loops.hpp"
#include "surface/atom_tree.hpp"
#include "surface/atomic_update.hpp"
#include "surface/cell_list.hpp"
#include "surface/diagnostic_finder.hpp"
#include "surface/radius_class.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"
#include "system/serial_check.hpp"

namespace eses::detail {
namespace {

[[noreturn]] void refuse(std::size_t i, std::string_view what, double value,
                         std::string_view wanted) {
  throw std::invalid_argument(
      formatted("atom {} (counted from 0) has {} {}; give a {}", i, what, value, wanted));
}

void require_valid(std::span<const Atom> atoms) {
  constexpr std::array<std::string_view, 3> coordinates{"x coordinate", "y coordinate",
                                                        "z coordinate"};
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const auto& [center, radius] = atoms[i];
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (!std::isfinite(center[axis])) refuse(i, coordinates[axis], center[axis], "finite number");
    if (!std::isfinite(radius) || radius < 0)
      refuse(i, "radius", radius, "finite number that is not negative");
  }
}

// Finds the first of the equal atoms in a cell. Sorting avoids a quadratic time for thousands of
// equal atoms.
void find_first_equal(std::span<const Atom> atoms, std::vector<AtomIndex>& of_cell,
                      std::vector<AtomIndex>& first_equal) {
  const auto values = [&](AtomIndex i) {
    const auto& [center, radius] = atoms[i];
    return std::tuple(center.x, center.y, center.z, radius);
  };
  std::sort(of_cell.begin(), of_cell.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(values(a), std::tuple(a)) < std::tuple_cat(values(b), std::tuple(b));
  });
  for (std::size_t q = 0; q < of_cell.size(); ++q) {
    const bool is_repeated = q > 0 && values(of_cell[q]) == values(of_cell[q - 1]);
    first_equal[of_cell[q]] = is_repeated ? first_equal[of_cell[q - 1]] : of_cell[q];
  }
}

// Returns for each atom the first one with the same centre and radius.
std::vector<AtomIndex> find_first_equal(std::span<const Atom> atoms, const CellList& cells,
                                        int threads, const CheckCallback& after_range) {
  std::vector<AtomIndex> first_equal(atoms.size());
  for_loop_ranges(cells.cell_count(), threads,
                  [&](std::size_t, std::size_t begin, std::size_t end) {
                    std::vector<AtomIndex> of_cell;
                    for (std::size_t cell = begin; cell < end; ++cell) {
                      const std::span<const AtomIndex> members = cells.atoms_of_cell(cell);
                      of_cell.assign(members.begin(), members.end());
                      find_first_equal(atoms, of_cell, first_equal);
                    }
                    after_range();
                  });
  return first_equal;
}

bool contains(const Atom& outer, const Atom& inner) {
  return norm(outer.center - inner.center) <= outer.radius - inner.radius + tolerance::containment;
}

constexpr AtomIndex no_container = std::numeric_limits<AtomIndex>::max();

// Orders distinct atoms independently of their indices, the largest first.
bool precedes(const Atom& a, const Atom& b) {
  const auto values = [](const Atom& atom) {
    return std::tuple(-atom.radius, atom.center.x, atom.center.y, atom.center.z);
  };
  return values(a) < values(b);
}

// For each atom, the first one in the order of `precedes` that precedes and contains it, or
// `no_container`.
using Containers = std::vector<AtomIndex>;

// Records atom `i` as a container of the atoms of `near` that it contains. Several threads may call
// it at the same time.
void record_contained(std::span<const Atom> atoms, AtomIndex i, std::span<const AtomIndex> near,
                      Containers& containers) {
  const auto comes_first = [&](AtomIndex a, AtomIndex b) {
    return b == no_container || precedes(atoms[a], atoms[b]);
  };
  for (const AtomIndex j : near)
    if (contains(atoms[i], atoms[j]) && precedes(atoms[i], atoms[j]))
      atomic_update(containers[j], i, comes_first);
}

// Returns whether atom `i` is contained in a preceding atom that is itself not contained.
bool is_in_kept_atom(std::span<const Atom> atoms, const CellList& cells, AtomIndex i,
                     std::span<const std::uint8_t> is_contained, std::vector<AtomIndex>& found) {
  const Vec3 center = atoms[i].center;
  cells.find_reaching({center, center}, 2 * tolerance::containment, found);
  return std::any_of(found.begin(), found.end(), [&](AtomIndex j) {
    return is_contained[j] == 0 && precedes(atoms[j], atoms[i]) && contains(atoms[j], atoms[i]);
  });
}

// Marks the atoms that are contained in an atom that is itself not contained. So each of them
// extends beyond an unmarked atom by at most the tolerance, even in long chains of atoms that
// contain each other.
void mark_contained(std::span<const Atom> atoms, const CellList& cells,
                    const Containers& containers, std::vector<std::uint8_t>& is_contained) {
  std::vector<AtomIndex> inner, found;
  for (AtomIndex i = 0; i < atoms.size(); ++i)
    if (containers[i] != no_container) inner.push_back(i);
  std::sort(inner.begin(), inner.end(),
            [&](AtomIndex a, AtomIndex b) { return precedes(atoms[a], atoms[b]); });
  for (const AtomIndex i : inner)
    is_contained[i] =
        is_contained[containers[i]] == 0 || is_in_kept_atom(atoms, cells, i, is_contained, found);
}

// Returns the maximum distance between the centres of an atom and of another one that it contains,
// or that gives a diagnostic with it. No atom has a smaller radius than `min_radius`.
double vicinity_radius(const Atom& atom, double min_radius) {
  const double room = atom.radius - min_radius + 2 * tolerance::containment;
  return std::max(room, close_distance) * (1 + 1e-12);
}

double min_radius_of(std::span<const Atom> atoms) {
  double radius = std::numeric_limits<double>::infinity();
  for (const Atom& atom : atoms) radius = std::min(radius, atom.radius);
  return radius;
}

// A search for the atoms in the vicinity of each atom. Small atoms of a cell are looked up
// together.
class VicinitySearch {
 public:
  VicinitySearch(std::span<const Atom> atoms, const CellList& cells,
                 std::span<const AtomIndex> first_equal, double min_radius)
      : atoms_(atoms), cells_(cells), first_equal_(first_equal), min_radius_(min_radius) {}

  // Calls `visit(i, near)` for the atoms of a cell that repeat no earlier atom. `near` has the
  // other such atoms in the vicinity of atom `i`.
  template <class Visit>
  void for_each(std::size_t cell, Visit&& visit) {
    std::span<const AtomIndex> left = cells_.atoms_of_cell(cell);
    const bool are_small = std::all_of(
        left.begin(), left.end(), [&](AtomIndex i) { return radius_class(atoms_[i].radius) == 0; });
    while (!left.empty()) {
      const auto together = left.first(are_small ? left.size() : 1);
      look_up(together);
      for (const AtomIndex i : together)
        if (first_equal_[i] == i) visit(i, vicinity(i));
      left = left.subspan(together.size());
    }
  }

 private:
  void look_up(std::span<const AtomIndex> together) {
    Box box{atoms_[together.front()].center, atoms_[together.front()].center};
    double radius = 0;
    for (const AtomIndex i : together) {
      box.include(atoms_[i].center);
      radius = std::max(radius, vicinity_radius(atoms_[i], min_radius_));
    }
    cells_.find_centers(box, radius, found_);
    std::erase_if(found_, [&](AtomIndex j) { return first_equal_[j] != j; });
    points_.make_room(found_.size());
    points_.count = found_.size();
    for (std::size_t k = 0; k < found_.size(); ++k) points_.set(k, {atoms_[found_[k]].center, 0});
    floats_.assign(points_, grown(box, radius));
  }

  std::span<const AtomIndex> vicinity(AtomIndex i) {
    const double radius = vicinity_radius(atoms_[i], min_radius_);
    const std::size_t count = find_near_sphere({atoms_[i].center, radius}, floats_, positions_);
    near_.clear();
    for (std::size_t k = 0; k < count; ++k) {
      const AtomIndex j = found_[static_cast<std::size_t>(positions_[k])];
      if (j != i) near_.push_back(j);
    }
    return near_;
  }

  std::span<const Atom> atoms_;
  const CellList& cells_;
  std::span<const AtomIndex> first_equal_;
  double min_radius_;
  std::vector<AtomIndex> found_, near_;
  SphereList points_;  // centres of `found_`, with radius 0
  FloatSpheres floats_;
  std::vector<std::int32_t> positions_;
};

// Returns the number of threads to use. For few atoms, one thread is faster than the query for the
// available threads.
int useful_threads(std::size_t atoms, int wanted) {
  require_threads(wanted);
  return loop_range_count(atoms) < 2 ? 1 : chosen_threads(wanted);
}

}  // namespace

struct Molecule::Parts {
  Parts(std::vector<Atom> all_atoms, std::vector<AtomLabel> all_labels, int wanted_threads,
        const CheckCallback& check_callback, double added_radius)
      : atoms(std::move(all_atoms)),
        labels(std::move(all_labels)),
        is_contained(atoms.size()),
        has_nearly_equal(atoms.size()) {
    require_valid(atoms);
    if (!labels.empty() && labels.size() != atoms.size())
      throw std::invalid_argument(formatted("{} labels for {} atoms", labels.size(), atoms.size()));
    const int threads = useful_threads(atoms.size(), wanted_threads);
    SerialCheck serial_check(check_callback);
    const CheckCallback check = [&serial_check] { serial_check(); };
    check();
    std::vector<Atom> given;  // if the radii differ
    if (added_radius > 0) given = atoms;
    for (Atom& atom : atoms) atom.radius += added_radius;
    cells.emplace(atoms);
    const std::vector<AtomIndex> first_equal = find_first_equal(atoms, *cells, threads, check);
    for (AtomIndex i = 0; i < atoms.size(); ++i) is_contained[i] = first_equal[i] != i;
    inspect_atoms(given.empty() ? atoms : given, first_equal, threads, check);
  }

  // Marks contained atoms, and finds the diagnostics of the atoms as they were given: an added
  // radius changes no difference of radii, so that the same atoms are near each other.
  void inspect_atoms(std::span<const Atom> given, std::span<const AtomIndex> first_equal,
                     int threads, const CheckCallback& check) {
    DiagnosticFinder finder(given);
    std::vector<DiagnosticTally> tallies(loop_range_count(cells->cell_count()));
    Containers containers(atoms.size(), no_container);
    const double min_radius = min_radius_of(atoms);
    for_loop_ranges(
        cells->cell_count(), threads, [&](std::size_t range, std::size_t begin, std::size_t end) {
          VicinitySearch search(atoms, *cells, first_equal, min_radius);
          inspect_cells(begin, end, first_equal, search, containers, finder, tallies[range]);
          check();
        });
    mark_contained(atoms, *cells, containers, is_contained);
    diagnostics = finder.found(tallies);
  }

  void inspect_cells(std::size_t begin, std::size_t end, std::span<const AtomIndex> first_equal,
                     VicinitySearch& search, Containers& containers, DiagnosticFinder& finder,
                     DiagnosticTally& tally) {
    for (std::size_t cell = begin; cell < end; ++cell) {
      for (const AtomIndex i : cells->atoms_of_cell(cell))
        if (first_equal[i] != i) finder.inspect_duplicate(i, first_equal[i], tally);
      search.for_each(cell, [&](AtomIndex i, std::span<const AtomIndex> near) {
        record_contained(atoms, i, near, containers);
        has_nearly_equal[i] = std::any_of(near.begin(), near.end(), [&](AtomIndex j) {
          return squared_norm(atoms[i].center - atoms[j].center) <
                 tolerance::nearly_equal * tolerance::nearly_equal;
        });
        finder.inspect(i, near, tally);
      });
    }
  }

  // Makes the tree when it is first needed: areas need none. An exception must not leave
  // std::call_once: it passes a function of the C library, whose unwinder differs from that of a
  // program that is linked statically.
  const AtomTree& atom_tree() const {
    if (const AtomTree* const made = made_tree.load(std::memory_order_acquire)) return *made;
    const std::lock_guard lock(tree_mutex);
    if (!tree) tree.emplace(atoms);
    made_tree.store(&*tree, std::memory_order_release);
    return *tree;
  }

  std::vector<Atom> atoms;
  std::vector<AtomLabel> labels;
  std::optional<CellList> cells;
  std::vector<std::uint8_t> is_contained;
  std::vector<std::uint8_t> has_nearly_equal;
  std::vector<Diagnostic> diagnostics;
  mutable std::optional<AtomTree> tree;
  mutable std::atomic<const AtomTree*> made_tree = nullptr;
  mutable std::mutex tree_mutex;
};

Molecule::Molecule(std::vector<Atom> atoms) : Molecule(std::move(atoms), {}) {}

Molecule::Molecule(std::vector<Atom> atoms, std::vector<AtomLabel> labels, int threads,
                   const CheckCallback& check, double added_radius)
    : Molecule(std::make_shared<const Parts>(std::move(atoms), std::move(labels), threads, check,
                                             added_radius)) {}

Molecule::Molecule(std::shared_ptr<const Parts> parts)
    : parts_(std::move(parts)),
      is_contained_(parts_->is_contained),
      has_nearly_equal_(parts_->has_nearly_equal) {}

std::span<const Atom> Molecule::atoms() const { return parts_->atoms; }
std::span<const AtomLabel> Molecule::labels() const { return parts_->labels; }
std::span<const Diagnostic> Molecule::diagnostics() const { return parts_->diagnostics; }
const AtomTree& Molecule::tree() const { return parts_->atom_tree(); }
const CellList& Molecule::cells() const { return *parts_->cells; }

}  // namespace eses::detail
