#include "compute/merge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <future>
#include <map>
#include <utility>

#include "compute/mesh_header.hpp"
#include "eses/error.hpp"
#include "io/gzip.hpp"
#include "mesh/local_triangle.hpp"
#include "output/grid_map.hpp"

namespace eses::detail {
namespace {

// Bytes that are read, or copied in the kernel, at a time. After each part the run may be ended.
constexpr std::uint64_t bytes_per_read = std::uint64_t{1} << 22;
constexpr std::uint64_t bytes_per_copy = std::uint64_t{1} << 24;

// Writes a gzip file without text. Without a single member it would not be one.
std::uint64_t write_empty_member(const Processes& processes, SharedFile& file) {
  Gzip gzip;
  const std::span<const char> member = gzip.member({});
  if (processes.is_first()) file.write_at(member, 0);
  return member.size();
}

}  // namespace

Merge::Merge(const RunTask& task, const RunPlan& plan, const Processes& processes,
             std::vector<Piece> pieces, std::function<void()> check)
    : task_(task),
      plan_(plan),
      processes_(processes),
      check_(std::move(check)),
      own_(std::move(pieces)) {
  const auto by_planes = [](const PieceInfo& a, const PieceInfo& b) {
    return a.planes.begin < b.planes.begin;
  };
  std::sort(own_.begin(), own_.end(),
            [&](const Piece& a, const Piece& b) { return by_planes(a.info, b.info); });
  std::vector<PieceInfo> infos;
  infos.reserve(own_.size());
  for (const Piece& piece : own_) infos.push_back(piece.info);
  all_ = processes.gather<PieceInfo>(infos);
  std::sort(all_.begin(), all_.end(), by_planes);
  processes.all_or_throw([this] { add_up(); });
}

void Merge::add_up() {
  std::int64_t next = plan_.whole.tiling.region.begin[2];
  for (const PieceInfo& info : all_) {
    if (info.planes.begin != next)
      throw Error("the checkpoint has gaps or overlaps; remove its directory and run again");
    next = info.planes.end;
    totals_.add(info.totals);
    mesh_.vertices += info.mesh.vertices;
    mesh_.triangles += info.mesh.triangles;
  }
  if (next != plan_.whole.tiling.region.end[2]) throw Error("pieces of the run are missing");
  mesh::require_numbers(mesh_.vertices);
}

// Calls action(piece, sum) for the pieces of this process, with the sum of `amount` over all pieces
// before. Returns the sum over all pieces.
template <class Amount, class Action>
std::uint64_t Merge::for_own(Amount&& amount, Action&& action) {
  std::uint64_t sum = 0;
  auto mine = own_.begin();
  for (const PieceInfo& info : all_) {
    if (mine != own_.end() && mine->info.planes == info.planes) action(*mine++, sum);
    sum += amount(info);
  }
  return sum;
}

ScratchFile& Merge::open(Piece& piece, PieceText text) const {
  auto& file = piece.text(text);
  if (!file) file = plan_.store->open(piece.info.planes, text);
  return *file;
}

// So many files cannot be open at a time. Without a store, scratch files are gone when closed.
void Merge::close(Piece& piece, PieceText text) const { piece.text(text).reset(); }

void Merge::require_sound(const Piece& piece, PieceText text, std::uint32_t checksum) const {
  if (checksum == piece.info.checksums[static_cast<std::size_t>(text)]) return;
  plan_.store->drop(piece.info.planes);
  throw Error(
      fmt::format("cannot resume: what is done of planes {} to {} is damaged; the next run "
                  "with --resume does it again",
                  piece.info.planes.begin, piece.info.planes.end - 1));
}

// Calls take(bytes, offset) for parts of a piece's text from `begin` on, each a multiple of `unit`
// long. Of a piece that an earlier run has left all must be read, as its checksum is compared.
template <class Take>
void Merge::read(Piece& piece, PieceText text, std::uint64_t unit, std::uint64_t begin,
                 Take&& take) const {
  const std::uint64_t bytes = piece.info.bytes_of(text);
  if (begin >= bytes) return;
  const ScratchFile& from = open(piece, text);
  const std::uint64_t step = std::max<std::uint64_t>(1, bytes_per_read / unit) * unit;
  TextChecksum checksum;
  std::vector<char> part, next;
  const auto load = [&](std::uint64_t offset) {
    next.resize(std::min(step, bytes - offset));
    from.read_at(std::as_writable_bytes(std::span(next)), offset);
    if (piece.is_restored) checksum.add(next, offset);
  };
  // Only the main thread may write where there are several processes; another one reads ahead, if
  // it can be started.
  const auto how =
      plan_.own.threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  std::future<void> loaded = std::async(how, load, begin);
  for (std::uint64_t done = begin; done < bytes; done += part.size()) {
    check_();
    loaded.get();
    part.swap(next);
    if (done + part.size() < bytes) loaded = std::async(how, load, done + part.size());
    take(std::span<const char>(part), done);
  }
  if (piece.is_restored) require_sound(piece, text, checksum.value());
  if (plan_.store) close(piece, text);
}

// Returns how many bytes have been copied: fewer than there are where the kernel cannot copy them.
std::uint64_t Merge::copy_in_kernel(Piece& piece, PieceText text, SharedFile& to,
                                    std::uint64_t begin) {
  const std::uint64_t bytes = piece.info.bytes_of(text);
  if (bytes == 0 || piece.is_restored) return 0;
  const int scratch = open(piece, text).descriptor();
  std::uint64_t done = 0;
  while (done < bytes) {
    check_();
    const std::uint64_t copied = to.copy_from(
        scratch,
        {.from = done, .to = begin + done, .bytes = std::min(bytes_per_copy, bytes - done)});
    if (copied == 0) break;
    done += copied;
  }
  return done;
}

void Merge::copy(Piece& piece, PieceText text, SharedFile& to, std::uint64_t begin) {
  const bool is_at_its_place = piece.is_in_place && !piece.text(text);
  if (is_at_its_place) return;
  const std::uint64_t copied = copy_in_kernel(piece, text, to, begin);
  read(piece, text, 1, copied, [&](std::span<const char> bytes, std::uint64_t offset) {
    to.write_at(bytes, begin + offset);
  });
  close(piece, text);
}

// Copies this text of all pieces to their places from `begin` on. Returns where they end.
std::uint64_t Merge::copy_all(PieceText text, SharedFile& to, std::uint64_t begin) {
  const auto bytes_of = [text](const PieceInfo& info) { return info.bytes_of(text); };
  return begin + for_own(bytes_of, [&](Piece& piece, std::uint64_t before) {
           copy(piece, text, to, begin + before);
         });
}

std::uint64_t Merge::write_text(OutputFile* file, PieceText text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = copy_all(text, shared, 0);
  if (task_.outputs.gzip && bytes == 0) bytes = write_empty_member(processes_, shared);
  shared.close();
  return bytes;
}

std::uint64_t Merge::write_map(OutputFile* file, const MapChoice& choice) {
  SharedFile shared(processes_, file);
  const GridRegion& region = plan_.whole.tiling.region;
  GridMap map(map_file(shared), choice, plan_.whole.grid, region);
  const PieceText text = text_of(choice.quantity);
  const auto row_words =
      static_cast<std::uint64_t>(GridMap::words_of_row(choice.quantity, region.size()));
  const std::uint64_t row_bytes = sizeof(std::uint64_t) * row_words;
  GridMap::Scratch scratch;
  std::vector<std::uint64_t> words;
  for (Piece& piece : own_) {
    if (piece.is_in_place) continue;
    const std::int64_t first_row = (piece.info.planes.begin - region.begin[2]) * region.size()[1];
    read(piece, text, row_bytes, 0, [&](std::span<const char> bytes, std::uint64_t offset) {
      words.resize(bytes.size() / sizeof(std::uint64_t));
      std::memcpy(words.data(), bytes.data(), bytes.size());
      map.write_rows(first_row + static_cast<std::int64_t>(offset / row_bytes), words, scratch);
    });
    close(piece, text);
  }
  shared.sync();
  const Processes::Share share =
      processes_.share_of(static_cast<std::uint64_t>(map.piece_count()), 1, processes_.rank());
  // With several processes only the main thread may write.
  map.turn_pieces(static_cast<std::int64_t>(share.begin), static_cast<std::int64_t>(share.end),
                  processes_.count() > 1 ? 1 : plan_.own.threads, check_);
  if (processes_.is_first()) map.write_ends();
  shared.close();
  processes_.all_or_throw([&] {
    if (processes_.is_first()) file->truncate(map.file_bytes());
  });
  return map.file_bytes();
}

std::uint64_t Merge::write_mesh(OutputFile* file, const mesh::MeshText& text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = write_mesh_header(text, plan_.groups, mesh_, processes_, shared);
  bytes = copy_all(PieceText::vertices, shared, bytes);
  bytes = write_triangles(shared, bytes, text);
  shared.close();
  return bytes;
}

// Calls take(text) for parts of the text of a piece's triangles.
template <class Take>
void Merge::for_triangle_texts(Piece& piece, std::uint64_t first_vertex, const mesh::MeshText& text,
                               Take&& take) const {
  TextBuffer buffer;
  read(piece, PieceText::triangles, sizeof(mesh::LocalTriangle), 0,
       [&](std::span<const char> bytes, std::uint64_t) {
         buffer.clear();
         for (; !bytes.empty(); bytes = bytes.subspan(sizeof(mesh::LocalTriangle))) {
           mesh::LocalTriangle local;
           std::memcpy(&local, bytes.data(), sizeof local);
           text.append_triangle(buffer, mesh::numbered_from(first_vertex, local));
         }
         take(buffer.text());
       });
}

// Writes the triangles from `begin` on and returns where they end. The length of their text depends
// on the numbers of their vertices, so that the text is made twice: once to learn its length.
std::uint64_t Merge::write_triangles(SharedFile& file, std::uint64_t begin,
                                     const mesh::MeshText& text) {
  if (!own_.empty() && own_.front().is_in_place) return copy_all(PieceText::triangles, file, begin);
  struct PieceBytes {
    std::int64_t plane;
    std::uint64_t bytes;
  };
  const auto vertices_of = [](const PieceInfo& info) { return info.mesh.vertices; };
  std::vector<PieceBytes> own;
  for_own(vertices_of, [&](Piece& piece, std::uint64_t first_vertex) {
    own.push_back({piece.info.planes.begin, 0});
    for_triangle_texts(piece, first_vertex, text,
                       [&](std::span<const char> part) { own.back().bytes += part.size(); });
  });
  std::map<std::int64_t, std::uint64_t> begins;  // by piece; at first the lengths
  for (const PieceBytes& one : processes_.gather<PieceBytes>(own)) begins[one.plane] = one.bytes;
  std::uint64_t end = begin;
  for (auto& [plane, place] : begins) end += std::exchange(place, end);
  for_own(vertices_of, [&](Piece& piece, std::uint64_t first_vertex) {
    std::uint64_t offset = begins.at(piece.info.planes.begin);
    for_triangle_texts(piece, first_vertex, text, [&](std::span<const char> part) {
      file.write_at(part, offset);
      offset += part.size();
    });
    close(piece, PieceText::triangles);
  });
  return end;
}

}  // namespace eses::detail
