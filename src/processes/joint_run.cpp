#include "processes/joint_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "eses/error.hpp"
#include "eses/version.hpp"
#include "io/eses_text.hpp"
#include "io/file_descriptor.hpp"
#include "io/gzip.hpp"
#include "io/output_directory.hpp"
#include "processes/shared_file.hpp"
#include "run/build_patches.hpp"
#include "run/output_files.hpp"
#include "run/parallel.hpp"
#include "run/pipeline.hpp"
#include "run/plan.hpp"
#include "run/resources.hpp"
#include "run/short_file.hpp"
#include "run/verifier.hpp"
#include "solve/stopwatch.hpp"

namespace eses {
namespace {

// A run of a process is cut into so many pieces at most if it may be resumed: what one costs is
// what a cut-off run may lose.
constexpr std::int64_t most_pieces = 64;
// To be raised with every change of what is computed, or of how pieces are kept.
constexpr int piece_format = 1;
constexpr std::size_t copied_at_a_time = std::size_t{1} << 22;  // bytes

// Steele, Lea, Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014: the finalizer.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31);
}

// The same whoever reads which atoms.
std::uint64_t hash_of(const AtomShare& share, const Processes& processes) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < share.atoms.size(); ++i) {
    const auto& [center, radius] = share.atoms[i];
    std::uint64_t hash = mixed(share.first + i + 1);
    for (const double value : {center.x, center.y, center.z, radius})
      hash = mixed(hash ^ std::bit_cast<std::uint64_t>(value));
    sum += hash;
  }
  return processes.sum(sum);
}

std::string identity_of(const JointTask& task, const Plan& plan, std::uint64_t atoms,
                        std::uint64_t hash) {
  const Parameters& p = task.parameters;
  const GridRegion& region = plan.tiling.region;
  return fmt::format(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "points {} {}\ngrid {} edges {} gzip {}\n",
      version, piece_format, sizeof(PieceInfo), task.outputs.gzip ? zlibVersion() : "", atoms, hash,
      p.probe_radius, p.spacing, p.margin, fmt::join(region.begin, " "), fmt::join(region.end, " "),
      task.outputs.grid, task.outputs.edges, task.outputs.gzip);
}

SphereBounds shared_bounds(const AtomShare& share, const Processes& processes) {
  const SphereBounds own = sphere_bounds(share.atoms);
  std::array<double, 3> low{own.low.x, own.low.y, own.low.z};
  std::array<double, 3> high{own.high.x, own.high.y, own.high.z};
  processes.take_least(low);
  processes.take_largest(high);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

BlockTiling slab_tiling(const Plan& plan, std::int64_t block_size, const PlaneRange& planes) {
  GridRegion region = plan.tiling.region;
  region.begin[2] = planes.begin;
  region.end[2] = planes.end;
  return make_tiling(plan.grid, block_size, region);
}

// What this process is to do; nothing where its slab is empty.
Plan plan_slab(const JointTask& task, const JointPlan& joint, const Processes& processes) {
  const Processes::Machine machine = processes.machine(available_threads());
  Plan own = joint.whole;
  own.tiling.region.begin[2] = joint.slab.planes.begin;
  own.tiling.region.end[2] = joint.slab.planes.end;
  if (own.parameters.threads == 0) own.parameters.threads = machine.processors;
  processes.agree([&] {
    if (joint.slab.planes.is_empty()) return;
    plan_work(available_memory() / static_cast<std::uint64_t>(machine.processes),
              joint.slab.molecule, task.outputs, own);
  });
  return own;
}

// Sums and maxima of the processes' plans.
void complete(Plan& whole, const Plan& own, std::uint64_t atoms, const OutputChoice& outputs,
              const Processes& processes) {
  const GridRegion region = whole.tiling.region;
  std::array<std::uint64_t, 5> largest{
      own.memory_bytes, own.box_file_bytes, static_cast<std::uint64_t>(own.tiling.block_size),
      static_cast<std::uint64_t>(own.blocks_ahead), static_cast<std::uint64_t>(own.threads)};
  processes.take_largest(largest);
  whole.memory_bytes = largest[0];
  whole.box_file_bytes = largest[1];
  whole.tiling = make_tiling(whole.grid, static_cast<std::int64_t>(largest[2]), region);
  whole.blocks_ahead = static_cast<std::int64_t>(largest[3]);
  whole.threads = static_cast<int>(largest[4]);
  whole.gzip = outputs.gzip;
  if (outputs.grid) whole.grid_file_bytes = expected_grid_bytes(region, outputs.gzip);
  whole.edge_file_bytes = processes.sum(own.edge_file_bytes);  // of what is still to be done
  if (outputs.areas) whole.area_file_bytes = expected_area_bytes(atoms, outputs.gzip);
  whole.text_scratch_bytes = whole.grid_file_bytes + whole.edge_file_bytes;
}

// The ranges of planes that a process makes pieces of.
std::vector<PlaneRange> pieces_to_do(const JointTask& task, const JointPlan& plan) {
  std::vector<PlaneRange> pieces;
  for (const PlaneRange& range : remaining(plan.slab.planes, plan.done)) {
    std::int64_t planes = range.count();
    if (task.resume) {
      const std::int64_t layer = plan.own.tiling.block_size - 1;
      const std::int64_t layers = (plan.slab.planes.count() + layer - 1) / layer;
      planes = layer * ((layers + most_pieces - 1) / most_pieces);
    }
    for (std::int64_t begin = range.begin; begin < range.end; begin += planes)
      pieces.push_back({begin, std::min(begin + planes, range.end)});
  }
  return pieces;
}

// A process's part in a run, up to what is to be joined.
class SlabRun {
 public:
  SlabRun(const JointTask& task, const JointPlan& plan, const Callbacks& callbacks,
          const Processes& processes)
      : task_(task),
        plan_(plan),
        callbacks_(callbacks),
        share_(processes.share_of(static_cast<std::uint64_t>(task.parameters.verify), 1,
                                  processes.rank())),
        to_do_(pieces_to_do(task, plan)),
        report_(callbacks.progress, count_blocks()) {}

  std::vector<Piece> solve(Summary& summary) {
    std::vector<Piece> pieces;
    if (to_do_.empty()) return pieces;
    const Stopwatch watch;
    const auto check = [this] { report_.check(); };
    Surface surface(plan_.slab.molecule, task_.parameters.probe_radius);
    if (plan_.slab.planes != PlaneRange{0, plan_.whole.grid.size[2]} ||
        plan_.whole.tiling.region != plan_.whole.grid.whole())
      surface.confine_to(slab_box(plan_.whole, plan_.slab.planes));
    build_patches(surface, plan_.own.threads, check);
    release_free_memory();
    require_memory_within(task_.parameters.max_memory);
    summary.seconds.patches = watch.seconds();
    const Stopwatch blocks;
    for (const PlaneRange& planes : to_do_) pieces.push_back(solve(surface, planes, summary));
    summary.seconds.blocks = blocks.seconds();
    return pieces;
  }

  void check() { report_.check(); }

 private:
  std::int64_t count_blocks() const {
    std::int64_t blocks = 0;
    for (const PlaneRange& planes : to_do_)
      blocks += slab_tiling(plan_.whole, plan_.own.tiling.block_size, planes).block_count();
    return blocks;
  }

  // A piece's share of this process's share of what is to be verified.
  std::int64_t checks_of(const PlaneRange& planes) const {
    const auto up_to = [&](std::int64_t plane) {
      std::int64_t done = 0;
      for (const PlaneRange& piece : to_do_)
        done += std::clamp(plane, piece.begin, piece.end) - piece.begin;
      return static_cast<double>(done);
    };
    const auto checks = static_cast<double>(share_.end - share_.begin);
    const double all = up_to(to_do_.back().end);
    return std::llround(checks * up_to(planes.end) / all) -
           std::llround(checks * up_to(planes.begin) / all);
  }

  // False if there are faults: nothing is to be kept then.
  bool verify(Verifier& verifier, Summary& summary) {
    const Stopwatch watch;
    const Verification found = verifier.check([this](std::int64_t done, std::int64_t all) {
      report_.check();
      if (callbacks_.verification) callbacks_.verification(done, all);
    });
    summary.seconds.verify += watch.seconds();
    Verification& sum = *summary.verification;
    sum.points += found.points;
    sum.edges += found.edges;
    sum.faults.insert(sum.faults.end(), found.faults.begin(), found.faults.end());
    return found.faults.empty();
  }

  std::vector<PieceText> chosen_texts() const {
    std::vector<PieceText> texts;
    if (task_.outputs.grid) texts.push_back(PieceText::grid);
    if (task_.outputs.edges) texts.push_back(PieceText::edges);
    return texts;
  }

  Piece new_piece(const PlaneRange& planes) const {
    Piece piece;
    piece.info.planes = planes;
    for (const PieceText text : chosen_texts())
      piece.texts[static_cast<std::size_t>(text)] =
          plan_.store ? plan_.store->create(planes, text)
                      : std::make_unique<ScratchFile>(task_.output_directory);
    return piece;
  }

  Piece solve(const Surface& surface, const PlaneRange& planes, Summary& summary) {
    Piece piece = new_piece(planes);
    Plan plan = plan_.own;
    plan.tiling = slab_tiling(plan_.whole, plan.tiling.block_size, planes);
    std::array<TextChecksum, piece_texts> checksums;
    const auto into = [&](PieceText which) {
      const auto text = static_cast<std::size_t>(which);
      return [&file = *piece.texts[text], &sum = checksums[text], is_kept = plan_.store != nullptr](
                 std::span<const char> bytes, std::uint64_t offset) {
        file.write_at(std::as_bytes(bytes), offset);
        if (is_kept) sum.add(bytes, offset);
      };
    };
    Sinks sinks;
    if (task_.outputs.grid) sinks.grid = into(PieceText::grid);
    if (task_.outputs.edges) sinks.edges = into(PieceText::edges);
    sinks.gzip = task_.outputs.gzip;
    sinks.atom_numbers = plan_.slab.numbers;
    plan.parameters.verify = checks_of(planes);
    std::optional<Verifier> verifier;
    if (plan.parameters.verify > 0)
      sinks.verifier = &verifier.emplace(plan_.slab.molecule.atoms(), plan);
    Pipeline pipeline(surface, plan, std::move(sinks), report_);
    if (planes.begin > plan_.whole.tiling.region.begin[2]) pipeline.solve_plane_below();
    pipeline.run();
    pipeline.add_seconds(summary.seconds);
    const RegionSums sums = pipeline.sums();
    piece.info.totals = {sums.tally, sums.points};
    piece.info.bytes = {pipeline.grid_bytes(), pipeline.edge_bytes()};
    const auto& shares = sums.tally.atom_shares;
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (shares[i] != 0) piece.sums.push_back({shares[i], plan_.slab.numbers[i]});
    const bool is_right = !verifier || verify(*verifier, summary);
    if (!plan_.store || !is_right) return piece;
    for (std::size_t text = 0; text < piece_texts; ++text)
      piece.info.checksums[text] = checksums[text].value();
    plan_.store->finish(std::move(piece));
    return plan_.store->read(planes);
  }

  const JointTask& task_;
  const JointPlan& plan_;
  const Callbacks& callbacks_;
  Processes::Share share_;  // of what is to be verified
  std::vector<PlaneRange> to_do_;
  ProgressReport report_;
};

// Makes the files of what all processes have.
class Join {
 public:
  Join(const JointTask& task, const JointPlan& plan, const JointPaths& paths,
       const Processes& processes, std::function<void()> check)
      : task_(task), plan_(plan), paths_(paths), processes_(processes), check_(std::move(check)) {}

  // Learns of all pieces, of which this process has `own`.
  void take(std::vector<Piece> own) {
    const auto by_planes = [](const PieceInfo& a, const PieceInfo& b) {
      return a.planes.begin < b.planes.begin;
    };
    std::vector<PieceInfo> infos;
    infos.reserve(own.size());
    for (const Piece& piece : own) infos.push_back(piece.info);
    all_ = processes_.gather<PieceInfo>(infos);
    std::sort(all_.begin(), all_.end(), by_planes);
    std::sort(own.begin(), own.end(),
              [&](const Piece& a, const Piece& b) { return by_planes(a.info, b.info); });
    own_ = std::move(own);
    processes_.agree([&] { add_up(); });
  }

  const RegionTotals& totals() const { return totals_; }

  // Returns the bytes of the file.
  std::uint64_t join_texts(OutputFile* file, const char* name, PieceText text) {
    const auto which = static_cast<std::size_t>(text);
    SharedFile shared = open(file, name);
    std::uint64_t offset = 0;
    auto mine = own_.begin();
    for (const PieceInfo& info : all_) {
      if (mine != own_.end() && mine->info.planes == info.planes)
        copy(*mine++, text, shared, offset);
      offset += info.bytes[which];
    }
    if (task_.outputs.gzip && offset == 0) offset += write_empty_member(shared);
    shared.close();
    return offset;
  }

  // Each process adds up, and writes, the areas of as many atoms; `area` becomes their sum in the
  // order of atoms, as that of numbers with a point depends on it. Returns the bytes of the file.
  std::uint64_t join_areas(OutputFile* file, double& area) {
    const std::vector<double> areas = own_areas();
    area = processes_.hand_on(0, [&](double sum) {
      for (const double one : areas) sum += one;
      return sum;
    });
    if (!task_.outputs.areas) return 0;
    SharedFile shared = open(file, areas_name);
    std::uint64_t bytes = 0;
    for_area_texts(areas, [&](std::span<const char> text) { bytes += text.size(); });
    std::uint64_t offset = processes_.sum_before(bytes);
    for_area_texts(areas, [&](std::span<const char> text) {
      shared.write_at(text, offset);
      offset += text.size();
    });
    shared.close();
    return processes_.sum(bytes);
  }

 private:
  void add_up() {
    std::int64_t next = plan_.whole.tiling.region.begin[2];
    for (const PieceInfo& info : all_) {
      if (info.planes.begin != next)
        throw Error("the pieces of the run do not fit together; remove what is there to resume");
      next = info.planes.end;
      totals_.add(info.totals);
    }
    if (next != plan_.whole.tiling.region.end[2]) throw Error("pieces of the run are missing");
  }

  SharedFile open(OutputFile* file, const char* name) const {
    const std::string full_name = text_file_name(name, task_.outputs.gzip);
    return {processes_, file,
            path_in(task_.output_directory, temporary_name(full_name, paths_.process)),
            path_in(task_.output_directory, full_name)};
  }

  void copy(Piece& piece, PieceText text, SharedFile& to, std::uint64_t offset) const {
    const auto which = static_cast<std::size_t>(text);
    const std::uint64_t bytes = piece.info.bytes[which];
    const auto from = piece.texts[which] ? std::move(piece.texts[which])
                                         : plan_.store->open(piece.info.planes, text);
    TextChecksum checksum;
    std::vector<char> buffer;
    for (std::uint64_t done = 0; done < bytes; done += buffer.size()) {
      check_();
      buffer.resize(std::min<std::uint64_t>(copied_at_a_time, bytes - done));
      from->read_at(std::as_writable_bytes(std::span(buffer)), done);
      if (plan_.store) checksum.add(buffer, done);
      to.write_at(buffer, offset + done);
    }
    if (plan_.store && checksum.value() != piece.info.checksums[which])
      throw Error(fmt::format(
          "cannot resume: a text beside {} is damaged; remove that, and the piece is done again",
          plan_.store->sums_path(piece.info.planes)));
  }

  // Without a single member it would be no gzip file.
  std::uint64_t write_empty_member(SharedFile& file) const {
    Gzip gzip;
    const std::span<const char> member = gzip.member({});
    if (processes_.is_first()) file.write_at(member, 0);
    return member.size();
  }

  Processes::Share share_of(int rank) const {
    return processes_.share_of(plan_.atoms, area_lines_at_a_time, rank);
  }

  std::vector<double> own_areas() {
    std::vector<std::vector<AtomSum>> to(static_cast<std::size_t>(processes_.count()));
    for (Piece& piece : own_) {
      std::size_t rank = 0;
      for (const AtomSum& sum : piece.sums) {  // ascending
        while (sum.atom >= share_of(static_cast<int>(rank)).end) ++rank;
        to[rank].push_back(sum);
      }
      std::vector<AtomSum>().swap(piece.sums);
    }
    const Processes::Share share = share_of(processes_.rank());
    std::vector<Tally::Sum> sums(share.end - share.begin);
    for (const AtomSum& sum : processes_.exchange(std::move(to)))
      sums[sum.atom - share.begin] += sum.share;
    std::vector<double> areas;
    areas.reserve(sums.size());
    for (const Tally::Sum sum : sums) areas.push_back(atom_area(sum, task_.parameters.spacing));
    return areas;
  }

  template <class Take>
  void for_area_texts(std::span<const double> areas, Take&& take) const {
    const std::uint64_t first = share_of(processes_.rank()).begin;
    std::optional<Gzip> gzip;
    if (task_.outputs.gzip) gzip.emplace();
    TextBuffer text;
    for (std::size_t at = 0; at < areas.size(); at += area_lines_at_a_time) {
      check_();
      text.clear();
      append_areas(text, first + at,
                   areas.subspan(at, std::min(area_lines_at_a_time, areas.size() - at)));
      take(gzip ? gzip->member(text.text()) : text.text());
    }
  }

  const JointTask& task_;
  const JointPlan& plan_;
  const JointPaths& paths_;
  const Processes& processes_;
  std::function<void()> check_;
  std::vector<PieceInfo> all_;
  std::vector<Piece> own_;
  RegionTotals totals_;
};

// Else MPI would wait for ever when the files are joined.
void require_shared_directory(const JointTask& task, const JointPaths& paths,
                              const Processes& processes) {
  for (const std::string& path : paths.temporaries)
    if (!FileDescriptor(::open(path.c_str(), O_WRONLY | O_CLOEXEC)).is_open())
      throw Error(
          fmt::format("cannot write into {}{}: {}; is it the same directory for all processes?",
                      task.output_directory.string(), processes.place(),
                      std::generic_category().message(errno)));
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
  std::string text;
  if (processes.rank() == from)
    for (const std::string& line : own) text += line + '\0';
  text = processes.broadcast(std::move(text), from);
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size(); begin = text.find('\0', begin) + 1)
    lines.emplace_back(text.c_str() + begin);
  return lines;
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

}  // namespace

JointPlan plan_jointly(const JointTask& task, const Processes& processes) {
  AtomShare share = read_share(task.input, task.format, processes);
  JointPlan plan;
  plan.atoms = share.total;
  const SphereBounds bounds = shared_bounds(share, processes);
  const std::uint64_t hash = hash_of(share, processes);
  std::vector<PlaneRange> done;
  processes.agree([&] {
    plan.whole = plan_grid(bounds, task.parameters);
    if (!task.resume) return;
    plan.store = std::make_unique<PieceStore>(task.output_directory,
                                              identity_of(task, plan.whole, plan.atoms, hash));
    if (!processes.is_first()) return;
    if (!task.dry_run) plan.store->lock();
    done = plan.store->complete();
  });
  plan.done = processes.gather<PlaneRange>(done);
  SharedMolecule shared = share_molecule(share, plan.whole, task.outputs, plan.done, processes);
  share = {};
  plan.slab = std::move(shared.slab);
  plan.odd = std::move(shared.odd);
  plan.own = plan_slab(task, plan, processes);
  complete(plan.whole, plan.own, plan.atoms, task.outputs, processes);
  return plan;
}

JointPaths joint_paths(const JointTask& task, const Processes& processes) {
  const auto share = [&](const std::vector<std::string>& own) {
    return broadcast_lines(own, 0, processes);
  };
  return {share(temporary_paths(task.outputs, task.output_directory)),
          share(lock_paths(task.outputs, task.output_directory)),
          static_cast<long>(
              processes.sum(processes.is_first() ? static_cast<std::uint64_t>(getpid()) : 0))};
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
    require_shared_directory(task, paths, processes);
  });
  const auto file = [&](std::optional<OutputFile> OutputFiles::*which) {
    return files && (*files).*which ? &*((*files).*which) : nullptr;
  };

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
  Join join(task, plan, paths, processes, [&] { slab.check(); });
  join.take(std::move(pieces));
  fill_totals(join.totals(), plan.whole.grid.spacing, summary);
  if (summary.verification && !summary.verification->faults.empty()) {
    finish(total, plan, joint, processes);
    return joint;
  }
  if (task.outputs.grid)
    summary.bytes_written += join.join_texts(file(&OutputFiles::grid), grid_name, PieceText::grid);
  if (task.outputs.edges)
    summary.bytes_written +=
        join.join_texts(file(&OutputFiles::edges), edges_name, PieceText::edges);
  summary.bytes_written += join.join_areas(file(&OutputFiles::areas), summary.area);
  std::uint64_t box_bytes = 0;
  processes.agree([&] {
    if (!files) return;
    if (files->box) box_bytes = write_box(*files->box, plan.whole.grid, files->gzip);
    require_memory_within(task.parameters.max_memory);
    files->commit([&] { slab.check(); });
    if (plan.store) plan.store->remove();
  });
  summary.bytes_written += processes.sum(box_bytes);
  finish(total, plan, joint, processes);
  return joint;
}

}  // namespace eses
