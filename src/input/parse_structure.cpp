// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "input/parse_structure.hpp"

#include <algorithm>
#include <cstddef>
#include <gemmi/elem.hpp>
#include <gemmi/model.hpp>

#include "eses/error.hpp"
#include "input/atom_list.hpp"
#include "input/build_assembly.hpp"
#include "input/checker.hpp"
#include "input/mmcif_text.hpp"
#include "input/pdb_text.hpp"
#include "input/select_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

void sort_by_line(std::vector<StructureAtom>& atoms) {
  const auto is_before = [](const StructureAtom& a, const StructureAtom& b) {
    return a.line < b.line;
  };
  if (!std::is_sorted(atoms.begin(), atoms.end(), is_before))
    std::stable_sort(atoms.begin(), atoms.end(), is_before);
}

/// Throws Error if an assembly file of the PDB has several models. They are copies, of which only
/// the first one would be read.
void refuse_copies(const gemmi::Structure& structure, std::string_view name) {
  if (structure.models.size() < 2) return;
  throw Error(
      formatted("{}: {} models, which are the copies of an assembly in files of this suffix; read "
                "one with --model N, or build the assembly from the entry's PDB or mmCIF file with "
                "--assembly ID",
                name, structure.models.size()));
}

}  // namespace

SelectedStructure parse_structure(const StructureText& text, const StructureOptions& options,
                                  bool with_hydrogens,
                                  const std::function<void(std::uint64_t bytes)>& require_memory) {
  Checker checker(text.check);
  gemmi::Structure structure =
      text.format == AtomFormat::pdb
          ? parse_pdb_text(text.text, text.name, !options.assembly.empty(), checker)
          : parse_mmcif_text(text.text, text.name, options.assembly, checker);
  checker.check();
  if (text.is_assembly_file && options.model == 0) refuse_copies(structure, text.name);
  require_memory(0);
  SelectedStructure result;
  const gemmi::Model& model =
      select_atoms(structure, options, with_hydrogens, text.name, result.report);
  if (!options.assembly.empty()) {
    build_assembly(structure, options.assembly, model, text, checker, require_memory, result);
  } else {
    if (!text.is_assembly_file)
      result.report.other_assemblies = find_other_assemblies(structure, model, text);
    AtomList list(result, text.name);
    for (const gemmi::Chain& chain : model.chains) {
      checker.check();
      for (const gemmi::Residue& residue : chain.residues) {
        list.add_residue(chain.name, residue);
        for (const gemmi::Atom& atom : residue.atoms) list.add_atom(atom, atom.pos);
      }
    }
    sort_by_line(result.atoms);
  }
  return result;
}

std::string_view element_symbol(std::uint8_t atomic_number) {
  return gemmi::element_name(static_cast<gemmi::El>(atomic_number));
}

}  // namespace eses::detail
