#pragma once
/// The results of the input files of a run, kept on disk so that an interrupted run can go on.

#include <compare>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "output/file.hpp"
#include "output/output_directory.hpp"

namespace eses::detail {

/// The identity of an input file and of the tables that were written for it.
struct InputKey {
  std::string path;            ///< as it was given
  int model = 0;               ///< number of the model; 0 if not each model is measured
  std::uint64_t bytes = 0;     ///< size of the file
  std::uint32_t checksum = 0;  ///< crc32 of the file
  std::uint32_t tables = 0;    ///< crc32 of the tables that belong to the result

  auto operator<=>(const InputKey&) const = default;
};

/// Reads a file for its key. Returns nothing if it is not a regular file that can be read.
std::optional<InputKey> key_of_input(const std::filesystem::path& path, int model);

/// The texts of an input.
struct InputResult {
  std::string printed;  ///< on standard output
  std::string rows;     ///< of the table of all inputs
};

/// Path of the log in `directory`: of the table `file`, or of the directory if `file` is empty.
std::string result_log_path(const std::filesystem::path& directory, const std::string& file = "");

/// Removes a log. Leaves other files of its name.
void remove_result_log(const std::string& path);

/// A hidden file to which each result is appended with a checksum. If the process is killed, all
/// results before the first damaged one remain. All failures throw Error.
class ResultLog : public File {
 public:
  /// Opens the log, or creates it. The directory must be locked. `identity` identifies the run, see
  /// identity.hpp. Throws Error if the log has results of a run with another identity, or if
  /// another file has its name.
  ResultLog(const std::string& path, std::string_view identity);

  /// Returns the result that an earlier run has kept.
  std::optional<InputResult> find(const InputKey& key) const;

  /// Appends a result. Several threads may call it.
  void add(const InputKey& key, const InputResult& result);

 private:
  /// Place of the texts of a result in the log.
  struct Texts {
    std::uint64_t begin = 0, printed_bytes = 0, row_bytes = 0;
  };

  void append_record(const InputKey& key, const InputResult& result);
  void read_records(std::string_view identity);

  std::string path_;
  std::map<InputKey, Texts> kept_;
  std::mutex mutex_;
};

}  // namespace eses::detail
