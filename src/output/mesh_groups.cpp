#include "output/mesh_groups.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

namespace eses::detail::mesh {
namespace {

// Numbers the different values of key_of(label) from 0, in the order of their first occurrence.
// Returns the number of each label; `first` gets the first label of each number. Sorts only the
// first labels of runs of equal keys. A hash table of the names would need far more memory.
template <class Key>
std::vector<std::uint32_t> number_by(std::span<const AtomLabel> labels, const Key& key_of,
                                     std::vector<AtomLabel>& first) {
  const auto key = [&](AtomIndex i) { return key_of(labels[i]); };
  const auto begins_run = [&](AtomIndex i) { return i == 0 || key(i) != key(i - 1); };
  std::vector<AtomIndex> order;
  for (AtomIndex i = 0; i < labels.size(); ++i)
    if (begins_run(i)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  // At first, numbers[i] of the first label i of a run is the first label that has the same key.
  std::vector<std::uint32_t> numbers(labels.size());
  for (std::size_t q = 0; q < order.size(); ++q)
    numbers[order[q]] =
        q > 0 && key(order[q]) == key(order[q - 1]) ? numbers[order[q - 1]] : order[q];
  for (AtomIndex i = 0; i < labels.size(); ++i) {
    if (!begins_run(i)) {
      numbers[i] = numbers[i - 1];
    } else if (numbers[i] != i) {
      numbers[i] = numbers[numbers[i]];
    } else {
      numbers[i] = static_cast<std::uint32_t>(first.size());
      first.push_back(labels[i]);
    }
  }
  return numbers;
}

}  // namespace

GroupNames number_groups(const ResidueRuns& runs, std::vector<GroupNumbers>& of_atom) {
  GroupNames names{.are_known = !runs.labels.empty(), .chains = {}, .residues = {}};
  const auto chain = [](const AtomLabel& label) { return std::tuple(truncated_name(label.chain)); };
  const auto residue = [](const AtomLabel& label) {
    return std::tuple(truncated_name(label.chain), truncated_name(label.residue_number),
                      truncated_name(label.residue));
  };
  const auto chains = number_by(runs.labels, chain, names.chains);
  const auto residues = number_by(runs.labels, residue, names.residues);
  of_atom.reserve(std::accumulate(runs.atoms.begin(), runs.atoms.end(), std::uint64_t{0}));
  for (std::size_t run = 0; run < runs.labels.size(); ++run)
    of_atom.insert(of_atom.end(), runs.atoms[run], {chains[run], residues[run]});
  return names;
}

}  // namespace eses::detail::mesh
