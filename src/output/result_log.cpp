#include "output/result_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <fstream>
#include <span>
#include <system_error>
#include <vector>

#include "eses/error.hpp"
#include "output/identity.hpp"
#include "system/formatted.hpp"
#include "system/gzip.hpp"

namespace eses::detail {
namespace {

// Begins each record: the text `eresult` and the version of the format.
constexpr std::uint64_t record_mark = 0x32746c7573657265;

// Returns whether a file begins like a log. Only a part of its first record may have been written.
bool is_result_log(const std::string& path) {
  std::array<char, sizeof(record_mark) - 1> start{};  // without the version
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  const auto mark = std::bit_cast<std::array<char, sizeof(record_mark)>>(record_mark);
  return std::equal(start.begin(), start.begin() + file.gcount(), mark.begin());
}

// A record is a header, and then the path, the printed text and the rows.
struct RecordHeader {
  std::uint64_t mark = record_mark;
  std::uint64_t path_bytes = 0, printed_bytes = 0, row_bytes = 0;
  std::uint64_t input_bytes = 0, table_checksum = 0;
  std::int64_t model = 0;
  std::uint64_t input_checksum = 0;
  std::uint64_t checksum = 0;  // of all that is before it, and of the texts

  std::uint64_t text_bytes() const { return path_bytes + printed_bytes + row_bytes; }
};

std::uint64_t checksum_of(RecordHeader header, std::span<const char> texts) {
  header.checksum = 0;
  return checksum(texts, checksum(as_chars(std::span<const RecordHeader>(&header, 1))));
}

// The key of the record with the identity of the run.
InputKey key_of_identity() { return {.path = "", .model = -1}; }

}  // namespace

std::optional<InputKey> key_of_input(const std::filesystem::path& path, int model) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  std::ifstream file(path, std::ios::binary);
  InputKey key{.path = path.string(), .model = model};
  std::vector<char> part(std::size_t{1} << 16);
  while (file) {
    file.read(part.data(), static_cast<std::streamsize>(part.size()));
    const auto count = static_cast<std::size_t>(file.gcount());
    key.checksum = checksum(std::span(part).first(count), key.checksum);
    key.bytes += count;
  }
  return file.eof() ? std::optional(key) : std::nullopt;
}

std::string result_log_path(const std::filesystem::path& directory, const std::string& file) {
  return hidden_path(directory, file, ".eses-blocks.results");
}

void remove_result_log(const std::string& path) {
  if (is_result_log(path)) unlink(path.c_str());
}

ResultLog::ResultLog(const std::string& path, std::string_view identity) : File(path), path_(path) {
  file_ = FileDescriptor(open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (!file_.is_open()) fail("open", errno);
  if (!is_result_log(path))
    throw Error(formatted("{} is no file of kept results, which have this name; rename it", path));
  read_records(identity);
}

void ResultLog::read_records(std::string_view identity) {
  const std::uint64_t bytes = size();
  std::uint64_t end = 0;
  std::string found;
  std::vector<char> texts;
  for (RecordHeader header; bytes - end >= sizeof(header);) {
    const std::uint64_t begin = end + sizeof(header);
    read_at(as_chars(std::span(&header, 1)), end);
    // Sizes of a damaged header could overflow their sum.
    if (header.mark != record_mark || header.path_bytes > bytes || header.printed_bytes > bytes ||
        header.row_bytes > bytes || header.text_bytes() > bytes - begin)
      break;
    texts.resize(header.text_bytes());
    read_at(texts, begin);
    if (header.checksum != checksum_of(header, texts)) break;
    const InputKey key{.path = {texts.data(), header.path_bytes},
                       .model = static_cast<int>(header.model),
                       .bytes = header.input_bytes,
                       .checksum = static_cast<std::uint32_t>(header.input_checksum),
                       .tables = static_cast<std::uint32_t>(header.table_checksum)};
    if (end == 0)
      found.assign(texts.begin(), texts.end());
    else
      kept_[key] = {begin + header.path_bytes, header.printed_bytes, header.row_bytes};
    end = begin + header.text_bytes();
  }
  // Without results, the identity does not matter.
  if (!kept_.empty() && found != identity)
    throw Error(
        formatted("cannot resume: {} has results of a run that differs in {}; remove it to start "
                  "again",
                  path_, differing_names(identity, found)));
  if (kept_.empty()) end = 0;
  if (ftruncate(file_.value(), static_cast<off_t>(end)) != 0) fail("write", errno);
  append_from(end);
  if (end == 0) append_record(key_of_identity(), {std::string(identity), ""});
}

std::optional<InputResult> ResultLog::find(const InputKey& key) const {
  const auto found = kept_.find(key);
  if (found == kept_.end()) return std::nullopt;
  const Texts& texts = found->second;
  InputResult result{std::string(texts.printed_bytes, '\0'), std::string(texts.row_bytes, '\0')};
  read_at(result.printed, texts.begin);
  read_at(result.rows, texts.begin + texts.printed_bytes);
  return result;
}

void ResultLog::add(const InputKey& key, const InputResult& result) {
  const std::lock_guard lock(mutex_);
  append_record(key, result);
}

void ResultLog::append_record(const InputKey& key, const InputResult& result) {
  RecordHeader header{.path_bytes = key.path.size(),
                      .printed_bytes = result.printed.size(),
                      .row_bytes = result.rows.size(),
                      .input_bytes = key.bytes,
                      .table_checksum = key.tables,
                      .model = key.model,
                      .input_checksum = key.checksum};
  const std::string texts = key.path + result.printed + result.rows;
  header.checksum = checksum_of(header, texts);
  const auto bytes = as_chars(std::span<const RecordHeader>(&header, 1));
  append(std::string(bytes.begin(), bytes.end()) + texts);
}

}  // namespace eses::detail
