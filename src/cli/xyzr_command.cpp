#include <CLI/CLI.hpp>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "cli/arguments.hpp"
#include "cli/command.hpp"
#include "cli/messages.hpp"
#include "cli/shared_options.hpp"
#include "eses/read_atoms.hpp"
#include "input/other_formats.hpp"
#include "input/radii_set.hpp"
#include "output/text_buffer.hpp"
#include "run/request.hpp"
#include "system/formatted.hpp"

namespace eses::detail::cli {
namespace {

constexpr char xyzr_examples[] =
    R"(  eses-blocks pdb_to_xyzr 1crn.pdb > 1crn.xyzr      x y z radius
  eses-pdb_to_xyzrn 1crn.cif > 1crn.xyzrn           x y z radius 1 ATOM_RESIDUE_NUMBER
  zcat 1crn.pdb.gz | eses-pdb_to_xyzr > 1crn.xyzr   standard input)";

constexpr char xyzr_details[] =
    R"(The radii are those of MSMS for united atoms; hydrogens have 1.2 angstrom. PQR files keep
their radii. Waters and hydrogens are included; eses-msms -noh ignores the hydrogens. Of several
models or alternate locations, only one is read, as by the other commands.

Exit codes:
  0  done
  1  input, output or resource error
  2  error in the command line)";

/// Returns the input file with the options of the radii of MSMS, and whether charges are printed.
std::pair<InputFile, bool> parse_xyzr_arguments(bool has_names, const Arguments& arguments) {
  const std::string name = has_names ? "pdb_to_xyzrn" : "pdb_to_xyzr";
  InputFile input{.path = "-"};
  input.structure.radii = "msms";
  input.structure.with_waters = true;
  input.structure.hydrogens = HydrogenChoice::keep;
  CLI::App app(formatted("Prints the atoms of a PDB, mmCIF or PQR file as spheres for MSMS{}.",
                         has_names ? ", with names" : ""),
               "eses-blocks " + name);
  set_up(app, {.usage = formatted("eses-blocks {} [OPTIONS] [FILE]", name),
               .examples = xyzr_examples,
               .details = xyzr_details});
  add_value(app, "FILE", "", "PDB, mmCIF or PQR file; - for standard input [-]", input.path,
            any_text("a file"));
  add_format(app, input.format, "auto (by suffix, otherwise pdb), pdb, mmcif, pqr or\nxyzr [auto]");
  bool has_charges = false;
  if (!has_names)
    add_flag(app, "--charges",
             "print x y z radius charge with all digits; charges are\nthose of PQR files, else 0",
             has_charges);
  add_value(app, "--unknown-radius", "R",
            "radius of atoms without a known radius, in angstrom\n[such atoms are an error]",
            input.structure.unknown_radius, length_between(0, max_set_radius));
  add_notices(app);
  parse(app, arguments, "FILE");
  const bool is_unknown = input.format == AtomFormat::automatic &&
                          format_of(input.path, input.format) == AtomFormat::xyzr;
  if (is_unknown) input.format = AtomFormat::pdb;
  if (has_names && !is_missing(input.path)) refuse_xyzr(input, "pdb_to_xyzrn", "names");
  return {input, has_charges};
}

/// Returns a radius with at least two decimals.
std::string radius_text(double radius) {
  const std::string shortest = formatted("{}", radius), fixed = formatted("{:.2f}", radius);
  return shortest.size() > fixed.size() ? shortest : fixed;
}

/// Prints the spheres of a file.
int print_spheres(bool has_names, const Arguments& arguments) {
  const auto [input, has_charges] = parse_xyzr_arguments(has_names, arguments);
  require_standard_output();
  const AtomFile file =
      read_atoms(input.path, {.format = input.format, .structure = input.structure});
  BufferedText text([](std::string_view part) { print(part); });
  for (std::size_t i = 0; i < file.atoms.size(); ++i) {
    const auto& [center, radius] = file.atoms[i];
    if (has_names) {
      const AtomLabel& label = file.labels[i];
      text.append("{:.6f} {:.6f} {:.6f} {:.6f} 1 {}_{}_{}\n", center.x, center.y, center.z, radius,
                  label.atom_name, label.residue, label.residue_number);
    } else if (has_charges) {
      text.append("{} {} {} {} {}\n", center.x, center.y, center.z, radius,
                  file.charges.empty() ? 0 : file.charges[i]);
    } else {
      text.append("{:8.3f} {:8.3f} {:8.3f} {}\n", center.x, center.y, center.z,
                  radius_text(radius));
    }
  }
  text.flush();
  return exit_done;
}

}  // namespace

int perform_pdb_to_xyzr(const Arguments& arguments) { return print_spheres(false, arguments); }

int perform_pdb_to_xyzrn(const Arguments& arguments) { return print_spheres(true, arguments); }

}  // namespace eses::detail::cli
