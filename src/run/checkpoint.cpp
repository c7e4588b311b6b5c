#include "run/checkpoint.hpp"

#include <fmt/ranges.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "eses/error.hpp"
#include "eses/version.hpp"
#include "output/identity.hpp"
#include "output/mesh_format.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

constexpr char pieces_suffix[] = ".pieces";
constexpr char sums_suffix[] = ".sums";  // of the file that marks a chunk as complete

std::string name_of(const PlaneRange& planes, std::string_view suffix) {
  return formatted("{}-{}{}", planes.begin, planes.end, suffix);
}

std::optional<PlaneRange> planes_of(const std::string& name) {
  PlaneRange planes;
  int length = 0;
  long long begin = 0, end = 0;
  if (std::sscanf(name.c_str(), "%lld-%lld%n", &begin, &end, &length) != 2) return std::nullopt;
  planes = {begin, end};
  if (name != name_of(planes, sums_suffix) || planes.is_empty()) return std::nullopt;
  return planes;
}

// Removes the directory of a checkpoint with all its files: first the files that mark chunks as
// complete, and the file that identifies the run last. If the removal is interrupted, the remaining
// chunks can still be recognized as incomplete.
void remove_directory(const std::filesystem::path& directory) noexcept try {
  std::error_code error;  // Errors are ignored: files that are left do no harm.
  std::vector<std::filesystem::path> sums, others;
  for (const auto& entry : std::filesystem::directory_iterator(directory, error))
    (entry.path().extension() == sums_suffix ? sums : others).push_back(entry.path());
  for (const auto* const paths : {&sums, &others})
    for (const auto& path : *paths)
      if (path.filename() != run_name) std::filesystem::remove(path, error);
  std::filesystem::remove_all(directory, error);
} catch (const std::bad_alloc&) {  // The files are left, which does no harm.
}

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Returns the content of the file that identifies a run. The checksum tells a damaged file from one
// of another run.
std::string with_checksum(std::string_view identity) {
  return formatted("checksum {:08x}\n{}", checksum(identity), identity);
}

// Returns whether the content of the file that identifies a run is damaged.
bool is_damaged(std::string_view text) {
  const std::size_t line_end = text.find('\n');
  return line_end == std::string_view::npos || text != with_checksum(text.substr(line_end + 1));
}

// The header of the file of the sums: the data of a chunk, and those of its list of atoms.
struct SumsHeader {
  PlaneRange planes;
  std::uint64_t bytes = 0;
  std::uint64_t atom_count = 0;
  RegionTotals totals;
  std::uint64_t checksum = 0;  // of the list
  std::uint64_t padding = 0;   // explicit, as the struct is written to disk
};
static_assert(sizeof(SumsHeader) == 192);
static_assert(sizeof(AtomSum) == 32);

std::uint64_t size_of(const std::filesystem::path& path) {
  std::error_code error;
  const std::uint64_t size = std::filesystem::file_size(path, error);
  return error ? 0 : size;
}

// Returns the bytes of a value as they are in memory.
template <class Value>
auto bytes_of(Value& value) {
  return as_chars(std::span(&value, 1));
}

}  // namespace

void remove_checkpoint(const std::filesystem::path& output_directory) noexcept try {
  const std::string path = path_in(output_directory, checkpoint_name);
  std::error_code error;
  if (std::filesystem::is_directory(std::filesystem::symlink_status(path, error)))
    remove_directory(path);
} catch (const std::bad_alloc&) {
}

Checkpoint::Checkpoint(const std::filesystem::path& output_directory, std::string identity,
                       Chunks chunks)
    : path_(path_in(output_directory, checkpoint_name)),
      identity_(std::move(identity)),
      chunks_(chunks) {}

Checkpoint::~Checkpoint() {
  if (lock_) remove_temporary();
  unlock();
}

void Checkpoint::unlock() {
  if (!lock_) return;
  std::error_code error;  // a directory with chunks cannot be removed
  if (part_lock_) {
    part_lock_.reset();
    lock_.reset();
    if (std::filesystem::exists(path_ / run_name, error)) return;
    try {
      lock();                 // removes the file of the shared lock afterwards
    } catch (const Error&) {  // Other parts use the directory.
      return;
    }
  }
  lock_.reset();
  std::filesystem::remove(path_, error);
}

void Checkpoint::lock() { lock_.emplace(path_); }

void Checkpoint::lock_part(const Share& part) {
  lock_.emplace(path_, "", OutputDirectory::Access::shared);
  part_lock_.emplace(path_, formatted("part-{}-of-{}", part.index + 1, part.count));
  if (std::error_code error; std::filesystem::exists(path_ / run_name, error)) require_same_run();
}

std::vector<PlaneRange> Checkpoint::complete() const {
  std::error_code error;
  std::vector<PlaneRange> chunks;
  for (const auto& entry : std::filesystem::directory_iterator(path_, error))
    if (const auto planes = planes_of(entry.path().filename().string())) chunks.push_back(*planes);
  // Without complete chunks, the identity does not matter.
  if (chunks.empty()) return {};
  require_same_run();
  std::erase_if(chunks, [this](const PlaneRange& planes) { return !is_complete(planes); });
  std::sort(chunks.begin(), chunks.end(),
            [](const PlaneRange& a, const PlaneRange& b) { return a.begin < b.begin; });
  const auto overlapping =
      std::adjacent_find(chunks.begin(), chunks.end(),
                         [](const PlaneRange& a, const PlaneRange& b) { return b.begin < a.end; });
  if (overlapping != chunks.end())
    throw Error(
        formatted("cannot resume: chunks in {} overlap; remove it to start again", path_.string()));
  return chunks;
}

void Checkpoint::require_same_run() const {
  std::error_code error;
  if (!std::filesystem::exists(path_ / run_name, error))
    throw Error(
        formatted("cannot resume: {} does not identify its run; remove it", path_.string()));
  const std::string run = read_all(path_ / run_name);
  if (is_damaged(run))
    throw Error(formatted("cannot resume: {} is damaged; remove {} to start again",
                          (path_ / run_name).string(), path_.string()));
  if (run != with_checksum(identity_))
    throw Error(
        formatted("cannot resume: {} belongs to a run that differs in {}; remove it to start again",
                  path_.string(), differing_names(identity_, run.substr(run.find('\n') + 1))));
}

bool Checkpoint::is_complete(const PlaneRange& planes) const try {
  return read(planes).bytes == size_of(path_ / name_of(planes, pieces_suffix));
} catch (const Error&) {
  return false;
}

void Checkpoint::remove_others(std::span<const PlaneRange> complete) {
  std::set<std::string> kept;
  for (const PlaneRange& planes : complete) {
    kept.insert(name_of(planes, sums_suffix));
    kept.insert(name_of(planes, pieces_suffix));
  }
  std::error_code error;  // files that cannot be removed are harmless
  std::vector<std::filesystem::path> others;
  for (const auto& entry : std::filesystem::directory_iterator(path_, error)) {
    const std::string name = entry.path().filename().string();
    const bool is_of_chunk = name.front() >= '0' && name.front() <= '9';
    if (is_of_chunk && !kept.contains(name)) others.push_back(entry.path());
  }
  for (const auto& path : others) std::filesystem::remove(path, error);
}

void Checkpoint::drop(const PlaneRange& planes) {
  std::error_code error;  // if the file remains, reading it detects the damage
  std::filesystem::remove(sums_path(planes), error);
}

void Checkpoint::prepare() {
  const std::string run = with_checksum(identity_);
  if (read_all(path_ / run_name) == run) return;
  write_complete(run_name, {std::span<const char>(run)});
}

// Writes a file that gets its name when it is on disk, so that it is complete if it exists.
void Checkpoint::write_complete(const std::string& name,
                                std::initializer_list<std::span<const char>> parts) {
  const std::string temporary = temporary_name(name);
  {
    ScratchFile file(path_, temporary, ScratchFile::Kept::fresh);
    for (const auto bytes : parts) file.append(bytes);
    file.sync();
  }
  std::error_code error;
  std::filesystem::rename(path_ / temporary, path_ / name, error);
  if (error)
    throw Error(formatted("cannot write {}: {}", (path_ / name).string(), error.message()));
}

// Existing sums belong to old pieces and are removed first.
ScratchFile Checkpoint::create(const PlaneRange& planes) {
  drop(planes);
  return {path_, name_of(planes, pieces_suffix), ScratchFile::Kept::fresh};
}

ScratchFile Checkpoint::open(const PlaneRange& planes) const {
  return {path_, name_of(planes, pieces_suffix), ScratchFile::Kept::existing};
}

std::string Checkpoint::sums_path(const PlaneRange& planes) const {
  return path_in(path_, name_of(planes, sums_suffix));
}

// The file of the sums is written last, so that its existence implies that the chunk is complete.
void Checkpoint::finish(const PlaneChunk& chunk) {
  const auto sums = as_chars(std::span(chunk.atom_sums));
  const SumsHeader header{chunk.planes, chunk.bytes, chunk.atom_sums.size(), chunk.totals,
                          checksum(sums)};
  const std::uint64_t header_checksum = checksum(bytes_of(header));
  write_complete(name_of(chunk.planes, sums_suffix),
                 {bytes_of(header_checksum), bytes_of(header), sums});
}

PlaneChunk Checkpoint::read(const PlaneRange& planes) const {
  const ScratchFile file(path_, name_of(planes, sums_suffix), ScratchFile::Kept::existing);
  std::uint64_t header_checksum = 0;
  SumsHeader header;
  constexpr std::uint64_t begin = sizeof header_checksum + sizeof header;
  PlaneChunk chunk;
  const std::uint64_t bytes = size_of(sums_path(planes));
  bool is_sound = bytes >= begin && (bytes - begin) % sizeof(AtomSum) == 0;
  if (is_sound) {
    file.read_at(bytes_of(header_checksum), 0);
    file.read_at(bytes_of(header), sizeof header_checksum);
    is_sound = header_checksum == checksum(bytes_of(header)) && header.planes == planes &&
               header.atom_count == (bytes - begin) / sizeof(AtomSum);
  }
  if (is_sound) {
    chunk = {header.planes, header.bytes, header.totals, std::vector<AtomSum>(header.atom_count)};
    file.read_at(as_chars(std::span(chunk.atom_sums)), begin);
    is_sound = header.checksum == checksum(as_chars(std::span(chunk.atom_sums)));
  }
  if (!is_sound)
    throw Error(formatted("cannot resume: {} is damaged; remove it to compute its planes again",
                          sums_path(planes)));
  return chunk;
}

void Checkpoint::remove() {
  remove_directory(path_);
  lock_.reset();
}

void Checkpoint::remove_temporary() noexcept {
  if (chunks_ == Chunks::temporary) remove_directory(path_);
}

namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 9;

std::uint64_t hash_of_atoms(std::span<const Atom> atoms, std::span<const GroupNumbers> groups) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    const auto& [center, radius] = atoms[i];
    std::uint64_t hash = splitmix64(i);
    for (const double value : {center.x, center.y, center.z, radius})
      hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
    if (!groups.empty()) hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(groups[i]));
    sum += hash;
  }
  return sum;
}

std::uint64_t hash_of_names(const GroupNames& groups) {
  std::uint64_t sum = 0, residue = 0;
  for (const AtomLabel& label : groups.residues) {
    uLong hash = 0;
    for (const std::string* const text : {&label.chain, &label.residue, &label.residue_number})
      hash = crc32_z(hash, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    sum += splitmix64(hash ^ residue++ << 32);
  }
  return sum;
}

// Lengths and volumes are written in hexadecimal, which is exact.
std::string exact_text(double value) { return formatted("{:a}", value); }

// The permittivities of maps are left out, because chunks contain inside lengths of edges, which do
// not depend on them.
void add_outputs(const Outputs& outputs, const std::optional<PotentialMap>& potential,
                 std::string& identity) {
  add_property(identity, "--write", formatted("{} {}", outputs.grid, outputs.edges));
  add_property(identity, "--gzip", outputs.gzip ? zlibVersion() : "none");
  add_property(identity, "--inside", !outputs.inside_map.empty());
  add_property(identity, "--dielectric", outputs.dielectric.has_value());
  add_property(identity, "--kappa", outputs.ion_access.has_value());
  add_property(identity, "--ion-radius",
               exact_text(outputs.ion_access.value_or(IonAccessMap()).ion_radius));
  const MeshOptions mesh = outputs.mesh.value_or(MeshOptions());
  const MeshPotential colors = mesh.potential.value_or(MeshPotential());
  add_property(identity, "--mesh", outputs.mesh ? static_cast<int>(*mesh_format(mesh.file)) : -1);
  add_property(identity, "--ply-ascii", mesh.is_ascii);
  add_property(identity, "--color", static_cast<int>(mesh.color));
  add_property(identity, "--mesh-quality", mesh.quality);
  add_property(identity, "--component",
               mesh.component ? static_cast<std::int64_t>(*mesh.component) : -1);
  add_property(identity, "--potential", potential ? potential->identity() : "none");
  add_property(identity, "--potential-offset", exact_text(colors.offset));
  add_property(identity, "--potential-limit", exact_text(colors.limit));
}

// Returns a text that differs between runs whose chunks must not be combined. `hash` is that of the
// atoms.
std::string chunk_identity(const InputInfo& input, std::uint64_t hash, const Request& request,
                           const Plan& plan) {
  const Parameters& p = request.parameters;
  const Grid& grid = plan.grid;
  const auto* const options = std::get_if<GridOptions>(&p.grid);
  const GridRegion& region = plan.region;
  std::string identity;
  add_property(identity, "the version",
               formatted("eses-blocks {} format {}", version, checkpoint_format));
  add_property(identity, "the input", formatted("{} {:016x}", input.atom_count, hash));
  add_property(identity, "--surface", static_cast<int>(p.surface()));
  add_property(identity, "--probe-radius", exact_text(p.probe_radius));
  add_property(identity, "--spacing", exact_text(grid.spacing));
  add_property(identity, "--margin", exact_text(options != nullptr ? options->margin : 0));
  add_property(identity, "the grid",
               formatted("{:a} {:a} {:a} {}", grid.origin.x, grid.origin.y, grid.origin.z,
                         fmt::join(grid.size, " ")));
  add_property(identity, "the part of the grid",
               region == grid.whole()
                   ? "all"
                   : formatted("{} {}", fmt::join(region.begin, " "), fmt::join(region.end, " ")));
  add_property(identity, "--fill-cavities",
               p.max_filled_void ? exact_text(*p.max_filled_void) : "none");
  add_outputs(request.outputs, input.potential, identity);
  return identity;
}

// Throws SharedError unless all processes have read the same atoms.
void require_same_atoms(const Request& request, std::uint64_t hash, const Processes& processes) {
  const std::uint64_t first = processes.gather(std::span<const std::uint64_t>(&hash, 1)).front();
  processes.all_or_throw([&] {
    if (hash != first)
      throw Error(formatted("cannot read {}{}: it is not the file that the first process reads",
                            std::get<InputFile>(request.atoms).path.string(),
                            processes.on_machine()));
  });
}

void lock_for(const Request& request, Checkpoint& checkpoint) {
  if (request.part) return checkpoint.lock_part(*request.part);
  try {
    checkpoint.lock();
  } catch (const Error&) {
    if (request.join == Join::if_complete) throw NotJoined();
    throw;
  }
}

// Throws an exception if chunks are missing.
void require_complete(const Request& request, const Plan& plan,
                      std::span<const PlaneRange> finished) {
  const std::vector<PlaneRange> missing = remaining(plan.planes(), finished);
  if (missing.empty()) return;
  if (request.join == Join::if_complete) throw NotJoined();
  std::vector<std::string> ranges;
  for (const auto& [begin, end] : missing) ranges.push_back(formatted("{} to {}", begin, end - 1));
  throw Error(formatted("cannot join: the planes {} of {} are missing in {}; compute their parts",
                        fmt::join(ranges, ", "), plan.grid.size[2],
                        path_in(request.output_directory, checkpoint_name)));
}

}  // namespace

OpenCheckpoint open_checkpoint(const InputAtoms& input, const Request& request, const Plan& plan,
                               const Processes& processes) {
  OpenCheckpoint opened;
  if (processes.count() == 1 && !request.keeps_chunks()) return opened;
  const std::uint64_t hash =
      hash_of_atoms(input.atoms(), input.groups) ^ hash_of_names(input.info.groups);
  require_same_atoms(request, hash, processes);
  opened.checkpoint = processes.all_or_throw([&] {
    auto checkpoint = std::make_unique<Checkpoint>(
        request.output_directory, chunk_identity(input.info, hash, request, plan),
        request.keeps_chunks() ? Checkpoint::Chunks::kept : Checkpoint::Chunks::temporary);
    if (!processes.is_first()) return checkpoint;
    if (!request.dry_run) lock_for(request, *checkpoint);
    if (request.keeps_chunks()) opened.finished = checkpoint->complete();
    if (request.join != Join::none) require_complete(request, plan, opened.finished);
    // Other parts may be writing their chunks.
    if (!request.dry_run && !request.part) checkpoint->remove_others(opened.finished);
    return checkpoint;
  });
  opened.finished = processes.gather<PlaneRange>(opened.finished);
  return opened;
}

}  // namespace eses::detail
