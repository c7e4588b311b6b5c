#include "cli/shared_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <system_error>

#include "input/atom_reader.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"

namespace eses::detail::cli {
namespace {

constexpr char model_option[] = "--model";
constexpr char structure_group[] = "PDB and mmCIF files";

/// The choice of atoms and radii that a program makes by default. Sets of radii are those of the
/// same name or, for PyMOL, MDTraj and Biopython, the nearest one.
struct Program {
  std::string_view name;
  std::string_view radii;
  bool with_waters;
  bool with_hetatm;
  HydrogenChoice hydrogens;
};
constexpr std::array programs{
    Program{"freesasa", "protor", false, false, HydrogenChoice::drop},
    Program{"zsasa", "protor", false, false, HydrogenChoice::drop},
    Program{"biopython", "bondi", true, true, HydrogenChoice::keep},
    Program{"mdtraj", "bondi", true, true, HydrogenChoice::keep},
    Program{"pymol", "bondi", false, false, HydrogenChoice::keep},
};

/// Adds --like. It must precede the options whose values it sets: they are read in the order in
/// which they are added, so that they replace its values.
void add_like(CLI::App& app, StructureOptions& structure) {
  app.add_option("--like")
      ->option_text("PROGRAM")
      ->description(
          "the atoms and radii that another program takes by default:\n"
          "freesasa, biopython, mdtraj, zsasa or pymol")
      ->each([&structure](const std::string& text) {
        const auto* const program = std::ranges::find(programs, text, &Program::name);
        if (program == programs.end())
          refuse("--like", text, "freesasa, biopython, mdtraj, zsasa or pymol");
        structure.radii = program->radii;
        structure.with_waters = program->with_waters;
        structure.with_hetatm = program->with_hetatm;
        structure.hydrogens = program->hydrogens;
      });
}

bool is_altloc(const std::string& text) { return text.size() == 1 && text != " " && text != "."; }

}  // namespace

void add_format(CLI::App& app, AtomFormat& format, const std::string& description) {
  Format<AtomFormat> known = one_of<AtomFormat>({{"auto", AtomFormat::automatic},
                                                 {"xyzr", AtomFormat::xyzr},
                                                 {"pqr", AtomFormat::pqr},
                                                 {"pdb", AtomFormat::pdb},
                                                 {"mmcif", AtomFormat::mmcif}});
  known.read = [read = known.read, expected = known.expected](const std::string& text) {
    const std::optional<AtomFormat> found = read(text);
    constexpr std::array<std::string_view, 7> outputs{"csv", "json", "jsonl", "tsv",
                                                      "rsa", "seq",  "res"};
    if (!found && std::ranges::find(outputs, text) != outputs.end())
      refuse("--format", text,
             expected +
                 ", the format of the input; outputs of 'eses-blocks measure' are chosen by "
                 "--csv, --json and --table");
    return found;
  };
  add_value(app, "--format", "NAME", description, format, known);
}

CLI::Option* add_parts(CLI::App& app, const std::string& name, const std::string& value_name,
                       const std::string& description, std::vector<PartSelector>& parts) {
  return app.add_option(name)
      ->option_text(value_name)
      ->description(description)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->each([&parts, name](const std::string& text) {
        const std::optional<PartSelector> part = part_selector_in(text);
        if (!part) refuse(name, text, part_texts);
        parts.push_back(*part);
      });
}

void add_threads(CLI::App& app, int& threads) {
  add_value(app, "-t,--threads", "N", "number of threads [all available processors]", threads,
            whole_number_between(1, max_threads));
}

void add_fill_cavities(CLI::App& app, std::optional<double>& max_filled_void) {
  CLI::Option* const fill = app.add_flag("--fill-cavities{inf}")
                                ->option_text("[=VOLUME]")
                                ->multi_option_policy(CLI::MultiOptionPolicy::Throw)
                                ->description(
                                    "fill cavities with voids of up to VOLUME cubic\n"
                                    "angstrom: they are inside [all cavities]");
  read_into(fill, max_filled_void,
            number_between(0, std::numeric_limits<double>::infinity(),
                           "a number of at least 0, in cubic angstrom"));
}

void add_model(CLI::App& app, int& model, bool* all_models) {
  const Format<std::int64_t> number = whole_number_between(1, std::numeric_limits<int>::max());
  if (all_models == nullptr) {
    add_value(app, model_option, "N", "number of the model, also for PQR files [first]", model,
              number);
    return;
  }
  const auto read = [number, all_models](const std::string& text) -> std::optional<std::int64_t> {
    *all_models = text == "all";
    return *all_models ? std::optional<std::int64_t>(0) : number.read(text);
  };
  add_value(app, model_option, "N",
            "number of the model, also for PQR files; all for a result\nfor each one [first]",
            model, Format<std::int64_t>{read, "all, or " + number.expected});
}

void add_structure_options(CLI::App& app, StructureOptions& structure, bool* all_models) {
  begin_group(app, structure_group);
  add_like(app, structure);
  add_value(
      app, "--radii", "NAME",
      "atomic radii: protor, naccess, oons, bondi, msms, also\n"
      "with +shannon for ions; occupancy, or a file [protor]",
      structure.radii,
      any_text("protor, bondi, msms, naccess, oons, one of them with +shannon, occupancy, or a "
               "file"));
  add_value(app, "--unknown-radius", "R",
            "radius of atoms that are not in the set of radii, in\n"
            "angstrom [such atoms are an error]",
            structure.unknown_radius, length_between(0, max_set_radius));
  add_model(app, structure.model, all_models);
  add_value(app, "--altloc", "X", "alternate location [highest occupancy, by residue]",
            structure.altloc, text_if(is_altloc, "one character, such as A"));
  add_flag(app, "--waters", "include water molecules", structure.with_waters);
  add_flag(app, "--no-hetatm", "exclude ligands, ions and modified residues (HETATM)",
           structure.with_hetatm, false);
  add_value(
      app, "--hydrogens", "NAME",
      "keep or drop hydrogens [keep with bondi; drop with the\n"
      "other sets, whose radii include them]",
      structure.hydrogens,
      one_of<HydrogenChoice>({{"keep", HydrogenChoice::keep}, {"drop", HydrogenChoice::drop}}));
  add_value(app, "--chains", "LIST", "include only these chains, such as A,B", structure.chains,
            Format<std::vector<std::string>>{names_in, "names of chains, such as A,B"});
  add_value(app, "--select", "TEXT",
            "include only chains (A+B), ligand:NAME, ligand, or a\nselection such as //A/10-20",
            structure.select,
            text_if([](const std::string& text) { return !text.empty() && text != ligand_prefix; },
                    std::string(part_texts)));
  add_value(app, "--chain-names", "NAME",
            "names of the chains of an mmCIF file: auth (auth_asym_id)\n"
            "or label (label_asym_id) [auth]",
            structure.chain_names,
            one_of<ChainNames>({{"auth", ChainNames::auth}, {"label", ChainNames::label}}));
  add_value(app, "--assembly", "ID", "build this biological assembly", structure.assembly,
            any_text("the identifier of an assembly, such as 1"));
}

bool is_missing(const std::filesystem::path& input) {
  std::error_code ignored;
  return input != "-" && !std::filesystem::exists(input, ignored);
}

void refuse_xyzr(const InputFile& input, std::string_view option, std::string_view names) {
  if (format_of(input.path, input.format) == AtomFormat::xyzr)
    throw UsageError(
        formatted("{} needs a PQR, PDB or mmCIF file; {} is read as xyzr, which has no {} (use "
                  "--format pqr, pdb or mmcif if it is such a file)",
                  option, input.path.string(), names));
}

void refuse_structure_options(const CLI::App& app, const InputFile& input) {
  const AtomFormat format = format_of(input.path, input.format);
  if (is_structure(format)) return;
  for (const CLI::Option* const option : app.get_options()) {
    if (option->count() == 0 || option->get_group() != structure_group) continue;
    const std::string name = option->get_name();
    const bool is_model = name == model_option;  // the one option that also applies to PQR files
    if (format == AtomFormat::pqr && is_model) continue;
    const bool has_report = app.get_option_no_throw("--report") != nullptr;
    const std::string_view advice =
        format == AtomFormat::pqr && name == "--select" && has_report
            ? "; --report takes atoms of PQR files, while all other atoms block"
            : "";
    throw UsageError(formatted(
        "{} needs a {}PDB or mmCIF file; {} is read as {} (use --format {}pdb or "
        "--format mmcif if it is one){}",
        name, is_model ? "PQR, " : "", input.path.string(),
        format == AtomFormat::pqr ? "PQR" : "xyzr", is_model ? "pqr, --format " : "", advice));
  }
}

}  // namespace eses::detail::cli
