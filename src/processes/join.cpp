#include "processes/join.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "eses/error.hpp"
#include "io/eses_text.hpp"
#include "io/gzip.hpp"
#include "io/output_directory.hpp"
#include "run/output_files.hpp"
#include "run/short_file.hpp"

namespace eses {
namespace {

constexpr std::size_t copied_at_a_time = std::size_t{1} << 22;  // bytes

}  // namespace

Join::Join(const JointTask& task, const JointPlan& plan, const JointPaths& paths,
           const Processes& processes, std::function<void()> check)
    : task_(task), plan_(plan), paths_(paths), processes_(processes), check_(std::move(check)) {}

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

std::uint64_t Join::join_texts(OutputFile* file, const char* name, PieceText text) {
  const auto which = static_cast<std::size_t>(text);
  SharedFile shared = open(file, name);
  std::uint64_t offset = 0;
  auto mine = own_.begin();
  for (const PieceInfo& info : all_) {
    if (mine != own_.end() && mine->info.planes == info.planes) copy(*mine++, text, shared, offset);
    offset += info.bytes[which];
  }
  if (task_.outputs.gzip && offset == 0) offset += write_empty_member(shared);
  shared.close();
  return offset;
}

template <class Take>
void Join::for_area_texts(std::span<const double> areas, Take&& take) const {
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

std::uint64_t Join::join_areas(OutputFile* file, double& area) {
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

void Join::add_up() {
  std::int64_t next = plan_.whole.tiling.region.begin[2];
  for (const PieceInfo& info : all_) {
    if (info.planes.begin != next)
      throw Error("the pieces of the run do not fit together; remove what is there to resume");
    next = info.planes.end;
    totals_.add(info.totals);
  }
  if (next != plan_.whole.tiling.region.end[2]) throw Error("pieces of the run are missing");
}

SharedFile Join::open(OutputFile* file, const char* name) const {
  const std::string full_name = text_file_name(name, task_.outputs.gzip);
  return {processes_, file,
          path_in(task_.output_directory, temporary_name(full_name, paths_.process)),
          path_in(task_.output_directory, full_name)};
}

void Join::copy(Piece& piece, PieceText text, SharedFile& to, std::uint64_t offset) const {
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
  std::vector<Tally::Sum> sums(share.end - share.begin);
  for (const AtomSum& sum : processes_.exchange(std::move(to)))
    sums[sum.atom - share.begin] += sum.share;
  std::vector<double> areas;
  areas.reserve(sums.size());
  for (const Tally::Sum sum : sums) areas.push_back(atom_area(sum, task_.parameters.spacing));
  return areas;
}

}  // namespace eses
