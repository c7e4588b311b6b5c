#include "run/chunks.hpp"

#include <fmt/ranges.h>
#include <zlib.h>

#include <bit>
#include <cstddef>
#include <optional>
#include <utility>
#include <variant>

#include "distributed/processes.hpp"
#include "eses/error.hpp"
#include "eses/version.hpp"
#include "output/mesh_writer.hpp"
#include "output/output_files.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"
#include "system/splitmix64.hpp"

namespace eses::detail {
namespace {

// Version of checkpoints. Must increase with each change of the results or of the format of chunks.
constexpr int checkpoint_format = 7;

// `index` is that of the atom in the molecule.
std::uint64_t hash_of_atom(const Atom& atom, std::uint64_t index) {
  const auto& [center, radius] = atom;
  std::uint64_t hash = splitmix64(index);
  for (const double value : {center.x, center.y, center.z, radius})
    hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(value));
  return hash;
}

std::uint64_t hash_of_atoms(std::span<const Atom> atoms,
                            std::span<const mesh::GroupNumbers> groups) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < atoms.size(); ++i) {
    std::uint64_t hash = hash_of_atom(atoms[i], i);
    if (!groups.empty()) hash = splitmix64(hash ^ std::bit_cast<std::uint64_t>(groups[i]));
    sum += hash;
  }
  return sum;
}

std::uint64_t hash_of_names(const mesh::GroupNames& groups) {
  std::uint64_t sum = 0, residue = 0;
  for (const AtomLabel& label : groups.residues) {
    uLong hash = 0;
    for (const std::string* const text : {&label.chain, &label.residue, &label.residue_number})
      hash = crc32_z(hash, reinterpret_cast<const Bytef*>(text->c_str()), text->size() + 1);
    sum += splitmix64(hash ^ residue++ << 32);
  }
  return sum;
}

std::string mesh_identity(const std::optional<MeshOptions>& mesh,
                          const std::optional<PotentialMap>& map) {
  if (!mesh) return "none";
  std::string identity = formatted("{} {} {}", static_cast<int>(required_mesh_format(*mesh)),
                                   static_cast<int>(mesh->color), mesh->quality);
  if (mesh->component) identity += formatted(" component {}", *mesh->component);
  if (map)
    identity += formatted(" potential {} offset {:a} limit {:a}", map->identity(),
                          mesh->potential->offset, mesh->potential->limit);
  return identity;
}

// Identifies the maps. The permittivities are left out, because chunks contain inside lengths of
// edges, which do not depend on them.
std::string map_identity(const Outputs& outputs) {
  std::string identity;
  for (const MapChoice& map : chosen_maps(outputs))
    identity += formatted("{} ", static_cast<int>(map.quantity));
  if (outputs.ion_access) identity += formatted("{:a}", outputs.ion_access->ion_radius);
  return identity;
}

std::span<const char> bytes_of(const TextBuffer& text) { return text.text(); }

template <class Value>
std::span<const char> bytes_of(const std::vector<Value>& list) {
  return as_chars(std::span(list));
}

// Gives a list this length in bytes. Returns its memory.
std::span<char> resize(TextBuffer& text, std::uint64_t bytes) {
  text.clear();
  char* const begin = text.reserve(bytes);
  text.advance_to(begin + bytes);
  return {begin, bytes};
}

template <class Value>
std::span<char> resize(std::vector<Value>& list, std::uint64_t bytes) {
  list.resize(bytes / sizeof(Value));
  return as_chars(std::span(list));
}

// Calls `visit` for the lists of a piece and their lengths, in the order of the file.
template <class SomePiece, class Head, class Visit>
void for_each_list(SomePiece& piece, Head& head, Visit&& visit) {
  std::size_t next = 0;
  visit(piece.grid.buffer, head.bytes[next++]);
  visit(piece.edges.buffer, head.bytes[next++]);
  for (auto& rows : piece.map_rows) {
    visit(rows.bits, head.bytes[next++]);
    visit(rows.partial_edges, head.bytes[next++]);
  }
  visit(piece.mesh.vertices, head.bytes[next++]);
  visit(piece.mesh.triangles, head.bytes[next++]);
  visit(piece.mesh.triangle_patches, head.bytes[next++]);
  visit(piece.mesh.corners, head.bytes[next++]);
}

std::uint32_t checksum_of(const PieceHead& head) {
  return checksum(as_chars(std::span(&head, 1)).subspan(sizeof head.checksum));
}

std::uint32_t checksum_of_lists(const Piece& piece) {
  std::uint32_t sum = 0;
  for_each_list(piece, piece.head,
                [&](const auto& list, auto&) { sum = checksum(bytes_of(list), sum); });
  return sum;
}

[[noreturn]] void refuse_damaged(const PlaneRange& planes, const PlannedRun& run) {
  run.checkpoint->drop(planes);
  throw Error(
      formatted("cannot resume: the checkpoint of planes {} to {} is damaged; the next run "
                "that is resumed computes them again",
                planes.begin, planes.end - 1));
}

// Returns a hash of all atoms, and of their groups and names, if there are any.
std::uint64_t hash_of(std::span<const Atom> atoms, std::span<const mesh::GroupNumbers> groups,
                      const mesh::GroupNames& names) {
  return hash_of_atoms(atoms, groups) ^ hash_of_names(names);
}

// Returns a text that differs between runs whose chunks must not be combined. `hash` is that of the
// atoms.
std::string chunk_identity(const PlannedRun& run, std::uint64_t hash) {
  const Request& request = run.request;
  const Parameters& p = request.parameters;
  const Grid& grid = run.plan.grid;
  const auto* const options = std::get_if<GridOptions>(&p.grid);
  const GridRegion& region = run.plan.tiling.region;
  return formatted(
      "eses-blocks {} format {} {} {}\natoms {} {:016x}\nprobe {:a} spacing {:a} margin {:a}\n"
      "origin {:a} {:a} {:a} size {}\npoints {} {}\ngrid {} edges {} gzip {} maps {} mesh {}\n"
      "filled {}\n",
      version, checkpoint_format, sizeof(ChunkInfo), request.outputs.gzip ? zlibVersion() : "",
      run.atoms, hash, p.probe_radius, grid.spacing, options != nullptr ? options->margin : 0.0,
      grid.origin.x, grid.origin.y, grid.origin.z, fmt::join(grid.size, " "),
      fmt::join(region.begin, " "), fmt::join(region.end, " "), request.outputs.grid,
      request.outputs.edges, request.outputs.gzip, map_identity(request.outputs),
      mesh_identity(request.outputs.mesh, run.potential),
      p.max_filled_void ? formatted("{:a}", *p.max_filled_void) : "none");
}

// Throws SharedError unless all processes have read the same atoms.
void require_same_atoms(const PlannedRun& run, std::uint64_t hash, const Processes& processes) {
  const std::uint64_t first = processes.gather(std::span<const std::uint64_t>(&hash, 1)).front();
  processes.all_or_throw([&] {
    if (hash != first)
      throw Error(formatted("cannot read {}{}: it is not the file that the first process reads",
                            std::get<InputFile>(run.request.atoms).path.string(),
                            processes.on_machine()));
  });
}

void lock_checkpoint(const PlannedRun& run) {
  if (run.request.part) return run.checkpoint->lock_part(*run.request.part);
  try {
    run.checkpoint->lock();
  } catch (const Error&) {
    if (run.request.join == Join::if_complete) throw NotJoined();
    throw;
  }
}

// Throws an exception if chunks are missing.
void require_complete(const PlannedRun& run, std::span<const PlaneRange> finished) {
  const std::vector<PlaneRange> missing = remaining(region_planes(run.plan), finished);
  if (missing.empty()) return;
  if (run.request.join == Join::if_complete) throw NotJoined();
  std::vector<std::string> ranges;
  for (const auto& [begin, end] : missing) ranges.push_back(formatted("{} to {}", begin, end - 1));
  throw Error(formatted("cannot join: the planes {} of {} are missing in {}; compute their parts",
                        fmt::join(ranges, ", "), run.plan.grid.size[2],
                        path_in(run.request.output_directory, checkpoint_name)));
}

}  // namespace

void open_checkpoint(std::span<const Atom> atoms, const Processes& processes, PlannedRun& run) {
  if (run.is_in_place) return;
  const Request& request = run.request;
  const std::uint64_t hash = hash_of(atoms, run.slab.groups, run.groups);
  require_same_atoms(run, hash, processes);
  std::vector<PlaneRange> finished;
  processes.all_or_throw([&] {
    run.checkpoint = std::make_unique<Checkpoint>(
        request.output_directory, chunk_identity(run, hash),
        request.keeps_chunks() ? Checkpoint::Chunks::kept : Checkpoint::Chunks::temporary);
    if (!processes.is_first()) return;
    if (!request.dry_run) lock_checkpoint(run);
    if (request.keeps_chunks()) finished = run.checkpoint->complete();
    if (request.join != Join::none) require_complete(run, finished);
    // Other parts may be writing their chunks.
    if (!request.dry_run && !request.part) run.checkpoint->remove_others(finished);
  });
  run.finished_planes = processes.gather<PlaneRange>(finished);
}

PieceHead head_of(const Piece& piece) {
  PieceHead head{.lists_checksum = checksum_of_lists(piece),
                 .first_row = piece.first_row,
                 .vertex_count = piece.mesh.vertex_count};
  for_each_list(piece, head,
                [](const auto& list, std::uint64_t& bytes) { bytes = bytes_of(list).size(); });
  head.checksum = checksum_of(head);
  return head;
}

std::uint64_t length_of(const PieceHead& head) {
  std::uint64_t length = sizeof head;
  for (const std::uint64_t bytes : head.bytes) length += bytes;
  return length;
}

void write_piece(const Piece& piece, File& file, std::uint64_t offset) {
  const auto write = [&](std::span<const char> bytes) {
    if (!bytes.empty()) file.write_at(bytes, offset);
    offset += bytes.size();
  };
  write(as_chars(std::span(&piece.head, 1)));
  for_each_list(piece, piece.head, [&](const auto& list, auto&) { write(bytes_of(list)); });
}

bool read_piece(const File& file, std::uint64_t offset, std::uint64_t end, Piece& piece) {
  PieceHead& head = piece.head;
  if (end - offset < sizeof head) return false;
  file.read_at(as_chars(std::span(&head, 1)), offset);
  offset += sizeof head;
  // A damaged head may have any lengths.
  if (head.checksum != checksum_of(head) || length_of(head) - sizeof head > end - offset)
    return false;
  piece.first_row = head.first_row;
  piece.mesh.vertex_count = head.vertex_count;
  for_each_list(piece, head, [&](auto& list, std::uint64_t bytes) {
    if (const std::span<char> memory = resize(list, bytes); !memory.empty())
      file.read_at(memory, offset);
    offset += bytes;
  });
  return head.lists_checksum == checksum_of_lists(piece);
}

ChunkFile::ChunkFile(PlannedRun& run, const PlaneRange& planes)
    : run_(run), file_(run.checkpoint->create(planes)) {
  chunk_.info.planes = planes;
}

void ChunkFile::prepare(Piece& piece) { piece.head = head_of(piece); }

void ChunkFile::place(Piece& piece) {
  piece.offset_in_chunk = chunk_.info.bytes;
  chunk_.info.bytes += length_of(piece.head);
}

void ChunkFile::store(const Piece& piece) { write_piece(piece, file_, piece.offset_in_chunk); }

void ChunkFile::finish(const SweepSums& sums) {
  file_.sync();
  chunk_.info.sums = sums;
  run_.slab.for_each_sum(sums.atom_shares,
                         [&](const AtomSum& sum) { chunk_.atom_sums.push_back(sum); });
  run_.checkpoint->finish(chunk_);
}

Merge::Merge(PlannedRun& run, std::function<void()> check) : run_(run), check_(std::move(check)) {
  std::int64_t next = run_.plan.tiling.region.begin[2];
  sums_.atom_shares.resize(run_.atoms);
  for (const PlaneRange& planes : run_.checkpoint->complete()) {
    PlaneChunk& chunk = chunks_.emplace_back(run_.checkpoint->read(planes));
    const ChunkInfo& info = chunk.info;
    if (info.planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = info.planes.end;
    sums_.add(info.sums);
    for (const AtomSum& sum : std::exchange(chunk.atom_sums, {}))
      sums_.atom_shares.at(as_number(sum.atom)) += sum.share;
  }
  if (next != run_.plan.tiling.region.end[2]) throw Error("chunks of the run are missing");
  mesh::require_vertex_count(sums_.mesh.vertices);
}

void Merge::replay(Sink& sink) {
  const GridRegion& region = run_.plan.tiling.region;
  std::uint64_t first_vertex = 0;
  Piece piece;
  for (const auto& [info, atom_sums] : chunks_) {
    const ScratchFile file = run_.checkpoint->open(info.planes);
    for (std::uint64_t offset = 0; offset < info.bytes; offset += length_of(piece.head)) {
      check_();
      if (!read_piece(file, offset, info.bytes, piece)) refuse_damaged(info.planes, run_);
      // The chunk counts rows and vertices from its own first ones; vertices below it have negative
      // numbers, modulo 2^64.
      piece.first_row += (info.planes.begin - region.begin[2]) * region.size()[1];
      for (mesh::Triangle& triangle : piece.mesh.triangles)
        for (std::uint64_t& vertex : triangle) vertex += first_vertex;
      sink.prepare(piece);
      sink.place(piece);
      sink.store(piece);
    }
    first_vertex += info.sums.mesh.vertices;
  }
}

}  // namespace eses::detail
