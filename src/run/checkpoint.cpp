#include "run/checkpoint.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <new>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "output/identity.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

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

}  // namespace eses::detail
