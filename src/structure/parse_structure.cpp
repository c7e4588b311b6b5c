// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "structure/parse_structure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <gemmi/assembly.hpp>
#include <gemmi/select.hpp>
#include <limits>
#include <map>
#include <new>
#include <set>
#include <unordered_map>
#include <utility>

#include "eses/error.hpp"
#include "io/atom_lines.hpp"
#include "io/text_fields.hpp"
#include "structure/checker.hpp"
#include "structure/messages.hpp"
#include "structure/mmcif_text.hpp"
#include "structure/pdb_text.hpp"
#include "structure/select_atoms.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// Maximum absolute value of a coordinate, as for other formats.
constexpr double max_length = 1e6;  // angstrom

gemmi::Structure parse_mmcif(const StructureText& input, const std::string& assembly,
                             Checker& checker) {
  try {
    return parse_mmcif_text(input.text, std::string(input.name), assembly, checker);
  } catch (const MmcifError& error) {
    if (error.line > 0) fail_at_line(input.name, error.line, reworded(error.message));
    throw Error(formatted("{}: {}", input.name, reworded(error.message)));
  }
}

// --------------------------------------------------------------------------------- atoms as data

/// Converts chains of gemmi to atoms.
class AtomList {
 public:
  AtomList(SelectedStructure& result, std::string_view file) : result_(result), file_(file) {}

  /// Adds the atoms for which `is_taken` is true, with the chain name `chain_name`.
  void add(const gemmi::Chain& chain, const std::string& chain_name, const auto& is_taken) {
    for (const gemmi::Residue& residue : chain.residues) {
      const auto number = static_cast<std::uint32_t>(result_.residues.size());
      result_.residues.push_back({chain_name, residue.name, residue.seqid.str()});
      for (const gemmi::Atom& atom : residue.atoms)
        if (is_taken(residue, atom)) add(atom, number);
    }
  }

 private:
  void add(const gemmi::Atom& atom, std::uint32_t residue) {
    const auto line = static_cast<std::uint64_t>(atom.serial);
    const gemmi::Position& at = atom.pos;
    for (const double value : {at.x, at.y, at.z})
      if (!(std::fabs(value) <= max_length))
        fail_at_line(file_, line,
                     formatted("expected coordinates of at most {:.0f} angstrom", max_length));
    result_.atoms.push_back({{at.x, at.y, at.z},
                             line,
                             residue,
                             name_index(atom.name),
                             static_cast<std::uint8_t>(atom.element.atomic_number()),
                             atom.is_hydrogen()});
  }

  std::uint32_t name_index(const std::string& name) {
    const auto next = static_cast<std::uint32_t>(result_.atom_names.size());
    const auto [found, is_new] = names_.emplace(name, next);
    if (is_new) result_.atom_names.push_back(name);
    return found->second;
  }

  SelectedStructure& result_;
  std::string_view file_;
  std::unordered_map<std::string, std::uint32_t> names_;
};

void sort_by_line(std::vector<StructureAtom>& atoms) {
  const auto is_before = [](const StructureAtom& a, const StructureAtom& b) {
    return a.line < b.line;
  };
  if (!std::is_sorted(atoms.begin(), atoms.end(), is_before))
    std::stable_sort(atoms.begin(), atoms.end(), is_before);
}

// ------------------------------------------------------------------------------------ assemblies

/// Names of the copies of a chain: A, A-2, A-3 and so on, as in the assembly files of the PDB.
/// Operators with equal transformations give the same name.
class CopyNames {
 public:
  explicit CopyNames(const gemmi::Model& model) {
    for (const gemmi::Chain& chain : model.chains) used_.insert(chain.name);
  }

  void begin_operator(const gemmi::Transform& transform) {
    constexpr double equal_transforms = 1e-6;
    const auto found = std::find_if(
        transforms_.begin(), transforms_.end(),
        [&](const gemmi::Transform& other) { return other.approx(transform, equal_transforms); });
    operator_ = static_cast<std::size_t>(found - transforms_.begin());
    if (found == transforms_.end()) transforms_.push_back(transform);
  }

  const std::string& name_of(const std::string& chain) {
    std::map<std::size_t, std::string>& copies = names_[chain];
    const auto [found, is_new] = copies.emplace(operator_, chain);
    if (is_new && copies.size() > 1) {
      for (std::size_t n = copies.size(); used_.contains(found->second); ++n)
        found->second = formatted("{}-{}", chain, n);
      used_.insert(found->second);
    }
    return found->second;
  }

 private:
  std::set<std::string> used_;
  std::vector<gemmi::Transform> transforms_;
  std::size_t operator_ = 0;
  std::map<std::string, std::map<std::size_t, std::string>> names_;
};

/// Detects images of an atom that coincide with an earlier image. Ligands, ions and waters on an
/// axis of symmetry are in the file once, and have several images at the same position.
class CoincidentImages {
 public:
  bool is_known(const gemmi::Residue& residue, const gemmi::Atom& atom) {
    constexpr double distance = 0.5;  // angstrom; smaller than any distance of two atoms
    if (!is_hetatm(residue)) return false;
    std::vector<gemmi::Position>& images = images_[atom.serial];
    for (const gemmi::Position& image : images)
      if (image.dist_sq(atom.pos) < distance * distance) return true;
    images.push_back(atom.pos);
    return false;
  }

 private:
  std::unordered_map<int, std::vector<gemmi::Position>> images_;
};

const gemmi::Assembly& find_assembly(gemmi::Structure& structure, const std::string& id,
                                     std::string_view file) {
  if (const gemmi::Assembly* const found = structure.find_assembly(id)) return *found;
  std::vector<std::string> ids;
  for (const gemmi::Assembly& assembly : structure.assemblies)
    ids.push_back(printable(assembly.name));
  throw Error(formatted("{}: there is no assembly {} (--assembly); {}", file, detail::quoted(id),
                        ids.empty() ? "the file describes none"
                                    : formatted("its assemblies are {}", fmt::join(ids, ", "))));
}

void build_assembly(const gemmi::Assembly& assembly, const gemmi::Model& model,
                    const StructureText& text,
                    const std::function<void(std::uint64_t bytes)>& require_memory,
                    SelectedStructure& result) {
  AtomList list(result, text.name);
  CopyNames names(model);
  CoincidentImages images;
  result.report.operators = 0;
  for (const gemmi::Assembly::Gen& generator : assembly.generators)
    for (const gemmi::Assembly::Operator& one : generator.operators) {
      ++result.report.operators;
      names.begin_operator(one.transform);
      gemmi::Assembly part(assembly.name);
      part.generators.push_back({generator.chains, generator.subchains, {one}});
      const gemmi::Model copy =
          gemmi::make_assembly(part, model, gemmi::HowToNameCopiedChain::Dup, nullptr);
      const std::uint64_t added = gemmi::count_atom_sites(copy);
      if (result.atoms.size() + added >= std::numeric_limits<AtomIndex>::max())
        throw Error(formatted("{}: assembly {} has more than {} atoms", text.name, assembly.name,
                              std::numeric_limits<AtomIndex>::max()));
      require_memory(added * 2 * sizeof(StructureAtom));
      for (const gemmi::Chain& chain : copy.chains)
        list.add(chain, names.name_of(chain.name),
                 [&](const gemmi::Residue& residue, const gemmi::Atom& atom) {
                   const bool is_known = images.is_known(residue, atom);
                   if (is_known) ++result.report.dropped_images;
                   return !is_known;
                 });
    }
}

SelectedStructure parse(const StructureText& text, const StructureOptions& options,
                        bool with_hydrogens,
                        const std::function<void(std::uint64_t bytes)>& require_memory) {
  Checker checker(text.check);
  gemmi::Structure structure =
      text.format == AtomFormat::pdb
          ? parse_pdb_text(text.text, text.name, !options.assembly.empty(), checker)
          : parse_mmcif(text, options.assembly, checker);
  checker.check();
  require_memory(0);
  SelectedStructure result;
  const gemmi::Model& model =
      select_atoms(structure, options, with_hydrogens, text.name, result.report);
  if (!options.assembly.empty()) {
    result.report.assembly = options.assembly;
    build_assembly(find_assembly(structure, options.assembly, text.name), model, text,
                   require_memory, result);
  } else {
    AtomList list(result, text.name);
    for (const gemmi::Chain& chain : model.chains) {
      checker.check();
      list.add(chain, chain.name, [](const gemmi::Residue&, const gemmi::Atom&) { return true; });
    }
    sort_by_line(result.atoms);
  }
  return result;
}

}  // namespace

SelectedStructure parse_structure(const StructureText& text, const StructureOptions& options,
                                  bool with_hydrogens,
                                  const std::function<void(std::uint64_t bytes)>& require_memory) {
  try {
    return parse(text, options, with_hydrogens, require_memory);
  } catch (const Interruption& interruption) {
    std::rethrow_exception(interruption.cause);
  }
}

std::string_view element_symbol(std::uint8_t atomic_number) {
  return gemmi::element_name(static_cast<gemmi::El>(atomic_number));
}

}  // namespace eses::detail
