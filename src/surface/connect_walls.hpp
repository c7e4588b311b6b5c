#pragma once
/// Joins the walls of the set of accessible probe centres to its components.

#include <cstdint>
#include <vector>

#include "surface/components.hpp"
#include "surface/surface_model.hpp"

namespace eses::detail {

/// Returns the index of the piece of each atom. A piece is a connected union of SAS balls. Balls
/// that overlap too little for a contact circle are not connected. Pieces are in the order of their
/// first atoms. Calls `check` repeatedly, if it is not empty.
std::vector<std::uint32_t> find_pieces(const SurfaceModel& surface, const CheckCallback& check);

/// Sets Wall::encloses_atoms and Wall::component of all walls, and the number of components.
/// Components::piece_of_atom is known.
///
/// The union of the balls of a piece has a single outer boundary, which has the extreme point of
/// the piece in every direction. So the wall at this point encloses the piece, and the set of probe
/// centres continues outside of it: a ray from there leads to the wall of another piece, or to the
/// points beyond all atoms, which are component 0 by definition. All other walls are outer walls of
/// cavities. Throws Error if rounding hides the wall of a piece in all directions that are tried.
void connect_walls(const SurfaceModel& surface, Components& components);

}  // namespace eses::detail
