#include "compute/join.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <future>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "distributed/residue_tables.hpp"
#include "eses/error.hpp"
#include "io/eses_writer.hpp"
#include "io/gzip.hpp"
#include "mesh/local_triangle.hpp"
#include "output/inside_map.hpp"
#include "output/short_file.hpp"

namespace eses {
namespace {

constexpr std::size_t copied_at_a_time = std::size_t{1} << 22;  // bytes

}  // namespace

Join::Join(const JointTask& task, const JointPlan& plan, const Processes& processes,
           std::function<void()> check)
    : task_(task), plan_(plan), processes_(processes), check_(std::move(check)) {}

void Join::take(std::vector<Piece> own) {
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

// Calls take(bytes, offset) for parts of a piece's text, each a multiple of `unit` long.
template <class Take>
void Join::read(Piece& piece, PieceText text, std::uint64_t unit, Take&& take) const {
  if (piece.info.bytes_of(text) == 0) return;
  auto& from = piece.texts[static_cast<std::size_t>(text)];
  if (!from) from = plan_.store->open(piece.info.planes, text);
  const std::uint64_t bytes = piece.info.bytes_of(text);
  const std::uint64_t step = std::max<std::uint64_t>(1, copied_at_a_time / unit) * unit;
  TextChecksum checksum;
  std::vector<char> part, next;
  const auto load = [&](std::uint64_t offset) {
    next.resize(std::min(step, bytes - offset));
    from->read_at(std::as_writable_bytes(std::span(next)), offset);
    if (plan_.store) checksum.add(next, offset);
  };
  // Only the main thread may write where there are several processes; another one reads ahead, if
  // it can be started.
  const auto how =
      plan_.own.threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  std::future<void> loaded = std::async(how, load, std::uint64_t{0});
  for (std::uint64_t done = 0; done < bytes; done += part.size()) {
    check_();
    loaded.get();
    part.swap(next);
    if (done + part.size() < bytes) loaded = std::async(how, load, done + part.size());
    take(std::span<const char>(part), done);
  }
  if (plan_.store) from.reset();  // so many files at a time cannot be open
  if (!plan_.store || checksum.value() == piece.info.checksums[static_cast<std::size_t>(text)])
    return;
  plan_.store->drop(piece.info.planes);
  throw Error(
      fmt::format("cannot resume: what is done of planes {} to {} is damaged; the next run "
                  "with --resume does it again",
                  piece.info.planes.begin, piece.info.planes.end - 1));
}

// Calls action(piece, sum) for this process's pieces with the sum of `amount` over all pieces
// before it. Returns the sum over all.
template <class Amount, class Action>
std::uint64_t Join::for_own(Amount&& amount, Action&& action) {
  std::uint64_t sum = 0;
  auto mine = own_.begin();
  for (const PieceInfo& info : all_) {
    if (mine != own_.end() && mine->info.planes == info.planes) action(*mine++, sum);
    sum += amount(info);
  }
  return sum;
}

// Returns where the last one ends.
std::uint64_t Join::copy(PieceText text, SharedFile& to, std::uint64_t begin) {
  const auto bytes_of = [text](const PieceInfo& info) { return info.bytes_of(text); };
  return begin + for_own(bytes_of, [&](Piece& piece, std::uint64_t before) {
           read(piece, text, 1, [&](std::span<const char> bytes, std::uint64_t done) {
             to.write_at(bytes, begin + before + done);
           });
           piece.texts[static_cast<std::size_t>(text)].reset();
         });
}

std::uint64_t Join::join_texts(OutputFile* file, PieceText text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = copy(text, shared, 0);
  if (task_.outputs.gzip && bytes == 0) bytes = write_empty_member(shared);
  shared.close();
  return bytes;
}

std::uint64_t Join::join_map(OutputFile* file) {
  SharedFile shared(processes_, file);
  const GridRegion& region = plan_.whole.tiling.region;
  InsideMap map(map_file(shared), required_map_format(task_.outputs.inside_map), plan_.whole.grid,
                region);
  const auto row_words = static_cast<std::uint64_t>(InsideMap::words_of_row(region.size()));
  const std::uint64_t row_bytes = sizeof(std::uint64_t) * row_words;
  InsideMap::Scratch scratch;
  std::vector<std::uint64_t> words;
  for (Piece& piece : own_) {
    const std::int64_t first_row = (piece.info.planes.begin - region.begin[2]) * region.size()[1];
    read(piece, PieceText::map, row_bytes, [&](std::span<const char> bytes, std::uint64_t done) {
      words.resize(bytes.size() / sizeof(std::uint64_t));
      std::memcpy(words.data(), bytes.data(), bytes.size());
      map.write_rows(first_row + static_cast<std::int64_t>(done / row_bytes), words, scratch);
    });
    piece.texts[static_cast<std::size_t>(PieceText::map)].reset();
  }
  shared.sync();
  const Processes::Share share =
      processes_.share_of(static_cast<std::uint64_t>(map.piece_count()), 1, processes_.rank());
  // Of several processes only the main thread may write.
  map.turn_pieces(static_cast<std::int64_t>(share.begin), static_cast<std::int64_t>(share.end),
                  processes_.count() > 1 ? 1 : plan_.own.threads, check_);
  if (processes_.is_first()) map.write_ends();
  shared.close();
  processes_.agree([&] {
    if (processes_.is_first()) file->truncate(map.file_bytes());
  });
  return map.file_bytes();
}

std::uint64_t Join::join_mesh(OutputFile* file, const mesh::MeshText& text) {
  SharedFile shared(processes_, file);
  std::uint64_t bytes = write_mesh_header(shared, text);
  bytes = copy(PieceText::vertices, shared, bytes);
  bytes = write_triangles(shared, bytes, text);
  shared.close();
  return bytes;
}

// Returns where it ends.
std::uint64_t Join::write_mesh_header(SharedFile& file, const mesh::MeshText& text) const {
  std::uint64_t offset = 0;
  // Texts of all processes, one behind the other.
  const auto write = [&](const std::function<void(const TextSink&)>& make) {
    std::string own;
    make([&own](std::string_view piece) { own += piece; });
    offset = file.write_in_turn(own, offset);
  };
  const auto names = [](std::span<const AtomLabel> labels, std::uint64_t first, auto append) {
    return [=](const TextSink& sink) {
      TextPieces pieces(sink);
      for (std::size_t i = 0; i < labels.size(); ++i) append(pieces, first + i, labels[i]);
      pieces.flush();
    };
  };
  const OwnGroups& groups = plan_.groups;
  write([&](const TextSink& sink) {
    if (processes_.is_first()) text.write_header_begin(sink);
  });
  write(names(groups.chains, groups.first_chain, mesh::append_chain_name));
  write(names(groups.residues, groups.first_residue, mesh::append_residue_name));
  write([&](const TextSink& sink) {
    if (processes_.is_first()) text.write_header_end(mesh_, sink);
  });
  return offset;
}

template <class Take>
void Join::for_triangle_texts(Piece& piece, std::uint64_t first_vertex, const mesh::MeshText& text,
                              Take&& take) const {
  TextBuffer buffer;
  read(piece, PieceText::triangles, sizeof(mesh::LocalTriangle),
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

// Returns where they end. How long their text is depends on their numbers: it is made twice.
std::uint64_t Join::write_triangles(SharedFile& file, std::uint64_t offset,
                                    const mesh::MeshText& text) {
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
  std::map<std::int64_t, std::uint64_t> begins;  // of all pieces; at first their bytes
  for (const PieceBytes& one : processes_.gather<PieceBytes>(own)) begins[one.plane] = one.bytes;
  for (auto& [plane, begin] : begins) offset += std::exchange(begin, offset);
  for_own(vertices_of, [&](Piece& piece, std::uint64_t first_vertex) {
    std::uint64_t at = begins.at(piece.info.planes.begin);
    for_triangle_texts(piece, first_vertex, text, [&](std::span<const char> part) {
      file.write_at(part, at);
      at += part.size();
    });
    piece.texts[static_cast<std::size_t>(PieceText::triangles)].reset();
  });
  return offset;
}

template <class Take>
void Join::for_area_texts(Take&& take) const {
  const std::uint64_t first = share_of(processes_.rank()).begin;
  std::optional<Gzip> gzip;
  if (task_.outputs.gzip) gzip.emplace();
  TextBuffer text;
  for (std::size_t at = 0; at < areas_.size(); at += area_lines_at_a_time) {
    check_();
    text.clear();
    append_areas(text, first + at,
                 std::span(areas_).subspan(at, std::min(area_lines_at_a_time, areas_.size() - at)));
    take(gzip ? gzip->member(text.text()) : text.text());
  }
}

std::uint64_t Join::join_areas(OutputFile* file, double& area) {
  areas_ = own_areas();
  area = processes_.hand_on(0, [&](double sum) {
    for (const double one : areas_) sum += one;
    return sum;
  });
  if (!task_.outputs.areas) return 0;
  SharedFile shared(processes_, file);
  std::uint64_t bytes = 0;
  for_area_texts([&](std::span<const char> text) { bytes += text.size(); });
  std::uint64_t offset = processes_.sum_before(bytes);
  for_area_texts([&](std::span<const char> text) {
    shared.write_at(text, offset);
    offset += text.size();
  });
  shared.close();
  return processes_.sum(bytes);
}

std::uint64_t Join::join_tables(OutputFile* residues, OutputFile* chains) {
  const auto [begin, end] = share_of(processes_.rank());
  return write_tables_jointly(plan_.residues, plan_.read, areas_, {begin, end}, residues, chains,
                              processes_);
}

void Join::add_up() {
  std::int64_t next = plan_.whole.tiling.region.begin[2];
  for (const PieceInfo& info : all_) {
    if (info.planes.begin != next)
      throw Error("the pieces of the run do not fit together; remove what is there to resume");
    next = info.planes.end;
    totals_.add(info.totals);
    mesh_.vertices += info.mesh.vertices;
    mesh_.triangles += info.mesh.triangles;
  }
  if (next != plan_.whole.tiling.region.end[2]) throw Error("pieces of the run are missing");
  mesh::require_numbers(mesh_.vertices);
}

// Without a single member it would be no gzip file.
std::uint64_t Join::write_empty_member(SharedFile& file) const {
  Gzip gzip;
  const std::span<const char> member = gzip.member({});
  if (processes_.is_first()) file.write_at(member, 0);
  return member.size();
}

Processes::Share Join::share_of(int rank) const {
  return processes_.share_of(plan_.atoms, area_lines_at_a_time, rank);
}

std::vector<double> Join::own_areas() {
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
  std::vector<AreaShare> sums(share.end - share.begin);
  for (const AtomSum& sum : processes_.exchange(std::move(to)))
    sums[sum.atom - share.begin] += sum.share;
  std::vector<double> areas;
  areas.reserve(sums.size());
  for (const AreaShare sum : sums) areas.push_back(atom_area(sum, task_.parameters.spacing));
  return areas;
}

}  // namespace eses
