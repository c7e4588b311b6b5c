// Avoids the dependence of gemmi on stb_sprintf, which is another package in Debian.
#define USE_STD_SNPRINTF

#include "input/build_assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <gemmi/select.hpp>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "input/atom_list.hpp"
#include "input/operator_limit.hpp"
#include "input/select_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// --------------------------------------------------------------------- description of assemblies

/// Returns the texts after BIOMOLECULE in REMARK 350 of a PDB file, an identifier or a list such as
/// `1, 2`. gemmi reads only the first characters of a list.
/// https://www.wwpdb.org/documentation/file-format-content/format33/remarks1.html#REMARK%20350
std::vector<std::string> biomolecules(std::string_view text) {
  constexpr std::string_view record = "remark 350", key = "BIOMOLECULE:";
  constexpr std::size_t key_column = 11;
  std::vector<std::string> lists;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (!starts_with_ignoring_case(line, record) || line.size() < key_column ||
        !line.substr(key_column).starts_with(key))
      continue;
    lists.emplace_back(trimmed(line.substr(key_column + key.size())));
  }
  return lists;
}

/// Returns whether a list such as `1, 2` has the identifier `id`.
bool has_identifier(std::string_view list, std::string_view id) {
  while (true) {
    const std::size_t comma = std::min(list.find(','), list.size());
    if (trimmed(list.substr(0, comma)) == id) return true;
    if (comma == list.size()) return false;
    list.remove_prefix(comma + 1);
  }
}

/// Returns the identifiers of the assemblies, or the list of several that are described at once.
std::vector<std::string> assembly_names(const gemmi::Structure& structure,
                                        const StructureText& text) {
  std::vector<std::string> names;
  names.reserve(structure.assemblies.size());
  for (const gemmi::Assembly& assembly : structure.assemblies) names.push_back(assembly.name);
  if (text.format == AtomFormat::pdb && !names.empty())
    if (std::vector<std::string> lists = biomolecules(text.text); lists.size() == names.size())
      names = std::move(lists);
  return names;
}

const gemmi::Assembly& find_assembly(const gemmi::Structure& structure, const std::string& id,
                                     const StructureText& text) {
  const std::vector<gemmi::Assembly>& assemblies = structure.assemblies;
  std::vector<std::string> names = assembly_names(structure, text);
  auto found = std::find(names.begin(), names.end(), id);
  if (found == names.end() && text.format == AtomFormat::pdb)
    found = std::find_if(names.begin(), names.end(),
                         [&](const std::string& list) { return has_identifier(list, id); });
  if (found != names.end()) return assemblies[static_cast<std::size_t>(found - names.begin())];
  for (std::string& name : names) name = printable(name);
  throw Error(
      formatted("{}: there is no assembly {} (--assembly); {}", text.name, detail::quoted(id),
                names.empty() ? "the file describes none"
                              : formatted("its assemblies are {}", fmt::join(names, ", "))));
}

bool has_chains(const gemmi::Assembly::Gen& generator) {
  const auto has_name = [](const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(),
                       [](const std::string& name) { return !name.empty(); });
  };
  return has_name(generator.chains) || has_name(generator.subchains);
}

/// Throws Error if the assembly `id` has no operators that apply to chains, or too many operators.
void check_description(const gemmi::Assembly& assembly, const std::string& id,
                       const StructureText& text) {
  std::size_t operator_count = 0;
  bool has_any_chains = false, is_usable = false;
  for (const gemmi::Assembly::Gen& generator : assembly.generators) {
    operator_count += generator.operators.size();
    has_any_chains = has_any_chains || has_chains(generator);
    is_usable = is_usable || (has_chains(generator) && !generator.operators.empty());
  }
  if (operator_count > max_operators)
    throw Error(formatted("{}: {}", text.name, too_many_operators()));
  if (is_usable) return;
  const bool is_pdb = text.format == AtomFormat::pdb;
  std::string_view cause = is_pdb ? "REMARK 350 has no list of chains for it"
                                  : "_pdbx_struct_assembly_gen.asym_id_list has no chains for it";
  if (has_any_chains)  // cannot happen in mmCIF, where each list of chains has operators
    cause = "REMARK 350 has no operator for its chains";
  throw Error(formatted("{}: assembly {} has no atoms: {}", text.name, printable(id), cause));
}

// --------------------------------------------------------------------------------------- copies

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

  /// Returns the name of the copy of a chain by the current operator.
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

  /// Returns the number of different operators.
  std::size_t operator_count() const { return transforms_.size(); }

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
  /// Adds an image unless it coincides with an earlier image of the same atom. Returns whether it
  /// was added. Only the images of HETATM records are compared.
  bool add_if_new(const gemmi::Residue& residue, const gemmi::Atom& atom,
                  const gemmi::Position& at) {
    constexpr double distance = 0.5;  // angstrom; smaller than any distance of two atoms
    if (!is_hetatm(residue)) return true;
    std::vector<gemmi::Position>& images = images_[&atom];
    for (const gemmi::Position& image : images)
      if (image.dist_sq(at) < distance * distance) return false;
    images.push_back(at);
    return true;
  }

 private:
  std::unordered_map<const gemmi::Atom*, std::vector<gemmi::Position>> images_;
};

/// The residues of a chain to which operators apply.
struct ChainPart {
  const gemmi::Chain* chain;
  std::vector<const gemmi::Residue*> residues;
};

/// Returns the residues to which the operators of a generator apply. PDB files describe assemblies
/// by chains, mmCIF files by subchains (label_asym_id).
std::vector<ChainPart> parts_of(const gemmi::Assembly::Gen& generator, const gemmi::Model& model) {
  std::unordered_set<std::string> chains(generator.chains.begin(), generator.chains.end());
  std::unordered_set<std::string> subchains(generator.subchains.begin(), generator.subchains.end());
  // An empty name in a list would stand for all residues without a name.
  chains.erase("");
  subchains.erase("");
  std::vector<ChainPart> parts;
  for (const gemmi::Chain& chain : model.chains) {
    const bool is_whole = chains.contains(chain.name);
    ChainPart part{&chain, {}};
    for (const gemmi::Residue& residue : chain.residues)
      if (is_whole || subchains.contains(residue.subchain)) part.residues.push_back(&residue);
    if (!part.residues.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

/// Builds an assembly from the selected atoms of a model.
class AssemblyBuilder {
 public:
  AssemblyBuilder(const gemmi::Model& model, const StructureText& text, Checker& checker,
                  const std::function<void(std::uint64_t bytes)>& require_memory,
                  SelectedStructure& result)
      : model_(model),
        text_(text),
        checker_(checker),
        require_memory_(require_memory),
        result_(result),
        list_(result, text.name),
        names_(model) {}

  void add(const gemmi::Assembly::Gen& generator) {
    const std::vector<ChainPart> parts = parts_of(generator, model_);
    std::uint64_t atom_count = 0;
    for (const ChainPart& part : parts)
      for (const gemmi::Residue* const residue : part.residues) {
        atom_count += residue->atoms.size();
        if (!generator.operators.empty()) contained_.insert(residue);
      }
    for (const gemmi::Assembly::Operator& op : generator.operators) {
      checker_.check();
      names_.begin_operator(op.transform);
      reserve(atom_count);
      for (const ChainPart& part : parts) add_copy(part, op.transform);
    }
  }

  /// Completes the report.
  void finish() {
    result_.report.operators = names_.operator_count();
    for (const gemmi::Chain& chain : model_.chains)
      for (const gemmi::Residue& residue : chain.residues)
        if (!contained_.contains(&residue)) drop(residue);
  }

 private:
  void reserve(std::uint64_t added) const {
    constexpr std::uint64_t max_atoms = std::numeric_limits<AtomIndex>::max();
    if (result_.atoms.size() + added >= max_atoms)
      throw Error(formatted("{}: the assembly has more than {} atoms", text_.name, max_atoms));
    require_memory_(added * 2 * sizeof(StructureAtom));
  }

  void add_copy(const ChainPart& part, const gemmi::Transform& transform) {
    const std::string& name = names_.name_of(part.chain->name);
    for (const gemmi::Residue* const residue : part.residues) {
      list_.add_residue(name, *residue);
      for (const gemmi::Atom& atom : residue->atoms) {
        const gemmi::Position at(transform.apply(atom.pos));
        if (images_.add_if_new(*residue, atom, at))
          list_.add_atom(atom, at);
        else
          ++result_.report.dropped_images;
      }
    }
  }

  // Moves the atoms of a residue from the atoms that were read to those that were left out.
  void drop(const gemmi::Residue& residue) {
    record_count(result_.report, residue) -= residue.atoms.size();
    result_.report.dropped_assembly += residue.atoms.size();
  }

  const gemmi::Model& model_;
  const StructureText& text_;
  Checker& checker_;
  const std::function<void(std::uint64_t bytes)>& require_memory_;
  SelectedStructure& result_;
  AtomList list_;
  CopyNames names_;
  CoincidentImages images_;
  std::unordered_set<const gemmi::Residue*> contained_;
};

/// Returns the numbers of different operators and of atoms of an assembly, without its identifier.
OtherAssembly measure(const gemmi::Assembly& assembly, const gemmi::Model& model) {
  OtherAssembly result;
  CopyNames copies(model);
  std::unordered_set<const gemmi::Residue*> contained;
  for (const gemmi::Assembly::Gen& generator : assembly.generators) {
    const std::vector<ChainPart> parts = parts_of(generator, model);
    if (parts.empty()) continue;
    for (const gemmi::Assembly::Operator& op : generator.operators)
      copies.begin_operator(op.transform);
    for (const ChainPart& part : parts)
      for (const gemmi::Residue* const residue : part.residues)
        if (!generator.operators.empty() && contained.insert(residue).second)
          result.atoms += residue->atoms.size();
  }
  result.operators = copies.operator_count();
  return result;
}

}  // namespace

std::vector<OtherAssembly> find_other_assemblies(const gemmi::Structure& structure,
                                                 const gemmi::Model& model,
                                                 const StructureText& text) {
  const std::uint64_t atoms = gemmi::count_atom_sites(model);
  const std::vector<std::string> names = assembly_names(structure, text);
  std::vector<OtherAssembly> others;
  std::size_t operator_count = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const gemmi::Assembly& assembly = structure.assemblies[i];
    for (const gemmi::Assembly::Gen& generator : assembly.generators)
      operator_count += generator.operators.size();
    if (operator_count > max_operators) break;
    OtherAssembly other = measure(assembly, model);
    if (other.atoms == 0 || (other.operators == 1 && other.atoms == atoms)) continue;
    const std::string_view list = names[i];
    other.id = without_trailing_blanks(list.substr(0, list.find(',')));
    others.push_back(std::move(other));
  }
  return others;
}

void build_assembly(const gemmi::Structure& structure, const std::string& id,
                    const gemmi::Model& model, const StructureText& text, Checker& checker,
                    const std::function<void(std::uint64_t bytes)>& require_memory,
                    SelectedStructure& result) {
  const gemmi::Assembly& assembly = find_assembly(structure, id, text);
  check_description(assembly, id, text);
  result.report.assembly = id;
  AssemblyBuilder builder(model, text, checker, require_memory, result);
  for (const gemmi::Assembly::Gen& generator : assembly.generators) builder.add(generator);
  builder.finish();
}

}  // namespace eses::detail
