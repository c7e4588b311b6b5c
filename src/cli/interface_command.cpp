#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/complex_parts.hpp"
#include "cli/diagnostics.hpp"
#include "cli/interface_options.hpp"
#include "cli/interface_report.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/shared_report.hpp"
#include "eses/interface.hpp"
#include "eses/radii.hpp"
#include "eses/read_atoms.hpp"

namespace eses::detail::cli {
namespace {

/// Returns the divisions of the atoms to measure.
std::vector<ComplexParts> divisions_of(const InterfaceOptions& options, const ReadOptions& reading,
                                       const InterfaceFile& found) {
  const AtomFile& file = found.file;
  const DividedFile divided{found.path, reading, file.labels, file.lines};
  if (!options.ligand.empty()) return divide_by_ligand(options.ligand, divided);
  return {divide(options.groups, divided, "--groups")};
}

/// Adds the interfaces of a division that are large enough.
void add_interfaces(const InterfaceOptions& options, const Surface& surface,
                    const ComplexParts& division, InterfaceFile& file) {
  if (division.names.empty()) return;  // a single chain
  const MeasureOptions measuring{.probe_radius = options.probe_radius, .threads = options.threads};
  for (Interface& areas : measure_interfaces(surface, division.part_of_atom, measuring)) {
    if (areas.sas.interface_area() < options.min_area) continue;
    std::vector<std::uint32_t> parts;
    for (const BuriedAtom& buried : areas.atoms)
      parts.push_back(division.part_of_atom[buried.atom]);
    file.interfaces.push_back({division.names[areas.first], division.names[areas.second],
                               std::move(areas), std::move(parts)});
  }
}

/// Prints the interfaces of a file.
void report_interfaces(const InterfaceOptions& options, std::size_t input) {
  const ReadOptions reading{.format = options.format, .structure = options.structure};
  const std::filesystem::path& path = options.inputs[input];
  InterfaceFile file{.path = path,
                     .file = read_atoms(path, reading),
                     .diagnostics = {},
                     .are_polar = {},
                     .interfaces = {}};
  const Surface surface(file.file, {.threads = options.threads});
  file.diagnostics = describe(file.file, surface, path);
  warn(file.diagnostics, options.strict, options.quiet);
  for (const ComplexParts& division : divisions_of(options, reading, file))
    add_interfaces(options, surface, division, file);
  std::ranges::stable_sort(file.interfaces, std::ranges::greater(),
                           [](const NamedInterface& each) { return each.areas.sas.total(); });
  file.are_polar = find_polar_atoms(file.file.atoms, file.file.labels);
  print(interface_text(options, file));
}

}  // namespace

int perform_interface(const Arguments& arguments) {
  end_on_signals();
  const InterfaceOptions options = parse_interface_arguments(arguments);
  require_standard_output();
  print(interface_heading(options));
  bool has_errors = false;
  for (std::size_t input = 0; input < options.inputs.size(); ++input) {
    std::vector<std::string> errors;
    try {
      report_interfaces(options, input);
    } catch (const StrictError& error) {
      errors = error.lines;
    } catch (const Error& error) {
      errors.push_back(message_with_file(error, options.inputs[input]));
    }
    for (const std::string& error : errors) print_message("error", error);
    if (!errors.empty() && options.json && options.inputs.size() > 1)
      print(failure_json(options.inputs[input], errors.front()));
    has_errors = has_errors || !errors.empty();
  }
  return has_errors ? exit_failure : exit_done;
}

}  // namespace eses::detail::cli
