#include "run/group_names.hpp"

#include <numeric>

namespace eses::detail {

GroupNames number_groups(const ResidueRuns& runs, std::vector<mesh::GroupNumbers>& of_atom) {
  const mesh::LabelNumbers numbers = mesh::number_labels(runs.labels);
  GroupNames names{.are_known = !runs.labels.empty(), .chains = {}, .residues = {}};
  for (const AtomIndex label : numbers.chains) names.chains.push_back(runs.labels[label]);
  for (const AtomIndex label : numbers.residues) names.residues.push_back(runs.labels[label]);
  of_atom.reserve(std::accumulate(runs.atoms.begin(), runs.atoms.end(), std::uint64_t{0}));
  for (std::size_t run = 0; run < runs.labels.size(); ++run)
    of_atom.insert(of_atom.end(), runs.atoms[run],
                   {numbers.chain_of[run], numbers.residue_of[run]});
  return names;
}

}  // namespace eses::detail
