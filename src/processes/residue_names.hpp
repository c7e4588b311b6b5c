#pragma once
/// The residues of a molecule by name, which a mesh numbers.

#include <vector>

#include "eses/atom_labels.hpp"
#include "mesh/atom_groups.hpp"
#include "processes/atom_share.hpp"
#include "processes/processes.hpp"
#include "processes/slabs.hpp"

namespace eses {

/// To be called by all processes. Returns a label of each residue, in the order in which they come
/// first in the file, and tells the share's atoms which of them is theirs; nothing of either if
/// the share has no labels.
std::vector<AtomLabel> share_residue_names(AtomShare& share, const Processes& processes);

/// Of a slab's atoms, as `mesh::group_atoms` numbers those of the whole molecule. Keeps a view of
/// `names`.
mesh::AtomGroups group_slab(const SlabShare& slab, std::span<const AtomLabel> names);

}  // namespace eses
