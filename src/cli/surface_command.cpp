#include "cli/surface_command.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/report.hpp"
#include "cli/run_display.hpp"
#include "eses/error.hpp"
#include "eses/molecule.hpp"
#include "eses/read_atoms.hpp"
#include "output/output_files.hpp"
#include "plan/memory.hpp"
#include "system/bytes_text.hpp"
#include "system/resources.hpp"

namespace eses::cli {
namespace {

Summary run_with_progress(const Molecule& molecule, const Options& options, const Plan& plan) {
  InterruptibleRun interruptible(temporary_paths(options.outputs, options.output_directory),
                                 lock_paths(options.outputs, options.output_directory));
  RunDisplay display(interruptible, !options.quiet);
  Summary summary =
      run(molecule, plan, options.outputs, options.output_directory, display.callbacks());
  interruptible.check();
  return summary;
}

/// Refuses more atoms than any run within the memory limit could hold, before anything is made of
/// them. Plans for few atoms take little memory, and tell the smallest limit that would do.
void require_memory_for(std::size_t atoms, const Options& options) {
  const double least = min_expected_memory(atoms), without_atoms = min_expected_memory(0);
  const std::uint64_t limit = options.parameters.max_memory;
  if (limit == 0 || least <= static_cast<double>(limit) || least < 2 * without_atoms) return;
  throw Error(fmt::format(
      "{}: {} atoms need more than {} of memory, and the run may hold {}; use a larger limit "
      "(--max-memory)",
      options.input.string(), atoms, binary_bytes_text(static_cast<std::uint64_t>(least)),
      binary_bytes_text(limit)));
}

/// Throws Error if reading the atoms and preparing them has exceeded the memory limit.
void require_memory_held(const Options& options) {
  const std::uint64_t limit = options.parameters.max_memory, peak = peak_memory();
  if (limit == 0 || peak <= limit) return;
  throw Error(
      fmt::format("{}: reading and preparing its atoms has taken {}, more than the {} that the run "
                  "may hold; use "
                  "a larger limit (--max-memory)",
                  options.input.string(), binary_bytes_text(peak), binary_bytes_text(limit)));
}

// `lines` are those of the atoms in the file.
Report plan_report(const Molecule& molecule, std::span<const std::uint64_t> lines,
                   const Options& options) {
  Report report;
  report.options = options;
  report.atoms = molecule.atoms().size();
  report.findings = describe(
      molecule.oddities(), [lines](AtomIndex atom) { return lines[atom]; }, options.input);
  report.plan = make_plan(molecule, options.parameters, options.outputs);
  require_memory_held(options);
  report.disk = require_disk_space(report.plan, options.outputs, options.output_directory);
  return report;
}

/// Whether any output names chains or residues.
bool needs_labels(const OutputChoice& outputs) {
  return outputs.residues || (outputs.mesh && mesh_format(outputs.mesh->file) == MeshFormat::ply);
}

}  // namespace

void refuse_to_lose_input(const Options& options) {
  const auto refuse_if_input = [&](const std::string& file, std::string_view fate) {
    std::error_code error;  // as where there is no such file yet
    if (std::filesystem::equivalent(options.input, file, error) && !error)
      throw Error(fmt::format("{} is the input, and would be {}", file, fate));
  };
  for (const std::string& file : final_paths(options.outputs, options.output_directory))
    refuse_if_input(file, "overwritten");
  for (const std::string& file : stale_paths(options.outputs, options.output_directory))
    refuse_if_input(file, options.outputs.gzip ? "removed, as a gzipped file takes its place"
                                               : "removed, as a plain file takes its place");
}

void refuse_residues_of_xyzr(const Options& options) {
  if (options.outputs.residues && format_of(options.input, options.format) != AtomFormat::pqr)
    throw Error(
        fmt::format("{}: areas by residue (--write residues) need a PQR file; xyzr does not "
                    "tell chains and residues",
                    options.input.string()));
}

int compute_alone(const Options& options) {
  require_standard_output();
  refuse_to_lose_input(options);
  refuse_residues_of_xyzr(options);
  require_places(options.outputs, options.output_directory);
  NumberedAtoms input =
      read_numbered_atoms(options.input, {.format = options.format,
                                          .with_labels = needs_labels(options.outputs),
                                          .max_memory = options.parameters.max_memory});
  require_memory_for(input.atoms.size(), options);
  const Molecule molecule(std::move(input.atoms), std::move(input.labels),
                          options.parameters.threads);
  Report report = plan_report(molecule, input.lines, options);
  if (options.dry_run) {
    print(options.json ? json_text(report) : plan_text(report));
    warn(report);
    return exit_done;
  }
  if (options.strict) warn(report);
  announce(report);
  if (!options.strict) warn(report);
  report.summary = run_with_progress(molecule, options, report.plan);
  report.peak_memory_bytes = peak_memory();
  print(final_text(report));
  warn_if_empty(report);
  for (const std::string& fault : fault_lines(report.summary)) complain("error", fault);
  return exit_code(report.summary);
}

}  // namespace eses::cli
