#include "output/mesh_groups.hpp"

#include <algorithm>
#include <tuple>

namespace eses::detail::mesh {
namespace {

// Numbers the different values of key(label) from 0, in the order of their first occurrence.
// Returns the number of each label; `first` gets the first label of each number. Sorts only the
// first labels of runs of equal keys. A hash table of the names would need far more memory.
template <class Key>
std::vector<std::uint32_t> number_by(std::size_t labels, const Key& key,
                                     std::vector<AtomIndex>& first) {
  const auto begins_run = [&](AtomIndex i) { return i == 0 || key(i) != key(i - 1); };
  std::vector<AtomIndex> order;
  for (AtomIndex i = 0; i < labels; ++i)
    if (begins_run(i)) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](AtomIndex a, AtomIndex b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  // At first, numbers[i] of the first label i of a run is the first label that has the same key.
  std::vector<std::uint32_t> numbers(labels);
  for (std::size_t q = 0; q < order.size(); ++q)
    numbers[order[q]] =
        q > 0 && key(order[q]) == key(order[q - 1]) ? numbers[order[q - 1]] : order[q];
  for (AtomIndex i = 0; i < labels; ++i) {
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

LabelNumbers number_labels(std::span<const AtomLabel> labels) {
  LabelNumbers numbers;
  const auto chain = [&](AtomIndex i) { return std::tuple(truncated_name(labels[i].chain)); };
  const auto residue = [&](AtomIndex i) {
    return std::tuple(truncated_name(labels[i].chain), truncated_name(labels[i].residue_number),
                      truncated_name(labels[i].residue));
  };
  numbers.chain_of = number_by(labels.size(), chain, numbers.chains);
  numbers.residue_of = number_by(labels.size(), residue, numbers.residues);
  return numbers;
}

}  // namespace eses::detail::mesh
