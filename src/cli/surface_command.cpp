#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/command.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/surface_options.hpp"
#include "cli/surface_report.hpp"
#include "eses/error.hpp"
#include "geometry/make_grid.hpp"
#include "input/radii_set.hpp"
#include "output/file_path.hpp"
#include "output/output_files.hpp"
#include "run/engine.hpp"
#include "system/formatted.hpp"
#include "system/processes.hpp"

namespace eses::detail::cli {
namespace {

/// Throws Error if several processes were started together but cannot communicate. They usually
/// have the same command line and would write the same files.
void refuse_same_files(const Options& options, const Processes& processes) {
  const int launched = Processes::launched_count();
  if (launched == 1 || processes.count() > 1 || options.independent || options.request.dry_run)
    return;
  if (options.request.part) return;
  const bool has_files =
      !output_paths(options.request.outputs, options.request.output_directory).final.empty();
  if (!options.request.resume && !has_files) return;
  throw Error(
      formatted("started as one of {} processes that would all write the same files; to share "
                "one run, {}; for separate runs, use --independent and separate output "
                "directories",
                launched, Processes::advice()));
}

// Performs an action in the first process. All processes throw its exceptions.
void on_rank_zero(const Processes& processes, const std::function<void()>& action) {
  std::vector<std::string> errors;
  processes.all_or_throw([&] {
    if (!processes.is_first()) return;
    try {
      action();
    } catch (const StrictError& error) {
      errors = error.lines;
    }
  });
  if (processes.sum(errors.size()) > 0) throw StrictError{errors};
}

// Returns the files that a run reads. The name of a set of radii counts as a file, too, because no
// output has such a name.
std::vector<ReadFile> files_to_read(const Options& options) {
  std::vector<ReadFile> files{{options.input().path, "the input"}};
  if (!options.grid.like.empty()) files.push_back({options.grid.like, "the file of --grid-like"});
  files.push_back({radii_file(options.input().structure.radii), "the file of --radii"});
  if (const auto& mesh = options.request.outputs.mesh; mesh && mesh->potential)
    files.push_back({mesh->potential->file, "the file of --potential"});
  return files;
}

// Throws Error if the run would overwrite or remove a file that it reads.
void refuse_to_lose_input(const Options& options) {
  const std::vector<ReadFile> read = files_to_read(options);
  const ReadFiles files(read);
  for (const std::string& file :
       output_paths(options.request.outputs, options.request.output_directory).final)
    files.refuse(file);
  for (const std::string& file :
       stale_paths(options.request.outputs, options.request.output_directory))
    files.refuse(file, options.request.outputs.gzip ? "removed, as a gzipped file takes its place"
                                                    : "removed, as a plain file takes its place");
  const std::filesystem::path checkpoint = options.request.output_directory / checkpoint_name;
  std::error_code missing;  // if there is no checkpoint
  for (const auto& [path, role] : read)
    if (path.has_parent_path() && equivalent(path.parent_path(), checkpoint, missing))
      throw Error(formatted("{} is {}, and would be removed with the chunks of --resume",
                            path.string(), role));
}

// Performs the checks that do not need the input.
void check_request(const Options& options) {
  require_standard_output();
  refuse_to_lose_input(options);
  require_writable_files(options.request.outputs, options.request.output_directory);
}

// Plans a run.
Report plan(const Options& options, const Processes& processes) {
  Report report{.options = options,
                .run = plan_run(options.request, processes),
                .process_count = processes.count()};
  report.diagnostics = describe(report.run.input.diagnostics, options.input().path);
  return report;
}

// Prints the plan, unless --quiet is given.
void announce(const Report& report) {
  if (report.options.quiet) return;
  if (!report.options.json) {
    print(plan_text(report));
  } else if (isatty(STDERR_FILENO) == 1) {
    std::fputs(plan_text(report).c_str(), stderr);
  }
}

// Prints the plan and the warnings. With --strict, warnings end the run before the plan is printed,
// except in a dry run.
void present_plan(Report& report) {
  const Options& options = report.options;
  report.disk = require_disk_space(report.run.file_sizes, options.request.outputs,
                                   options.request.output_directory);
  add_run_diagnostics(report);
  const auto warn_or_throw = [&] {
    for (const std::string& warning :
         warnings_to_print(report.diagnostics, options.strict, options.quiet))
      print_message("warning", warning);
  };
  if (options.request.dry_run) {
    print(options.json ? json_text(report) : plan_text(report));
    warn_or_throw();
    return;
  }
  if (options.strict) warn_or_throw();
  announce(report);
  if (!options.strict) warn_or_throw();
}

// Returns the final report, as text or JSON.
std::string final_text(const Report& report) {
  if (report.options.json) return json_text(report);
  // Scripts search for these two lines, so faulty results must not be printed.
  const std::string result =
      has_faults(report.result.summary) ? "" : result_text(report.result.summary);
  return report.options.quiet ? result : result + summary_text(report);
}

// Returns whether no point of the grid around the atoms is inside the surface.
bool is_empty(const Report& report) {
  const Parameters& parameters = report.options.request.parameters;
  return report.result.summary.inside_points == 0 &&
         std::holds_alternative<std::monostate>(parameters.part) && !parameters.has_custom_grid();
}

void present_result(Report& report) {
  const bool has_warning = is_empty(report);
  if (has_warning)
    report.diagnostics.push_back(program_warning(
        "empty_surface", "no grid point is inside the surface; use a smaller spacing"));
  print(final_text(report));
  if (has_warning && !report.options.quiet)
    print_message("warning", report.diagnostics.back().message);
  for (const std::string& fault : fault_lines(report.result.summary)) print_message("error", fault);
}

// Returns the paths of the files that the first process makes, in all processes.
OutputPaths paths_of(const Request& request, const Processes& processes) {
  OutputPaths paths;
  if (processes.is_first() && !request.part)
    paths = output_paths(request.outputs, request.output_directory);
  for (auto* const lines : {&paths.temporaries, &paths.locks})
    *lines = processes.gather_texts(*lines);
  return paths;
}

// Computes the surface and adds the results to the report.
void run_with_progress(const Processes& processes, Report& report) {
  PlannedRun& run = report.run;
  InterruptibleRun interruptible(paths_of(run.request, processes));
  ProgressBar bar(!report.options.quiet && processes.is_first());
  const auto show_blocks = [&](std::int64_t done, std::int64_t total) {
    interruptible.check();
    bar.show_blocks(done, total);
  };
  const auto show_checks = [&](std::int64_t done, std::int64_t total) {
    bar.show(done, total, "checks");
  };
  const auto remove_files = [&] {
    interruptible.remove_leftovers();
    run.checkpoint->remove_temporary();
  };
  try {
    report.result = execute(run,
                            {.locked = [&] { interruptible.hold_locks(); },
                             .progress = show_blocks,
                             .verification = show_checks},
                            processes);
    std::vector<ProcessFigures> figures = gather_figures(run, processes);
    for (const ProcessFigures& each : figures)
      report.peak_memory_bytes = std::max(report.peak_memory_bytes, each.peak_memory_bytes);
    if (run.checkpoint) report.processes = std::move(figures);
    interruptible.check();
  } catch (const SharedError&) {
    throw;
  } catch (const Interrupted&) {
    // The launcher soon kills the process that made the files.
    if (processes.count() > 1) remove_files();
    throw;
  } catch (...) {
    // Other processes still write chunks. Their failures must not be reported.
    if (processes.count() > 1) {
      processes.become_reporter();
      remove_files();
    }
    throw;
  }
}

// Returns the options with the custom grid, if any. Each process reads its file.
Options with_chosen_grid(Options options, const Processes& processes) {
  processes.all_or_throw([&] {
    const std::optional<Grid> grid = chosen_grid(options);
    if (!grid) return;
    require_chosen(*grid);
    options.request.parameters.grid = *grid;
  });
  return options;
}

int perform_run(const Options& options, const Processes& processes) {
  Report report = plan(options, processes);
  on_rank_zero(processes, [&] { present_plan(report); });
  if (options.request.dry_run) return exit_done;
  run_with_progress(processes, report);
  on_rank_zero(processes, [&] { present_result(report); });
  return has_faults(report.result.summary) ? exit_failure : exit_done;
}

// Joins the parts of a run. Returns false if parts are missing, or if another process joins them.
bool join_parts(Options options, const Processes& processes) try {
  options.request.part.reset();
  options.request.join = Join::if_complete;
  // The plan and its warnings were printed for the part.
  if (!options.json) options.quiet = true;
  options.strict = false;
  perform_run(options, processes);
  return true;
} catch (const NotJoined&) {
  return false;
}

// Returns whether all parts of a run are complete. They may be joined and removed meanwhile.
bool are_parts_complete(const PlannedRun& run) try {
  return remaining(run.plan.planes(), run.checkpoint->complete()).empty();
} catch (const Error&) {
  return false;
}

// A part of a run that is complete in the checkpoint.
struct FinishedPart {
  std::string text;  // the report
  bool is_last;      // whether all parts are complete
};

// Computes a part of a run, and unlocks its chunks. Returns nothing if it has faults.
std::optional<FinishedPart> finish_part(Report& report, const Processes& processes) {
  run_with_progress(processes, report);
  for (const std::string& fault : fault_lines(report.result.summary)) print_message("error", fault);
  if (has_faults(report.result.summary)) return std::nullopt;
  Checkpoint& checkpoint = *report.run.checkpoint;
  const bool is_locked = checkpoint.is_locked();
  // The check follows the release: otherwise neither of two parts that end together would join.
  checkpoint.unlock();
  return FinishedPart{report.options.json ? json_text(report) : part_text(report, is_locked),
                      is_locked && are_parts_complete(report.run)};
}

// Computes a part of a run. The last part joins all of them.
int perform_part(const Options& options, const Processes& processes) {
  std::optional<Report> report = plan(options, processes);
  present_plan(*report);
  if (options.request.dry_run) return exit_done;
  const std::optional<FinishedPart> part = finish_part(*report, processes);
  if (!part) return exit_failure;
  report.reset();  // The join reads the atoms again.
  if (part->is_last && join_parts(options, processes)) return exit_done;
  if (options.json || !options.quiet) print(part->text);
  return exit_done;
}

}  // namespace

int perform_surface(const Arguments& arguments, const Processes& processes) {
  end_on_signals();
  const Options given = parse_surface_arguments(arguments);
  refuse_same_files(given, processes);
  if (given.request.parameters.exact && processes.count() > 1)
    throw UsageError(
        "--exact needs all atoms in one process; use eses-blocks measure for exact areas and "
        "volumes");
  on_rank_zero(processes, [&] { check_request(given); });
  const Options options = with_chosen_grid(given, processes);
  return options.request.part ? perform_part(options, processes) : perform_run(options, processes);
}

}  // namespace eses::detail::cli
