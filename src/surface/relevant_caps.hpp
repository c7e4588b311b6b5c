#pragma once
/// The caps of an atom that can bound the accessible part of its SAS sphere, found by a table of
/// small discs (geometry/disc_masks.hpp) before any contact circle is computed.

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/disc_masks.hpp"
#include "surface/neighbour_caps.hpp"
#include "system/padding.hpp"

namespace eses::detail {

/// An atom of a section whose SAS sphere is not proved to be covered.
struct OpenAtom {
  AtomIndex atom = 0;
  DiscSet discs;                       ///< discs that no single cap contains
  std::uint32_t begin = 0, count = 0;  ///< its relevant caps
};

/// The solid angle outside of the largest cap of an atom; 0 for an atom that is covered.
struct AngleBound {
  AtomIndex atom = 0;
  double max_angle = 0;
};

/// The open atoms among consecutive atoms, with their relevant caps. Without the other caps, the
/// same points of the open discs are accessible.
struct alignas(thread_alignment) AtomSection {
  std::vector<AngleBound> bounds;  ///< of all atoms
  std::vector<OpenAtom> open_atoms;
  CapList caps;                       ///< of all open atoms; for each, large caps first
  std::vector<AtomIndex> neighbours;  ///< the atom of each cap
};

/// Scratch memory of find_relevant_caps, one per thread.
struct alignas(thread_alignment) RelevantCapScratch {
  NeighbourScratch near;
  DiscEntries entries;
  PartLimits part_limits;
  std::vector<std::uint32_t> meeting, by_size;  ///< caps that meet an open disc
};

/// Replaces `section` by that of these atoms.
void find_relevant_caps(const SurfaceModel& surface, std::span<const AtomIndex> atoms,
                        RelevantCapScratch& scratch, AtomSection& section);

}  // namespace eses::detail
