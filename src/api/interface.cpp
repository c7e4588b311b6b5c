#include "eses/interface.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "api/arguments.hpp"
#include "surface/point_tree.hpp"
#include "system/formatted.hpp"

namespace eses {
namespace {

using PartPair = std::pair<std::uint32_t, std::uint32_t>;

/// Areas of atoms that differ by less are equal, apart from rounding (square angstrom).
constexpr double rounding = 1e-7;

/// Some atoms of a complex, in ascending order, and their areas without all others.
struct AtomsAlone {
  std::vector<AtomIndex> atoms;
  AtomAreas areas;
};

AtomsAlone measure_alone(const Surface& all, std::vector<AtomIndex> chosen,
                         const MeasureOptions& options) {
  std::vector<Atom> atoms;
  atoms.reserve(chosen.size());
  for (const AtomIndex i : chosen) atoms.push_back(all.atoms()[i]);
  const Surface surface(std::move(atoms), {.max_filled_void = all.max_filled_void(),
                                           .threads = options.threads,
                                           .check = options.check});
  return {std::move(chosen), measure(surface, options).by_atom};
}

/// Returns the pairs of parts whose atoms are nearer to each other than a probe is wide.
std::set<PartPair> touching_parts(std::span<const Atom> atoms, std::span<const std::uint32_t> parts,
                                  double probe_radius, const CheckCallback& check) {
  double max_radius = 0;
  for (const Atom& atom : atoms) max_radius = std::max(max_radius, atom.radius);
  detail::PointTree tree;
  tree.reset(atoms);
  std::set<PartPair> pairs;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    if (parts[i] == no_part) continue;
    if (check && i % 1024 == 0) check();
    const double reach = atoms[i].radius + 2 * probe_radius;
    tree.for_each_within(atoms[i].center, reach + max_radius, [&](std::uint32_t j) {
      if (parts[j] == no_part || parts[j] <= parts[i]) return;
      if (norm(atoms[i].center - atoms[j].center) < reach + atoms[j].radius)
        pairs.insert({parts[i], parts[j]});
    });
  }
  return pairs;
}

/// The members of BuriedArea for a part.
struct Side {
  double BuriedArea::*lost;
  double BuriedArea::*alone;
};
constexpr Side first_side{&BuriedArea::first, &BuriedArea::first_alone};
constexpr Side second_side{&BuriedArea::second, &BuriedArea::second_alone};

/// Adds the areas of one part, `alone`, and their differences to an interface.
void add_part(const AtomsAlone& alone, const AtomsAlone& together, const Side& side,
              Interface& found) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < alone.atoms.size(); ++i) {
    while (together.atoms[k] != alone.atoms[i]) ++k;
    found.sas.*side.alone += alone.areas.sas[i];
    found.ses.*side.alone += alone.areas.ses(i);
    const double sas = alone.areas.sas[i] - together.areas.sas[k];
    const double ses = alone.areas.ses(i) - together.areas.ses(k);
    if (std::abs(sas) < rounding && std::abs(ses) < rounding) continue;
    found.sas.*side.lost += sas;
    found.ses.*side.lost += ses;
    found.atoms.push_back({alone.atoms[i], sas, ses});
  }
}

Interface interface_of(const AtomsAlone& first, const AtomsAlone& second, const Surface& all,
                       const MeasureOptions& options) {
  std::vector<AtomIndex> atoms;
  std::ranges::merge(first.atoms, second.atoms, std::back_inserter(atoms));
  const AtomsAlone together = measure_alone(all, std::move(atoms), options);
  Interface found;
  add_part(first, together, first_side, found);
  add_part(second, together, second_side, found);
  std::ranges::sort(found.atoms, {}, &BuriedAtom::atom);
  return found;
}

}  // namespace

std::vector<Interface> measure_interfaces(const Surface& surface,
                                          std::span<const std::uint32_t> parts,
                                          const MeasureOptions& options) {
  detail::require_valid(options);
  if (parts.size() != surface.atoms().size())
    throw std::invalid_argument(detail::formatted("{} numbers of parts for {} atoms", parts.size(),
                                                  surface.atoms().size()));
  const MeasureOptions measuring{
      .probe_radius = options.probe_radius.value_or(surface.probe_radius()),
      .ses = options.ses,
      .by_atom = true,
      .threads = options.threads,
      .check = options.check};
  std::map<std::uint32_t, std::vector<AtomIndex>> atoms_of_part;
  for (std::size_t i = 0; i < parts.size(); ++i)
    atoms_of_part[parts[i]].push_back(static_cast<AtomIndex>(i));
  std::map<std::uint32_t, AtomsAlone> alone;
  const auto part_alone = [&](std::uint32_t part) -> const AtomsAlone& {
    const auto [found, is_new] = alone.try_emplace(part);
    if (is_new) found->second = measure_alone(surface, atoms_of_part.at(part), measuring);
    return found->second;
  };
  std::vector<Interface> interfaces;
  for (const auto& [first, second] :
       touching_parts(surface.atoms(), parts, *measuring.probe_radius, options.check)) {
    Interface& found = interfaces.emplace_back(
        interface_of(part_alone(first), part_alone(second), surface, measuring));
    found.first = first;
    found.second = second;
  }
  return interfaces;
}

}  // namespace eses
