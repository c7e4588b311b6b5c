#pragma once
/// Runs the real program from a shell in a temporary directory.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "support/temporary_directory.hpp"

namespace eses::detail::test {

using Arguments = std::vector<std::string>;

/// Reads a file. Returns an empty text if it cannot be read.
std::string read_file(const std::filesystem::path& path);

void write_file(const std::filesystem::path& path, const std::string& text);

std::string shell_quoted(const std::string& text);

/// Returns the exit code of a command.
int shell(const std::string& command);

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

/// A working directory with a few molecules. The captured output is kept beside it.
class Sandbox {
 public:
  Sandbox();

  std::filesystem::path directory() const { return root_.path() / "work"; }

  static std::string command(const Arguments& arguments);

  /// Runs the program here. `redirections` is shell text that overrides the capture. `before` is
  /// shell text before the command, such as `NAME=value`.
  Outcome run(const Arguments& arguments, const std::string& redirections = "",
              const std::string& before = "") const;

  /// Returns the names of the files `*.txt`.
  std::set<std::string> files(const std::filesystem::path& below = ".") const;

 private:
  TemporaryDirectory root_;
};

/// Files of each kind that must not be replaced: a FIFO, a socket and, if there is one, the device
/// /dev/null. FIFO and socket are in a directory whose path is short enough for a socket.
struct SpecialFiles {
  explicit SpecialFiles(const std::filesystem::path& directory);
  std::map<std::filesystem::path, std::string> kinds;  ///< name of the kind in messages
};

/// The text files of a run with default outputs.
inline const std::set<std::string> all_files{"bounding_box.txt", "grid_info.txt",
                                             "intersection_info.txt", "partition_area.txt"};

bool contains(std::string_view text, std::string_view part);

std::vector<std::string> lines_with(const std::string& text, const std::string& part);

/// Returns the value after `key` in the only line that contains it, as callers of ESES look for it.
double value_of(const std::string& text, const std::string& key);

/// Returns the lines of the area and the volume of a run without error.
std::string result_lines(const Outcome& outcome);

/// Runs the program and checks that it ends with this usage error and prints nothing else. With
/// a command such as `diff` as the first argument, the message refers to the help of this command.
void check_usage_error(const Sandbox& sandbox, const Arguments& arguments,
                       const std::string& message);

/// Checks the value of a Python expression about the JSON report `r`.
void check_json(const Sandbox& sandbox, const std::string& json, const std::string& question,
                const std::string& expected);

}  // namespace eses::detail::test
