#include "processes/pieces.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "eses/error.hpp"
#include "io/output_directory.hpp"
#include "run/output_files.hpp"

namespace eses {
namespace {

constexpr char identity_name[] = "run";
constexpr std::string_view sums_suffix = ".sums";
constexpr std::array<const char*, piece_texts> text_suffixes{".grid", ".edges"};

std::string name_of(const PlaneRange& planes, std::string_view suffix) {
  return fmt::format("{}-{}{}", planes.begin, planes.end, suffix);
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

std::string read_all(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
}

template <class Value>
std::span<const std::byte> bytes_of(const Value& value) {
  return std::as_bytes(std::span(&value, 1));
}

}  // namespace

PieceStore::PieceStore(const std::filesystem::path& output_directory, std::string identity)
    : path_(path_in(output_directory, resume_name)), identity_(std::move(identity)) {}

std::vector<PlaneRange> PieceStore::complete() const {
  std::error_code error;
  if (!std::filesystem::exists(path_, error)) return {};
  if (read_all(path_ / identity_name) != identity_) {
    // Without anything done it does not matter of what run.
    bool is_empty = true;
    for (const auto& entry : std::filesystem::directory_iterator(path_, error))
      is_empty = is_empty && !planes_of(entry.path().filename().string());
    if (is_empty) return {};
    throw Error(fmt::format(
        "cannot resume: {} is of a run of other input, options or version; remove it to begin anew",
        path_.string()));
  }
  std::vector<PlaneRange> pieces;
  for (const auto& entry : std::filesystem::directory_iterator(path_, error))
    if (const auto planes = planes_of(entry.path().filename().string())) pieces.push_back(*planes);
  std::sort(pieces.begin(), pieces.end(),
            [](const PlaneRange& a, const PlaneRange& b) { return a.begin < b.begin; });
  const auto overlapping =
      std::adjacent_find(pieces.begin(), pieces.end(),
                         [](const PlaneRange& a, const PlaneRange& b) { return b.begin < a.end; });
  if (overlapping != pieces.end())
    throw Error(fmt::format("cannot resume: pieces in {} overlap; remove it to begin anew",
                            path_.string()));
  return pieces;
}

void PieceStore::prepare() const {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error) throw Error(fmt::format("cannot create {}: {}", path_.string(), error.message()));
  if (read_all(path_ / identity_name) == identity_) return;
  ScratchFile file(path_, identity_name, ScratchFile::Kept::fresh);
  file.append(std::as_bytes(std::span(identity_)));
  file.sync();
}

std::unique_ptr<ScratchFile> PieceStore::create(const PlaneRange& planes, PieceText text) const {
  const char* const suffix = text_suffixes[static_cast<std::size_t>(text)];
  return std::make_unique<ScratchFile>(path_, name_of(planes, suffix), ScratchFile::Kept::fresh);
}

std::unique_ptr<ScratchFile> PieceStore::open(const PlaneRange& planes, PieceText text) const {
  const char* const suffix = text_suffixes[static_cast<std::size_t>(text)];
  return std::make_unique<ScratchFile>(path_, name_of(planes, suffix), ScratchFile::Kept::existing);
}

// The sums come last, under their name when they are on the disk: where they are, all is.
void PieceStore::finish(Piece piece) const {
  for (const auto& text : piece.texts)
    if (text) text->sync();
  const std::string name = name_of(piece.info.planes, sums_suffix), temporary = name + ".part";
  {
    ScratchFile file(path_, temporary, ScratchFile::Kept::fresh);
    const std::uint64_t count = piece.sums.size();
    const auto sums = std::as_bytes(std::span(piece.sums));
    const std::uint64_t check = checksum(bytes_of(piece.info)) ^ checksum(sums);
    for (const auto bytes : {bytes_of(piece.info), bytes_of(count), sums, bytes_of(check)})
      file.append(bytes);
    file.sync();
  }
  std::error_code error;
  std::filesystem::rename(path_ / temporary, path_ / name, error);
  if (error)
    throw Error(fmt::format("cannot write {}: {}", (path_ / name).string(), error.message()));
}

Piece PieceStore::read(const PlaneRange& planes) const {
  Piece piece;
  const ScratchFile file(path_, name_of(planes, sums_suffix), ScratchFile::Kept::existing);
  std::uint64_t offset = 0, count = 0, check = 0;
  const auto read = [&](std::span<std::byte> bytes) {
    file.read_at(bytes, offset);
    offset += bytes.size();
  };
  read(std::as_writable_bytes(std::span(&piece.info, 1)));
  read(std::as_writable_bytes(std::span(&count, 1)));
  const std::uint64_t bytes = std::filesystem::file_size(path_ / name_of(planes, sums_suffix));
  const bool fits = offset + count * sizeof(AtomSum) + sizeof check == bytes;
  if (fits) {
    piece.sums.resize(count);
    read(std::as_writable_bytes(std::span(piece.sums)));
    read(std::as_writable_bytes(std::span(&check, 1)));
  }
  if (!fits || piece.info.planes != planes ||
      check != (checksum(bytes_of(piece.info)) ^ checksum(std::as_bytes(std::span(piece.sums)))))
    throw Error(fmt::format("cannot resume: {} is damaged; remove {} to begin anew",
                            name_of(planes, sums_suffix), path_.string()));
  return piece;
}

}  // namespace eses
