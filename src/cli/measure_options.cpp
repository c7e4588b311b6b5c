#include "cli/measure_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "cli/arguments.hpp"
#include "cli/measure_report.hpp"
#include "cli/messages.hpp"
#include "cli/option_values.hpp"
#include "cli/shared_options.hpp"
#include "output/area_formats.hpp"
#include "run/pocket_sweep.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr char measure_examples[] =
    R"(  eses-blocks measure 1crn.pdb                       areas and volumes of a protein
  eses-blocks measure 1crn.pdb --table residues      areas of residues, to standard output
  eses-blocks measure --csv all.csv structures       the files in a folder, in parallel)";

constexpr char measure_details[] =
    R"(Nothing is sampled: areas and volumes have rounding errors only. Units are angstrom.
Only pockets come from a grid.
Atoms share the areas of saddle and concave patches by the power diagram of the spheres.

One file gives a report, several give a line each. Files that cannot be measured are named
on standard error; the others are measured.

Tables (--write), in the output directory, named after the input file NAME:
  NAME.atoms.csv              labels, radius, areas
  NAME.residues.csv           residues, areas, relative SAS area
  NAME.chains.csv             chains, areas
  NAME.derivatives.csv        derivatives of areas and volumes by centres and radii
  NAME.cavities.csv           cavities that hold a probe: volumes, areas, largest probe, atoms
  NAME.pieces.csv             pieces of the molecule: volumes, areas, atoms
  NAME.pockets.csv            pockets: volumes, areas and numbers of mouths, atoms
  NAME.rsa, .seq, .res        SAS areas of residues as NACCESS and FreeSASA print them
  NAME.areas.pdb, .areas.cif  the atoms with SAS areas as B-factors

More examples:
  eses-blocks measure --surface sas --csv sas.csv *.pdb   the fastest way to SAS areas
  eses-blocks measure 1brs.pdb --parts 'A|D'         area buried between two chains
  eses-blocks measure 1crn.pdb --report //A/23       areas of residue 23 in its protein
  eses-blocks measure 1d3z.pdb --model all           all models of an NMR structure
  eses-blocks measure 1crn.pdb --write pdb           areas as B-factors
  eses-blocks measure 1crn.pdb --cavities            cavities and their volumes
  eses-blocks measure 1crn.pdb --pockets             pockets that a probe of 3 does not reach
  eses-blocks measure 1iep.pdb --pockets --at ligand:STI   the pocket of a ligand
  eses-blocks measure 1crn.pdb --like freesasa       atoms and radii as another program
  eses-blocks measure -r all --csv all.csv --resume  many files, after an interruption, too
  eses-blocks measure 1crn.pdb --probe-radius 0      van der Waals surface
  To compute the surface of a file called measure: eses-blocks ./measure

Exit codes:
  0  done
  1  a file could not be measured, or another input, output or resource error
  2  error in the command line)";

constexpr std::array measure_tables{
    Table{"atoms", ".atoms.csv", has_areas, append_measured_atoms},
    Table{"residues", ".residues.csv", needs_names | has_areas | has_relative_areas,
          append_measured_residues},
    Table{"chains", ".chains.csv", needs_names | has_areas, append_measured_chains},
    Table{"derivatives", ".derivatives.csv", needs_ses | has_derivatives, append_derivatives},
    Table{"cavities", ".cavities.csv", needs_ses | has_cavities, append_cavities},
    Table{"pieces", ".pieces.csv", needs_ses | has_pieces, append_pieces},
    Table{"pockets", ".pockets.csv", needs_ses | has_pockets, append_pockets},
    Table{"rsa", ".rsa", needs_names | has_areas | has_relative_areas, append_rsa},
    Table{"seq", ".seq", needs_names | has_areas, append_seq},
    Table{"res", ".res", needs_names | has_areas, append_res},
    Table{"pdb", ".areas.pdb", needs_names | has_areas, append_pdb},
    Table{"cif", ".areas.cif", needs_names | has_areas, append_cif},
};

std::optional<double> probe_radius_in(const std::string& text) {
  const std::optional<double> value = whole_text<double>(text);
  const bool is_valid =
      value && (*value == 0 || (*value >= min_probe_radius && *value <= max_probe_radius));
  return is_valid ? value : std::nullopt;
}

std::optional<SurfaceChoice> surfaces_in(const std::string& list) {
  return choice_in<SurfaceChoice>(list, {},
                                  {{"ses", &SurfaceChoice::ses},
                                   {"sas", &SurfaceChoice::sas},
                                   {"vdw", &SurfaceChoice::vdw},
                                   {"all", &SurfaceChoice::all}});
}

std::optional<PartChoice> parts_in(const std::string& text) {
  if (text == "chains") return PartChoice{.by_chain = true};
  PartChoice choice;
  for (const std::string& part : split(text, '|')) {
    const std::optional<PartSelector> selector = part_selector_in(part);
    if (!selector) return std::nullopt;
    choice.parts.push_back(*selector);
  }
  return choice.parts.size() < 2 ? std::nullopt : std::optional(choice);
}

std::optional<PlaceChoice> place_in(const std::string& text) {
  PlaceChoice place{.text = text, .part = {}, .point = position_in(text), .box = {}};
  if (place.point) return place;
  if (numbers_in<6>(text, ',', -max_finite, max_finite)) {
    const std::optional<Box> box = box_in(text);
    if (!box) return std::nullopt;
    place.box = {box->low, box->high};
    return place;
  }
  // Several numbers are no names of chains, but a point or box that lacks some.
  std::string list = text;
  std::ranges::replace(list, ' ', ',');
  const std::vector<std::string> fields = split(list, ',');
  const auto numbers = std::ranges::count_if(
      fields, [](const std::string& field) { return whole_text<double>(field).has_value(); });
  const std::optional<PartSelector> part = part_selector_in(text);
  if (!part || numbers > 1) return std::nullopt;
  place.part = *part;
  return place;
}

void add_pocket_options(CLI::App& app, MeasureCommandOptions& options) {
  PocketOptions& pockets = options.pocket_options;
  begin_group(app, "Pockets (on a grid)");
  add_flag(app, "--pockets", "report what the probe reaches and a large one does not",
           options.pockets);
  const auto length = length_between(0, max_probe_radius);
  add_value(app, "--at", "PLACE",
            "only pockets and cavities at a place: ligand:STI or ligand\n"
            "(which are left out of the surface), A+B or a selection\n"
            "such as //A/57 (whose atoms bound them), a point X,Y,Z or\n"
            "a box X0,Y0,Z0,X1,Y1,Z1",
            options.at,
            Format<PlaceChoice>{
                place_in, formatted("three numbers X,Y,Z, six X0,Y0,Z0,X1,Y1,Z1 of the lowest "
                                    "and highest corner, {}",
                                    part_texts)})
      ->excludes("--parts", "--report");
  add_value(app, "--large-probe,--probe-out", "ANGSTROM",
            formatted("radius of the large probe, more than that of the\nprobe [{}]",
                      pockets.large_probe_radius),
            pockets.large_probe_radius, length);
  add_value(app, "--spacing", "ANGSTROM",
            formatted("distance between grid points, at most the radius of\nthe probe [{}]",
                      pockets.spacing),
            pockets.spacing, length);
  add_flag(app, "--allow-far-atoms",
           "also search a grid of more than 1e10 points if less than\n1 % of them are near atoms",
           options.allow_far_atoms);
  add_value(
      app, "--min-pocket-volume", "VOLUME",
      "leave out pockets with less volume, in cubic angstrom\n[twice the volume of the probe]",
      pockets.min_volume, at_least_0("cubic angstrom"));
}

/// Throws UsageError if options of pockets are not needed, or out of their range.
void check_pocket_options(const CLI::App& app, const MeasureCommandOptions& options) {
  refuse_without(app, {"--large-probe", "--spacing", "--min-pocket-volume", "--allow-far-atoms"},
                 options.need_pockets(), "--pockets or --write pockets");
  refuse_without(app, {"--at"}, options.need_pockets() || options.need_cavities(),
                 "--pockets, --cavities, or a table of pockets or cavities");
  if (!options.need_pockets()) return;
  try {
    require_valid(options.pocket_options, options.probe_radius);
  } catch (const std::invalid_argument& error) {
    throw UsageError(message_of(error));
  }
}

void add_measure_options(CLI::App& app, MeasureCommandOptions& options) {
  set_up(app, {.usage = "eses-blocks measure [OPTIONS] FILE...",
               .examples = measure_examples,
               .details = measure_details,
               .common = {"--probe-radius", "--surface",   "--parts",  "--report", "--cavities",
                          "--pockets",      "--at",        "--table",  "--write",  "--output-dir",
                          "--csv",          "--resume",    "--like",   "--radii",  "--model",
                          "--waters",       "--no-hetatm", "--chains", "--quiet",  "--json"}});
  begin_group(app, "Surface");
  add_input_files(app, "files or folders (xyzr, PQR, PDB, mmCIF); - for standard input",
                  options.choice);
  add_value(app, "--probe-radius,--probe-in", "ANGSTROM",
            formatted("radius of the solvent probe, 0 or 0.01 to 1000 [{}]", options.probe_radius),
            options.probe_radius,
            Format<double>{probe_radius_in, formatted("0, or a number from {} to {}, in angstrom",
                                                      min_probe_radius, max_probe_radius)});
  add_value(app, "--surface", "LIST", "some of ses,sas,vdw, or all; sas alone is much faster [all]",
            options.surfaces, Format<SurfaceChoice>{surfaces_in, "some of ses,sas,vdw, or all"});
  add_value(app, "--parts", "LIST",
            "measure also the parts of a complex and the areas that\n"
            "it buries: chains (each chain is a part), or two parts\n"
            "and more, such as 'A,B|C', '//A|//B/1-50', 'A|ligand:STI'",
            options.parts,
            Format<PartChoice>{
                parts_in, formatted("chains, or two parts and more, such as 'A,B|C'; a part is {}",
                                    part_texts)});
  add_parts(app, "--report", "ATOMS",
            "report also the areas of these atoms, while all atoms block:\n"
            "A+B, ligand:STI, ligand (all ligands), or a selection such\n"
            "as //A/57; tables have these atoms only; can be repeated",
            options.reports)
      ->expected(1, -1)
      ->allow_extra_args(false)
      ->excludes("--parts");
  add_fill_cavities(app, options.max_filled_void);
  add_flag(app, "--cavities", "report the cavities, and the pieces of the molecule",
           options.cavities);
  add_pocket_options(app, options);
  begin_group(app, "Input and output");
  add_input_lists(app, options.choice);
  add_format(app, options.format);
  add_tables(app, measure_tables,
             "tables to write: atoms,residues,chains,derivatives,cavities,\n"
             "pieces,pockets,rsa,seq,res; areas as B-factors: pdb,cif",
             options);
  add_value(app, "--reference", "NAME",
            "maximum areas of residues, for relative areas: tien\n(2013), miller (1987) or sander "
            "(1994) [tien]",
            options.reference,
            one_of<AreaReference>({{"tien", AreaReference::tien},
                                   {"miller", AreaReference::miller},
                                   {"sander", AreaReference::sander}}));
  add_last_options(
      app, options,
      "write the results of all files as a table; - prints it in\nplace of the report");
}

/// Throws UsageError if an option needs a surface that is not measured.
void check_surfaces(const MeasureCommandOptions& options) {
  const SurfaceChoice& surfaces = options.surfaces;
  const auto refuse_if = [](bool needs, std::string_view option, std::string_view surface) {
    if (needs) throw UsageError(formatted("{} needs --surface {} or all", option, surface));
  };
  if (!surfaces.has_ses()) {
    refuse_if(options.cavities, "--cavities", "ses");
    refuse_if(options.pockets, "--pockets", "ses");
    for (const Table* const table : options.needed_tables())
      refuse_if(table->has(needs_ses), options.option_of(*table), "ses");
  }
  if (surfaces.has_ses() || surfaces.has_sas()) return;
  for (const Table* const table : options.needed_tables())
    refuse_if(true, options.option_of(*table), "sas, ses");
  refuse_if(options.parts.is_chosen(), "--parts", "sas, ses");
  refuse_if(!options.reports.empty(), "--report", "sas, ses");
}

/// Throws UsageError if an option cannot be used with these files.
void check(const CLI::App& app, MeasureCommandOptions& options) {
  refuse_repeated_chains(options.parts, "--parts");
  if (options.printed_table != nullptr && options.has_many())
    throw UsageError(formatted("--table prints the table of a single file or model; use --write {}",
                               options.printed_table->name));
  check_inputs(app, options, [&](const InputFile& input) {
    for (const Table* const table : options.needed_tables())
      if (table->has(needs_names)) refuse_xyzr(input, options.option_of(*table), "names");
    if (options.parts.is_chosen()) refuse_xyzr(input, "--parts", "chains");
    if (!options.reports.empty()) refuse_xyzr(input, "--report", "names");
    if (options.at && options.at->names_atoms()) refuse_xyzr(input, "--at", "names");
  });
}

}  // namespace

MeasureCommandOptions parse_measure_arguments(const Arguments& arguments) {
  CLI::App app("Areas and volumes of molecular surfaces in closed form, without a grid.",
               "eses-blocks measure");
  MeasureCommandOptions options;
  add_measure_options(app, options);
  parse(app, arguments, "FILE...");
  complete_table_options(app, options);
  options.pocket_options.probe_radius = options.probe_radius;
  check_pocket_options(app, options);
  check_surfaces(options);
  check(app, options);
  return options;
}

}  // namespace eses::detail::cli
