#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.hpp"
#include "cli/interruption.hpp"
#include "cli/messages.hpp"
#include "cli/run_display.hpp"
#include "cli/surface_command.hpp"
#include "compute/joint_run.hpp"
#include "output/output_files.hpp"

namespace eses::cli {
namespace {

JointTask task_of(const Options& options) {
  return {.input = options.input,
          .format = options.format,
          .parameters = options.parameters,
          .outputs = options.outputs,
          .output_directory = options.output_directory,
          .resume = options.resume,
          .dry_run = options.dry_run};
}

// Of all processes the first prints, and what it throws all of them get to know.
void speak(const Processes& processes, const std::function<void()>& action) {
  std::vector<std::string> errors;
  processes.agree([&] {
    if (!processes.is_first()) return;
    try {
      action();
    } catch (const StrictError& error) {
      errors = error.lines;
    }
  });
  if (processes.sum(errors.size()) > 0) throw StrictError{errors};
}

Report report_of(const Options& options, const JointPlan& plan, const Processes& processes) {
  Report report;
  report.options = options;
  report.atoms = plan.atoms;
  report.findings = describe(
      plan.odd.oddities, [&](AtomIndex atom) { return plan.odd.lines.at(atom); }, options.input);
  report.plan = plan.whole;
  report.processes.resize(static_cast<std::size_t>(processes.count()));
  return report;
}

JointSummary run_with_progress(const JointTask& task, const JointPlan& plan, bool is_quiet,
                               const Processes& processes) {
  const JointPaths paths = joint_paths(task, processes);
  InterruptibleRun interruptible(paths.temporaries, paths.locks);
  RunDisplay display(interruptible, !is_quiet && processes.is_first());
  try {
    JointSummary joint = run_jointly(task, plan, paths, display.callbacks(), processes);
    interruptible.check();
    return joint;
  } catch (const SharedError&) {
    throw;
  } catch (...) {
    // The one that has made them may be ended before it can remove them.
    if (processes.count() > 1) interruptible.remove_leftovers();
    throw;
  }
}

}  // namespace

int compute_jointly(const Options& options, const Processes& processes) {
  const JointTask task = task_of(options);
  speak(processes, [&] {
    require_standard_output();
    refuse_to_lose_input(options);
    refuse_residues_of_xyzr(options);
    require_places(options.outputs, options.output_directory);
  });
  const JointPlan plan = plan_jointly(task, processes);
  Report report = report_of(options, plan, processes);
  speak(processes, [&] {
    report.disk = require_disk_space(report.plan, options.outputs, options.output_directory);
    if (options.dry_run) print(options.json ? json_text(report) : plan_text(report));
    if (options.dry_run || options.strict) warn(report);
    if (options.dry_run) return;
    announce(report);
    if (!options.strict) warn(report);
  });
  if (options.dry_run) return exit_done;
  JointSummary joint = run_with_progress(task, plan, options.quiet, processes);
  report.summary = std::move(joint.summary);
  report.processes = std::move(joint.processes);
  for (const ProcessFigures& figures : report.processes)
    report.peak_memory_bytes = std::max(report.peak_memory_bytes, figures.peak_memory_bytes);
  speak(processes, [&] {
    print(final_text(report));
    warn_if_empty(report);
    for (const std::string& fault : fault_lines(report.summary)) complain("error", fault);
  });
  return exit_code(report.summary);
}

}  // namespace eses::cli
