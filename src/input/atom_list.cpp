// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "input/atom_list.hpp"

#include <cmath>

#include "eses/surface.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

void AtomList::add_residue(const std::string& chain, const gemmi::Residue& residue) {
  result_.residues.push_back({chain, residue.name, residue.seqid.str()});
}

void AtomList::add_atom(const gemmi::Atom& atom, const gemmi::Position& at) {
  const auto line = static_cast<std::uint64_t>(atom.serial);
  for (const double value : {at.x, at.y, at.z})
    if (!(std::fabs(value) <= max_coordinate))
      fail_at_line(file_, line,
                   formatted("expected coordinates of at most {:.0f} angstrom", max_coordinate));
  result_.atoms.push_back({{at.x, at.y, at.z},
                           line,
                           static_cast<std::uint32_t>(result_.residues.size() - 1),
                           name_index(atom.name),
                           static_cast<std::uint8_t>(atom.element.atomic_number()),
                           atom.is_hydrogen()});
}

std::uint32_t AtomList::name_index(const std::string& name) {
  const auto next = static_cast<std::uint32_t>(result_.atom_names.size());
  const auto [found, is_new] = names_.emplace(name, next);
  if (is_new) result_.atom_names.push_back(name);
  return found->second;
}

}  // namespace eses::detail
