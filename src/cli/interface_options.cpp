#include "cli/interface_options.hpp"

#include <CLI/CLI.hpp>
#include <array>
#include <filesystem>
#include <limits>
#include <vector>

#include "cli/arguments.hpp"
#include "cli/input_files.hpp"
#include "cli/shared_options.hpp"
#include "output/area_formats.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr char interface_examples[] =
    R"(  eses-blocks interface 1brs.pdb                    all pairs of chains that touch
  eses-blocks interface 1ahw.cif --groups A+B C     chains A and B against chain C
  eses-blocks interface 1iep.pdb --ligand STI       how much of each ligand is buried)";

constexpr char interface_details[] =
    R"(Both sides lose area where the other one keeps the probe away. The interface area is half of
what both lose of the SAS (Chothia and Janin 1975), as in ChimeraX and PISA. The SES areas are
those of the solvent excluded surface. Each pair is measured without all other atoms of the
file. Nothing is sampled. Units are square angstrom.

Groups and their atoms:
  A+B            chains A and B
  ligand:STI     all residues named STI; ligand:A/401 is residue 401 of chain A
  ligand         all residues of several atoms that are no amino acids, nucleotides or waters
  //A/10-50      a selection in gemmi's syntax

Tables (--write), in the output directory, named after the input file NAME:
  NAME.interfaces.csv          areas of both sides, numbers of residues and atoms
  NAME.interface.residues.csv  residues that lose at least the area of --residue-cutoff
  NAME.interface.atoms.csv     atoms that lose area
  NAME.interface.areas.pdb, .interface.areas.cif
                               the atoms with the SAS areas that they lose as B-factors: the
                               sum over all interfaces of the file

More examples:
  eses-blocks interface 1brs.pdb --table residues   the residues of each interface, as CSV
  eses-blocks interface 1brs.pdb --write pdb        buried areas as B-factors
  eses-blocks interface complexes --csv all.csv     all files in a folder
  eses-blocks interface 1xyz.pdb --model all        each model of an NMR structure

Exit codes:
  0  done
  1  input, output or resource error
  2  error in the command line)";

constexpr std::array interface_tables{
    Table{"interfaces", ".interfaces.csv", rows_of_interfaces},
    Table{"residues", ".interface.residues.csv", rows_of_residues},
    Table{"atoms", ".interface.atoms.csv", rows_of_atoms},
    Table{"pdb", ".interface.areas.pdb", no_rows,
          [](const MeasuredAtoms& atoms, BufferedText& text) {
            append_pdb(pdb_heading_of_interface, atoms, text);
          }},
    Table{"cif", ".interface.areas.cif", no_rows, append_cif},
};

void add_interface_options(CLI::App& app, InterfaceOptions& options) {
  set_up(app, {.usage = "eses-blocks interface [OPTIONS] FILE...",
               .examples = interface_examples,
               .details = interface_details,
               .common = {"--groups", "--ligand", "--probe-radius", "--area-cutoff",
                          "--residue-cutoff", "--table", "--write", "--output-dir", "--csv",
                          "--resume", "--radii", "--model", "--waters", "--no-hetatm", "--chains",
                          "--select", "--threads", "--quiet", "--json"}});
  begin_group(app, "Interfaces");
  add_input_files(app, "input files (PDB, mmCIF or PQR), or folders of them; - for\nstandard input",
                  options.choice);
  add_parts(app, "--groups", "GROUP GROUP", "the two sides, such as A+B C [each chain is a side]",
            options.groups.parts)
      ->expected(2);
  add_value(
      app, "--ligand", "LIGAND",
      "each residue of this name (STI), this residue (A/401), or\n"
      "each of a selection, against all other atoms of the file",
      options.ligand,
      Format<PartSelector>{ligand_selector_in, "a residue, such as HEM or A/401, or a selection"});
  add_value(app, "--probe-radius", "ANGSTROM",
            formatted("radius of the solvent probe [{}]", options.probe_radius),
            options.probe_radius, length_between(min_probe_radius, max_probe_radius));
  const auto area = number_between(0, std::numeric_limits<double>::max(),
                                   "a number of at least 0, in square angstrom");
  add_value(app, "--area-cutoff", "AREA",
            formatted("leave out interfaces with less SAS interface area [{}]", options.min_area),
            options.min_area, area);
  add_value(app, "--residue-cutoff", "AREA",
            formatted("SAS area that a residue of an interface loses at\nleast [{}]",
                      options.min_residue_area),
            options.min_residue_area, area);
  begin_group(app, "Input and output");
  add_input_lists(app, options.choice);
  add_format(app, options.format);
  add_tables(app, interface_tables,
             "tables to write: interfaces,residues,atoms; buried areas\nas B-factors: pdb,cif",
             options);
  add_last_options(
      app, options,
      "write the interfaces of all files as a table; - prints it\nin place of the report");
}

/// Throws UsageError if a side follows the two of --groups, as it would be read as a file.
void refuse_third_side(const InterfaceOptions& options) {
  const std::vector<PartSelector>& sides = options.groups.parts;
  if (sides.size() != 2) return;
  for (const std::filesystem::path& path : options.choice.paths)
    if (!path.has_extension() && is_missing(path))
      throw UsageError(formatted(
          "--groups takes two sides, here {} and {}, and there is no file {}; chains of a side are "
          "joined by +, as in eses-blocks interface FILE --groups A+B C",
          sides[0].text, sides[1].text, path.string()));
}

}  // namespace

InterfaceOptions parse_interface_arguments(const Arguments& arguments) {
  CLI::App app("Areas that the parts of a complex bury of each other, in closed form.",
               "eses-blocks interface");
  InterfaceOptions options;
  add_interface_options(app, options);
  parse(app, arguments, "FILE...");
  options.groups.by_chain = options.groups.parts.empty();
  complete_table_options(app, options);
  const bool prints_atoms = options.printed_table != nullptr && options.printed_table->append;
  if (prints_atoms && options.has_many())
    throw UsageError("--table pdb and cif print the atoms of a single file or model; use --write");
  refuse_third_side(options);
  check_inputs(options, [&](const std::filesystem::path& path) {
    refuse_other_input(app, options, path);
    refuse_xyzr({path, options.format}, "interface", "chains");
  });
  refuse_repeated_chains(options.groups, "--groups");
  if (!options.groups.by_chain && options.groups.parts.size() != 2)
    throw UsageError("--groups needs two sides, such as --groups A+B C");
  if (options.ligand && !options.groups.by_chain)
    throw UsageError(formatted("--ligand cannot be combined with --groups; use --groups {} A",
                               options.ligand->text));
  return options;
}

}  // namespace eses::detail::cli
