#pragma once
/// @file
/// Interfaces between the parts of a complex: the areas that they bury of each other.

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "eses/atoms.hpp"
#include "eses/measure.hpp"
#include "eses/surface.hpp"

#pragma GCC visibility push(default)
namespace eses {

/// The part of atoms that belong to no part of a complex. They are left out.
inline constexpr std::uint32_t no_part = std::numeric_limits<std::uint32_t>::max();

/// Area that two parts have alone and not together, in square angstrom.
struct BuriedArea {
  double first = 0;         ///< Area that the first part loses.
  double second = 0;        ///< Area that the second part loses.
  double first_alone = 0;   ///< Area that the first part has alone.
  double second_alone = 0;  ///< Area that the second part has alone.

  /// The area that both lose, the buried surface area.
  double total() const { return first + second; }
  /// Half of the area that both lose, the interface area (Chothia and Janin, Nature 256, 705,
  /// 1975, doi:10.1038/256705a0).
  double interface_area() const { return total() / 2; }
};

/// Area that an atom loses to the other part, in square angstrom. The SES area can grow: saddle and
/// concave patches between the parts belong to both.
struct BuriedAtom {
  AtomIndex atom = 0;  ///< Index of the atom, from 0.
  double sas = 0;      ///< Lost area of the solvent accessible surface.
  double ses = 0;      ///< Lost area of the solvent excluded surface; 0 if it is not measured.
};

/// Two parts of a complex that a probe cannot pass between everywhere.
struct Interface {
  std::uint32_t first = 0;   ///< The lower number of the two parts.
  std::uint32_t second = 0;  ///< The higher number of the two parts.
  BuriedArea sas;            ///< Of the solvent accessible surface.
  BuriedArea ses;            ///< Of the solvent excluded surface; 0 if it is not measured.
  /// The atoms of both parts whose areas differ, in ascending order.
  std::vector<BuriedAtom> atoms;
};

/// Measures the interfaces of all pairs of parts whose solvent accessible spheres meet, in
/// ascending order of the parts. Each pair is measured without the other parts, and each part alone
/// once. `parts` has the number of the part of each atom of `surface`, from 0, or `no_part`. Of the
/// options, those of probe radius, SES, threads and callback apply. Throws std::invalid_argument if
/// an option is out of its range, or if the numbers of parts and atoms differ.
std::vector<Interface> measure_interfaces(const Surface& surface,
                                          std::span<const std::uint32_t> parts,
                                          const MeasureOptions& options = {});

}  // namespace eses
#pragma GCC visibility pop
