#include "compute/joint_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <array>
#include <cerrno>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "compute/join.hpp"
#include "compute/slab_run.hpp"
#include "distributed/packed_texts.hpp"
#include "eses/error.hpp"
#include "io/file_descriptor.hpp"
#include "output/output_files.hpp"
#include "output/short_file.hpp"
#include "system/parallel.hpp"
#include "system/resources.hpp"
#include "system/stopwatch.hpp"

namespace eses {
namespace {

// Else MPI would wait for ever when the files are joined.
void require_shared_directories(const JointTask& task, const JointPaths& paths,
                                const Processes& processes) {
  const auto require = [&](const std::filesystem::path& path, int mode) {
    if (!FileDescriptor(::open(path.c_str(), mode | O_CLOEXEC)).is_open())
      throw Error(fmt::format(
          "cannot write into {}{}: {}; is it the same directory for all processes?",
          path.parent_path().string(), processes.place(), std::generic_category().message(errno)));
  };
  for (const std::string& path : paths.temporaries) require(path, O_WRONLY);
  if (task.resume) require(path_in(task.output_directory, resume_name), O_RDONLY | O_DIRECTORY);
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Those of process `from`, known to all.
std::vector<std::string> broadcast_lines(const std::vector<std::string>& own, int from,
                                         const Processes& processes) {
  std::string packed;
  if (processes.rank() == from)
    for (const std::string& line : own) pack(packed, line);
  return unpack(processes.broadcast(std::move(packed), from));
}

// Wall clocks are those of the slowest process, times of threads are added up.
void share_seconds(PhaseSeconds& seconds, const Processes& processes) {
  std::array largest{seconds.patches, seconds.blocks, seconds.verify, seconds.total};
  processes.take_largest(largest);
  seconds.patches = largest[0];
  seconds.blocks = largest[1];
  seconds.verify = largest[2];
  seconds.total = largest[3];
  std::array sums{seconds.classify, seconds.intersect, seconds.output};
  processes.add(std::span<double>(sums));
  seconds.classify = sums[0];
  seconds.intersect = sums[1];
  seconds.output = sums[2];
}

// What all have found, in the order of their slabs.
void share_verification(Verification& found, const Processes& processes) {
  found.points = static_cast<std::int64_t>(processes.sum(static_cast<std::uint64_t>(found.points)));
  found.edges = static_cast<std::int64_t>(processes.sum(static_cast<std::uint64_t>(found.edges)));
  if (processes.sum(found.faults.size()) == 0) return;
  std::vector<std::string> all;
  for (int rank = 0; rank < processes.count(); ++rank) {
    const std::vector<std::string> lines = broadcast_lines(found.faults, rank, processes);
    all.insert(all.end(), lines.begin(), lines.end());
  }
  found.faults = std::move(all);
}

void finish(const Stopwatch& total, const JointPlan& plan, JointSummary& joint,
            const Processes& processes) {
  PhaseSeconds& seconds = joint.summary.seconds;
  seconds.total = total.seconds();
  share_seconds(seconds, processes);
  const ProcessFigures own{plan.slab.planes, plan.slab.numbers.size(), cpu_seconds(),
                           peak_memory()};
  joint.processes = processes.gather<ProcessFigures>({&own, 1});
}

// Of `files`, which the first process has and the others give as null. Returns their bytes.
std::uint64_t join_files(const OutputChoice& outputs, const SlabRun& slab, Join& join,
                         OutputFiles* files, Summary& summary) {
  const auto file = [&](std::optional<OutputFile> OutputFiles::*which) {
    return files != nullptr && files->*which ? &*(files->*which) : nullptr;
  };
  std::uint64_t bytes = 0;
  if (outputs.grid) bytes += join.join_texts(file(&OutputFiles::grid), PieceText::grid);
  if (outputs.edges) bytes += join.join_texts(file(&OutputFiles::edges), PieceText::edges);
  if (!outputs.inside_map.empty()) bytes += join.join_map(file(&OutputFiles::inside_map));
  if (outputs.mesh) {
    bytes += join.join_mesh(file(&OutputFiles::mesh), slab.mesh_text());
    summary.mesh = join.mesh_counts();
  }
  bytes += join.join_areas(file(&OutputFiles::areas), summary.area);
  if (outputs.residues)
    bytes += join.join_tables(file(&OutputFiles::residues), file(&OutputFiles::chains));
  return bytes;
}

// With the bounding box, whose bytes it returns.
std::uint64_t commit_files(const JointTask& task, const JointPlan& plan, SlabRun& slab,
                           OutputFiles* files, const Processes& processes) {
  std::uint64_t box_bytes = 0;
  processes.agree([&] {
    if (files == nullptr) return;
    if (files->box) box_bytes = write_box(*files->box, plan.whole.grid, files->gzip);
    require_memory_within(task.parameters.max_memory);
    files->commit([&] { slab.check(); });
    if (plan.store) {
      plan.store->remove();
    } else {
      files->remove_resumable();
    }
  });
  return processes.sum(box_bytes);
}

}  // namespace

JointPaths joint_paths(const JointTask& task, const Processes& processes) {
  const auto share = [&](const std::vector<std::string>& own) {
    return broadcast_lines(own, 0, processes);
  };
  return {share(temporary_paths(task.outputs, task.output_directory)),
          share(lock_paths(task.outputs, task.output_directory))};
}

JointSummary run_jointly(const JointTask& task, const JointPlan& plan, const JointPaths& paths,
                         const Callbacks& callbacks, const Processes& processes) {
  const Stopwatch total;
  std::optional<OutputFiles> files;
  processes.agree([&] {
    if (!processes.is_first()) return;
    files.emplace(task.outputs, task.output_directory, plan.whole);
    if (plan.store) plan.store->prepare();
  });
  processes.agree([&] {
    start_threads(plan.own.threads);
    require_shared_directories(task, paths, processes);
  });
  JointSummary joint;
  Summary& summary = joint.summary;
  if (task.parameters.verify > 0) summary.verification.emplace();
  SlabRun slab(task, plan, callbacks, processes);
  std::vector<Piece> pieces = slab.solve(summary);
  if (summary.verification) share_verification(*summary.verification, processes);
  // What was there before, in turn.
  const auto rank = static_cast<std::size_t>(processes.rank());
  for (std::size_t i = rank; i < plan.done.size(); i += static_cast<std::size_t>(processes.count()))
    pieces.push_back(plan.store->read(plan.done[i]));
  Join join(task, plan, processes, [&] { slab.check(); });
  join.take(std::move(pieces));
  fill_totals(join.totals(), plan.whole.grid.spacing, summary);
  if (summary.verification && !summary.verification->faults.empty()) {
    finish(total, plan, joint, processes);
    return joint;
  }
  OutputFiles* const own_files = files ? &*files : nullptr;
  summary.bytes_written = join_files(task.outputs, slab, join, own_files, summary);
  summary.bytes_written += commit_files(task, plan, slab, own_files, processes);
  finish(total, plan, joint, processes);
  return joint;
}

}  // namespace eses
