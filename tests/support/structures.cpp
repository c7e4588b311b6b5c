#include "support/structures.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <memory>

namespace eses::detail::test {

std::string line_of(const PdbAtom& a) {
  return fmt::format(
      "{:<6}{:>5} {}{}{:>3} {}{}   {:8.3f}{:8.3f}{:8.3f}{:6.2f}{:6.2f}          {}\n", a.record, 1,
      a.name, a.altloc, a.residue, a.chain, a.number, a.x, a.y, a.z, a.occupancy, 20.0, a.element);
}

std::string mixed_text() {
  return line_of({}) + line_of({.name = " HA ", .x = 1, .element = " H"}) +
         line_of({.chain = "B", .x = 20}) +
         line_of({.record = "HETATM",
                  .name = " C1 ",
                  .residue = "LIG",
                  .chain = "B",
                  .number = " 900 ",
                  .x = 40}) +
         line_of({.record = "HETATM",
                  .name = " O  ",
                  .residue = "HOH",
                  .chain = "B",
                  .number = " 901 ",
                  .x = 60,
                  .element = " O"});
}

const std::string dimer_remarks =
    "REMARK 350\n"
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000       10.00000\n";

const std::string mmcif_head = R"(data_TEST
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_entity_id
_atom_site.label_seq_id
_atom_site.pdbx_PDB_ins_code
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.occupancy
_atom_site.B_iso_or_equiv
_atom_site.auth_seq_id
_atom_site.auth_asym_id
_atom_site.pdbx_PDB_model_num
)";

std::string text_with_assembly(const std::string& expression, const std::string& chains) {
  const auto translation = [](const std::string& name, int x) {
    return fmt::format("{} 1 0 0 {} 0 1 0 0 0 0 1 0\n", name, x);
  };
  return mmcif_head +
         "ATOM 1 C CA . ALA A 1 1 ? 1 2 3 1.0 20 1 A 1\nATOM 2 C CA . ALA B 1 1 ? 4 5 6 1.0 20 1 B "
         "1\n"
         "_pdbx_struct_assembly.id X\n"
         "_pdbx_struct_assembly.details 'icosahedral asymmetric unit'\n"
         "loop_\n_pdbx_struct_assembly_gen.assembly_id\n_pdbx_struct_assembly_gen.oper_expression\n"
         "_pdbx_struct_assembly_gen.asym_id_list\nX \"" +
         expression + "\" " + chains +
         "\nother (undefined) A\nloop_\n_pdbx_struct_oper_list.id\n"
         "_pdbx_struct_oper_list.matrix[1][1]\n_pdbx_struct_oper_list.matrix[1][2]\n"
         "_pdbx_struct_oper_list.matrix[1][3]\n_pdbx_struct_oper_list.vector[1]\n"
         "_pdbx_struct_oper_list.matrix[2][1]\n_pdbx_struct_oper_list.matrix[2][2]\n"
         "_pdbx_struct_oper_list.matrix[2][3]\n_pdbx_struct_oper_list.vector[2]\n"
         "_pdbx_struct_oper_list.matrix[3][1]\n_pdbx_struct_oper_list.matrix[3][2]\n"
         "_pdbx_struct_oper_list.matrix[3][3]\n_pdbx_struct_oper_list.vector[3]\n"
         "R 0 -1 0 0 1 0 0 0 0 0 1 0\nbad 1 0 0 ? 0 1 0 0 0 0 1 0\n" +
         translation("T", 100) + translation("1", 10) + translation("2", 20) + translation("3", 30);
}

AtomFile read_pdb(std::string_view text, const StructureOptions& options) {
  return parse_atoms(text, AtomFormat::pdb, "t.pdb", options);
}

AtomFile read_mmcif(std::string_view text, const StructureOptions& options) {
  return parse_atoms(text, AtomFormat::mmcif, "t.cif", options);
}

AtomFile read_structure(const fs::path& path, const StructureOptions& options) {
  ReadOptions all;
  all.structure = options;
  return read_atoms(path, all);
}

std::string pdb_error(std::string_view text, const StructureOptions& options) {
  return error_of([&] { read_pdb(text, options); });
}

Names names_of(const AtomFile& file) {
  Names names;
  for (const AtomLabel& label : file.labels)
    names.push_back(fmt::format("{} {} {} {}", label.chain, label.residue, label.residue_number,
                                label.atom_name));
  return names;
}

std::string text_of(const fs::path& path) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      popen(fmt::format("gzip -dcf '{}'", path.string()).c_str(), "r"), pclose);
  std::string text;
  std::array<char, 65536> buffer{};
  for (std::size_t count = 0; (count = fread(buffer.data(), 1, buffer.size(), pipe.get())) > 0;)
    text.append(buffer.data(), count);
  return text;
}

std::string columns_of(const Vec3& at) {
  return fmt::format("{:8.3f}{:8.3f}{:8.3f}", at.x, at.y, at.z);
}

}  // namespace eses::detail::test
