#include "mesh/atom_groups.hpp"

#include <algorithm>
#include <tuple>

namespace eses::mesh {
namespace {

// Numbers atoms by key(atom), in the order in which the keys come first; `first` gets the first
// atom of each number. Sorts the first atoms of runs, as a table of the names would take far more
// memory.
template <class Key>
std::vector<std::uint32_t> number_by(std::size_t atoms, const Key& key,
                                     std::vector<AtomIndex>& first) {
  const auto begins_run = [&](AtomIndex i) { return i == 0 || key(i) != key(i - 1); };
  std::vector<AtomIndex> order;
  for (AtomIndex i = 0; i < atoms; ++i)
    if (begins_run(i)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  // Of a run's first atom, until it gets its number, the first one with the same key.
  std::vector<std::uint32_t> numbers(atoms);
  for (std::size_t q = 0; q < order.size(); ++q)
    numbers[order[q]] =
        q > 0 && key(order[q]) == key(order[q - 1]) ? numbers[order[q - 1]] : order[q];
  for (AtomIndex i = 0; i < atoms; ++i) {
    if (!begins_run(i)) {
      numbers[i] = numbers[i - 1];
    } else if (numbers[i] != i) {
      numbers[i] = numbers[numbers[i]];
    } else {
      numbers[i] = static_cast<std::uint32_t>(first.size());
      first.push_back(i);
    }
  }
  return numbers;
}

}  // namespace

AtomGroups group_atoms(std::span<const AtomLabel> labels) {
  AtomGroups groups;
  groups.are_known = !labels.empty();
  groups.labels = labels;
  const auto chain = [&](AtomIndex i) { return std::tuple(written_name(labels[i].chain)); };
  const auto residue = [&](AtomIndex i) {
    return std::tuple(written_name(labels[i].chain), written_name(labels[i].residue_number),
                      written_name(labels[i].residue));
  };
  groups.chain_of = number_by(labels.size(), chain, groups.chains);
  groups.residue_of = number_by(labels.size(), residue, groups.residues);
  return groups;
}

}  // namespace eses::mesh
