// Compares the properties that a molecule finds for its atoms with their definitions, with any
// number of threads.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "catch.hpp"
#include "eses/eses.hpp"
#include "geometry/tolerances.hpp"
#include "support/atom_sets.hpp"
#include "support/run.hpp"
#include "surface/atom_loops.hpp"
#include "surface/molecule.hpp"

namespace eses::detail::test {
namespace {

constexpr AtomIndex none = std::numeric_limits<AtomIndex>::max();

/// Small sets that are so far from each other that each can be examined alone.
struct ScatteredSets {
  std::vector<Atom> atoms;
  std::vector<std::uint32_t> set_of;            ///< set of each atom
  std::vector<std::vector<AtomIndex>> members;  ///< atoms of each set, ascending
};

/// Makes sets of `kinds` in turn. Some atoms exchange their places in the list, so that those of a
/// set are in many ranges.
ScatteredSets scatter_sets(std::span<const Kind> kinds, std::size_t min_atoms) {
  constexpr std::size_t sets_along_axis = 24;
  constexpr double distance = 256;  // angstrom; a power of two keeps snapped atoms snapped
  ScatteredSets sets;
  std::uint32_t count = 0;
  for (; sets.atoms.size() < min_atoms; ++count) {
    const std::size_t n = count, rows = n / sets_along_axis, layers = rows / sets_along_axis;
    const Vec3 place =
        distance * Vec3{static_cast<double>(n % sets_along_axis),
                        static_cast<double>(rows % sets_along_axis), static_cast<double>(layers)};
    for (const auto& [center, radius] : make_atom_set(kinds[n % kinds.size()], n)) {
      sets.atoms.push_back({center + place, radius});
      sets.set_of.push_back(count);
    }
  }
  Random random(min_atoms);
  const auto any = [&] { return random.integer(0, sets.atoms.size() - 1); };
  for (std::size_t more = min_atoms / 50; more > 0; --more) {
    const std::size_t i = any();
    const Atom repeated = sets.atoms[i];
    const std::uint32_t set = sets.set_of[i];
    sets.atoms.push_back(repeated);
    sets.set_of.push_back(set);
  }
  for (std::size_t swaps = min_atoms / 8; swaps > 0; --swaps) {
    const std::size_t i = any(), j = any();
    std::swap(sets.atoms[i], sets.atoms[j]);
    std::swap(sets.set_of[i], sets.set_of[j]);
  }
  sets.members.resize(count);
  for (AtomIndex i = 0; i < sets.atoms.size(); ++i) sets.members[sets.set_of[i]].push_back(i);
  return sets;
}

struct AtomProperties {
  std::vector<Diagnostic> diagnostics;
  std::vector<bool> is_contained;
};

/// Applies the definitions in diagnostics.hpp and molecule.hpp to each atom and each atom of its
/// set.
class Definition {
 public:
  explicit Definition(const ScatteredSets& sets) : sets_(sets) { find_first_equal(); }

  bool is_repeated(AtomIndex i) const { return first_equal_[i] != i; }

  AtomProperties find() const {
    AtomProperties properties;
    const auto count = static_cast<AtomIndex>(sets_.atoms.size());
    for (std::size_t kind = 0; kind < diagnostic_kinds; ++kind) {
      Diagnostic diagnostic{static_cast<DiagnosticKind>(kind), 0, {}};
      for (AtomIndex i = 0; i < count; ++i) {
        const AtomIndex other = other_of(diagnostic.kind, i);
        if (other == none) continue;
        if (diagnostic.count++ < Diagnostic::max_examples)
          diagnostic.examples.push_back({i, other});
      }
      if (diagnostic.count > 0) properties.diagnostics.push_back(std::move(diagnostic));
    }
    for (AtomIndex i = 0; i < count; ++i) properties.is_contained.push_back(is_contained(i));
    return properties;
  }

 private:
  void find_first_equal() {
    std::map<std::tuple<double, double, double, double>, AtomIndex> first;
    for (AtomIndex i = 0; i < sets_.atoms.size(); ++i) {
      const auto& [center, radius] = sets_.atoms[i];
      first_equal_.push_back(
          first.try_emplace({center.x, center.y, center.z, radius}, i).first->second);
    }
  }

  template <class Condition>
  std::vector<AtomIndex> those_around(AtomIndex i, Condition&& condition) const {
    std::vector<AtomIndex> found;
    for (const AtomIndex j : sets_.members[sets_.set_of[i]])
      if (!is_repeated(j) && condition(j)) found.push_back(j);
    return found;
  }

  bool are_close(const Atom& a, const Atom& b) const {
    return a.radius > 0 && b.radius > 0 && squared_norm(a.center - b.center) < 0.25;
  }

  AtomIndex first_close(AtomIndex i) const {
    const auto close = those_around(
        i, [&](AtomIndex j) { return j < i && are_close(sets_.atoms[i], sets_.atoms[j]); });
    return close.empty() || is_repeated(i) ? none : close.front();
  }

  AtomIndex first_outer(AtomIndex i) const {
    const Atom& inner = sets_.atoms[i];
    if (is_repeated(i) || inner.radius == 0) return none;
    const auto outer = those_around(i, [&](AtomIndex j) {
      const Atom& other = sets_.atoms[j];
      const double room = other.radius - inner.radius;
      return j != i && room >= 0 && squared_norm(inner.center - other.center) <= room * room &&
             !are_close(inner, other);
    });
    return outer.empty() ? none : outer.front();
  }

  AtomIndex other_of(DiagnosticKind kind, AtomIndex i) const {
    const double radius = sets_.atoms[i].radius;
    switch (kind) {
      case DiagnosticKind::duplicate:
        return is_repeated(i) ? first_equal_[i] : none;
      case DiagnosticKind::close:
        return first_close(i);
      case DiagnosticKind::nested:
        return radius > 1.4 ? first_outer(i) : none;
      case DiagnosticKind::large_radius:
        return radius > 4 ? i : none;
      case DiagnosticKind::small_radii:       // some radii are larger
      case DiagnosticKind::one_atom_residue:  // the atoms have no names
      case DiagnosticKind::water:
      case DiagnosticKind::foreign_residue:
      case DiagnosticKind::unread_record:          // the atoms are not from a file
      case DiagnosticKind::nanometre_coordinates:  // neighbours are farther apart
        return none;
      case DiagnosticKind::zero_radius:
        return radius == 0 ? i : none;
      case DiagnosticKind::nested_usual:
        return radius <= 1.4 ? first_outer(i) : none;
    }
    return none;
  }

  bool is_contained(AtomIndex i) const {
    if (is_repeated(i)) return true;
    const auto lies_in = [&](AtomIndex inner, AtomIndex outer) {
      const Atom &a = sets_.atoms[inner], &b = sets_.atoms[outer];
      return norm(b.center - a.center) <= b.radius - a.radius + tolerance::containment;
    };
    return !those_around(i, [&](AtomIndex j) {
              return j != i && lies_in(i, j) && (j < i || !lies_in(j, i));
            }).empty();
  }

  const ScatteredSets& sets_;
  std::vector<AtomIndex> first_equal_;
};

// Returns the diagnostics as tuples.
auto comparable(std::span<const Diagnostic> diagnostics) {
  std::vector<
      std::tuple<DiagnosticKind, std::uint64_t, std::vector<std::pair<AtomIndex, AtomIndex>>>>
      result;
  for (const Diagnostic& diagnostic : diagnostics) {
    result.push_back({diagnostic.kind, diagnostic.count, {}});
    for (const auto& example : diagnostic.examples)
      std::get<2>(result.back()).emplace_back(example.atom, example.other);
  }
  return result;
}

std::size_t count_differences(const Molecule& molecule, const std::vector<bool>& is_contained) {
  std::size_t differences = 0;
  for (AtomIndex i = 0; i < is_contained.size(); ++i)
    differences += molecule.is_contained(i) != is_contained[i] ? 1 : 0;
  return differences;
}

void check_molecules(const ScatteredSets& sets) {
  const Definition definition(sets);
  const AtomProperties expected = definition.find();
  for (const int threads : {1, 2, 3, 7, 0}) {
    INFO(threads << " threads");
    const Molecule molecule = Molecule(sets.atoms, {}, threads);
    CHECK(comparable(molecule.diagnostics()) == comparable(expected.diagnostics));
    CHECK(count_differences(molecule, expected.is_contained) == 0);
  }
}

}  // namespace

TEST_CASE("diagnostics and containment are the same with any number of threads", "[molecule]") {
  for (const Kind kind : all_kinds) {
    INFO(kind_name(kind));
    const ScatteredSets sets = scatter_sets({{kind}}, 3 * atoms_per_loop_range);
    REQUIRE(loop_range_count(sets.atoms.size()) > 3);
    check_molecules(sets);
  }
}

TEST_CASE("radii that are all small are reported with any number of threads", "[molecule]") {
  std::vector<Atom> atoms = make_cube(24, 1, 0.2);
  for (const bool is_last_large : {false, true}) {
    if (is_last_large) atoms.back().radius = 0.4;
    for (const int threads : {1, 2, 7}) {
      const Molecule molecule(atoms, {}, threads);
      if (is_last_large) {
        CHECK(molecule.diagnostics().empty());
        continue;
      }
      REQUIRE(molecule.diagnostics().size() == 1);
      CHECK(molecule.diagnostics()[0].kind == DiagnosticKind::small_radii);
      CHECK(molecule.diagnostics()[0].count == atoms.size());
      CHECK(molecule.diagnostics()[0].examples.back().atom == Diagnostic::max_examples - 1);
    }
  }
}

TEST_CASE("thousands of equal atoms are duplicates of the first, and no atoms are none",
          "[molecule]") {
  const std::vector<Atom> atoms(200'000, {{1, 2, 3}, 1.5});
  const Molecule molecule(atoms, {}, 3);
  REQUIRE(molecule.diagnostics().size() == 1);
  CHECK(molecule.diagnostics()[0].count == atoms.size() - 1);
  CHECK_FALSE(molecule.is_contained(0));
  CHECK(molecule.is_contained(1));
  const Molecule nothing(std::vector<Atom>(), {}, 3);
  CHECK(nothing.diagnostics().empty());
}

TEST_CASE("a molecule refuses atoms that are not finite or have negative radii", "[molecule]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    Atom atom;
    const char* message;
  };
  const std::array cases{
      Case{{{nan, 0, 0}, 1}, "has x coordinate nan"},
      Case{{{0, -infinity, 0}, 1}, "has y coordinate -inf"},
      Case{{{0, 0, infinity}, 1}, "has z coordinate inf"},
      Case{{{0, 0, 0}, nan}, "has radius nan"},
      Case{{{0, 0, 0}, infinity}, "has radius inf"},
      Case{{{0, 0, 0}, -0.25}, "has radius -0.25"},
  };
  for (const auto& [bad, message] : cases)
    for (const std::size_t place : std::array<std::size_t, 3>{0, 7, 9999}) {
      INFO(message << " at " << place);
      std::vector<Atom> atoms;
      atoms.reserve(10'001);
      for (int i = 0; i < 10'000; ++i) atoms.push_back({{3.0 * i, 0, 0}, 1.5});
      atoms[place] = bad;
      // A later invalid atom is not named.
      atoms.push_back({{0, 0, 0}, -7});
      const auto expected = Catch::Matchers::ContainsSubstring(
          "atom " + std::to_string(place) + " (counted from 0) " + message + ";");
      CHECK_THROWS_WITH(Molecule(atoms), expected);
      CHECK_THROWS_WITH(Molecule(atoms, {}, 2), expected);
      CHECK_THROWS_AS(make_plan(atoms, {}, {}), std::invalid_argument);
    }
  CHECK_NOTHROW(Molecule({{{0, 0, 0}, 0}, {{-1e6, 1e6, -0.0}, -0.0}}));
}

TEST_CASE("an impossible number of threads is refused", "[molecule]") {
  for (const int threads : {-1, 4097, 1 << 30}) {
    CHECK_THROWS_AS(Molecule({{{0, 0, 0}, 1}}, {}, threads), std::invalid_argument);
    const Surface surface({{{0, 0, 0}, 1}});
    CHECK_THROWS_AS(measure(surface, {.threads = threads}), std::invalid_argument);
    CHECK_THROWS_AS(find_pockets(surface, {.threads = threads}), std::invalid_argument);
    CHECK_THROWS_AS(eses::compute(surface, eses::make_grid(surface, {}), {.threads = threads}),
                    std::invalid_argument);
  }
}

}  // namespace eses::detail::test
