#include "input/structure/build_assembly.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "eses/error.hpp"
#include "input/structure/select_atoms.hpp"
#include "input/text_fields.hpp"
#include "system/formatted.hpp"

namespace eses::detail {
namespace {

// --------------------------------------------------------------------- description of assemblies

const gemmi::Assembly& find_assembly(const gemmi::Structure& structure, const std::string& id,
                                     const StructureText& text) {
  const std::vector<gemmi::Assembly>& assemblies = structure.assemblies;
  auto found = std::find_if(assemblies.begin(), assemblies.end(),
                            [&](const gemmi::Assembly& assembly) { return assembly.name == id; });
  // The name is a list if a PDB file describes several assemblies at once.
  if (found == assemblies.end() && text.format == AtomFormat::pdb)
    found =
        std::find_if(assemblies.begin(), assemblies.end(), [&](const gemmi::Assembly& assembly) {
          return gemmi::in_vector(id, gemmi::split_str_multi(assembly.name, ", 	"));
        });
  if (found != assemblies.end()) return *found;
  std::vector<std::string> names;
  names.reserve(assemblies.size());
  for (const gemmi::Assembly& assembly : assemblies) names.push_back(printable(assembly.name));
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

std::size_t count_operators(const gemmi::Assembly& assembly) {
  std::size_t count = 0;
  for (const gemmi::Assembly::Gen& generator : assembly.generators)
    count += generator.operators.size();
  return count;
}

/// Throws Error if the assembly `id` has no operators that apply to chains, or too many operators.
void check_description(const gemmi::Assembly& assembly, const std::string& id,
                       const StructureText& text) {
  bool has_any_chains = false, is_usable = false;
  for (const gemmi::Assembly::Gen& generator : assembly.generators) {
    has_any_chains = has_any_chains || has_chains(generator);
    is_usable = is_usable || (has_chains(generator) && !generator.operators.empty());
  }
  if (count_operators(assembly) > max_operators)
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

/// The different operators of an assembly. Operators with equal transformations count once.
class DistinctOperators {
 public:
  /// Returns the index of an operator, which may be new.
  std::size_t index_of(const gemmi::Transform& transform) {
    constexpr double equal_transforms = 1e-6;
    const auto found = std::find_if(
        transforms_.begin(), transforms_.end(),
        [&](const gemmi::Transform& other) { return other.approx(transform, equal_transforms); });
    const auto index = static_cast<std::size_t>(found - transforms_.begin());
    if (found == transforms_.end()) transforms_.push_back(transform);
    return index;
  }

  std::size_t count() const { return transforms_.size(); }

 private:
  std::vector<gemmi::Transform> transforms_;
};

/// Names of the copies of a chain: A, A-2, A-3 and so on, as in the assembly files of the PDB.
class CopyNames {
 public:
  /// Adds the names to `names`, which must outlive the pointers to them.
  CopyNames(const gemmi::Model& model, std::set<std::string>& names) : names_(names) {
    for (const gemmi::Chain& chain : model.chains) names_.insert(chain.name);
  }

  /// Returns the name of the copy of a chain by an operator. The first copy has the chain's name.
  const std::string* name_of(const std::string& chain, std::size_t operator_index) {
    std::map<std::size_t, const std::string*>& copies = copies_[chain];
    const std::string*& name = copies[operator_index];
    if (name == nullptr && copies.size() == 1) name = &*names_.find(chain);
    for (std::size_t n = copies.size(); name == nullptr; ++n)
      if (const auto [at, is_new] = names_.insert(formatted("{}-{}", chain, n)); is_new)
        name = &*at;
    return name;
  }

 private:
  std::set<std::string>& names_;
  std::map<std::string, std::map<std::size_t, const std::string*>> copies_;
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
  AssemblyBuilder(const gemmi::Model& model, const StructureText& text,
                  std::set<std::string>& names)
      : model_(model), text_(text), names_(model, names) {}

  void add(const gemmi::Assembly::Gen& generator) {
    const std::vector<ChainPart> parts = parts_of(generator, model_);
    std::uint64_t atom_count = 0;
    for (const ChainPart& part : parts)
      for (const gemmi::Residue* const residue : part.residues) {
        atom_count += residue->atoms.size();
        if (!generator.operators.empty()) contained_.insert(residue);
      }
    for (const gemmi::Assembly::Operator& op : generator.operators) {
      text_.check();
      require_room(atom_count);
      const std::size_t index = operators_.index_of(op.transform);
      for (const ChainPart& part : parts)
        add_copy(part, op.transform, names_.name_of(part.chain->name, index));
    }
  }

  /// Returns the atoms and completes the report.
  std::vector<StructureAtom> finish(StructureReport& report) {
    report.operators = operators_.count();
    report.dropped_images = dropped_images_;
    for (const gemmi::Chain& chain : model_.chains)
      for (const gemmi::Residue& residue : chain.residues)
        if (!contained_.contains(&residue)) {
          record_count(report, residue) -= residue.atoms.size();
          report.dropped_assembly += residue.atoms.size();
        }
    return std::move(atoms_);
  }

 private:
  void require_room(std::uint64_t added) const {
    constexpr std::uint64_t max_atoms = std::numeric_limits<AtomIndex>::max();
    if (atoms_.size() + added >= max_atoms)
      throw Error(formatted("{}: the assembly has more than {} atoms", text_.name, max_atoms));
    text_.require_memory(added * 2 * sizeof(StructureAtom));
  }

  void add_copy(const ChainPart& part, const gemmi::Transform& transform, const std::string* name) {
    for (const gemmi::Residue* const residue : part.residues)
      for (const gemmi::Atom& atom : residue->atoms) {
        const gemmi::Position at(transform.apply(atom.pos));
        if (images_.add_if_new(*residue, atom, at))
          atoms_.push_back({&atom, residue, name, {at.x, at.y, at.z}});
        else
          ++dropped_images_;
      }
  }

  const gemmi::Model& model_;
  const StructureText& text_;
  std::vector<StructureAtom> atoms_;
  DistinctOperators operators_;
  CopyNames names_;
  CoincidentImages images_;
  std::uint64_t dropped_images_ = 0;
  std::unordered_set<const gemmi::Residue*> contained_;
};

/// Returns the numbers of different operators and of atoms of an assembly, without its identifier.
OtherAssembly measure(const gemmi::Assembly& assembly, const gemmi::Model& model) {
  OtherAssembly result;
  DistinctOperators operators;
  std::unordered_set<const gemmi::Residue*> contained;
  for (const gemmi::Assembly::Gen& generator : assembly.generators) {
    const std::vector<ChainPart> parts = parts_of(generator, model);
    if (parts.empty()) continue;
    for (const gemmi::Assembly::Operator& op : generator.operators)
      operators.index_of(op.transform);
    for (const ChainPart& part : parts)
      for (const gemmi::Residue* const residue : part.residues)
        if (!generator.operators.empty() && contained.insert(residue).second)
          result.atoms += residue->atoms.size();
  }
  result.operators = operators.count();
  return result;
}

}  // namespace

std::vector<OtherAssembly> find_other_assemblies(const gemmi::Structure& structure) {
  const gemmi::Model& model = structure.models.front();
  const std::uint64_t atoms = count_atoms(model);
  std::vector<OtherAssembly> others;
  std::size_t operator_count = 0;
  for (const gemmi::Assembly& assembly : structure.assemblies) {
    operator_count += count_operators(assembly);
    if (operator_count > max_operators) break;
    OtherAssembly other = measure(assembly, model);
    if (other.atoms == 0 || (other.operators == 1 && other.atoms == atoms)) continue;
    // The id of a list of assemblies is the id of the first one.
    other.id = without_trailing_blanks(assembly.name.substr(0, assembly.name.find(',')));
    others.push_back(std::move(other));
  }
  return others;
}

std::vector<StructureAtom> build_assembly(const gemmi::Structure& structure,
                                          const StructureText& text, std::set<std::string>& names,
                                          StructureReport& report) {
  const std::string& id = text.options.structure.assembly;
  const gemmi::Assembly& assembly = find_assembly(structure, id, text);
  check_description(assembly, id, text);
  report.assembly = id;
  AssemblyBuilder builder(structure.models.front(), text, names);
  for (const gemmi::Assembly::Gen& generator : assembly.generators) builder.add(generator);
  return builder.finish(report);
}

}  // namespace eses::detail
