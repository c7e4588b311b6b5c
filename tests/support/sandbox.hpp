#pragma once
/// The real program, run from a shell in a directory of its own.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "support/temporary_directory.hpp"

namespace eses::detail::test {

using Arguments = std::vector<std::string>;

/// Empty if the file cannot be read.
std::string read_file(const std::filesystem::path& path);

void write_file(const std::filesystem::path& path, const std::string& text);

std::string shell_quoted(const std::string& text);

/// The exit code of a command.
int shell(const std::string& command);

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

/// A working directory with a few molecules; the captured streams are kept beside it.
class Sandbox {
 public:
  Sandbox();

  std::filesystem::path directory() const { return root_.path() / "work"; }

  static std::string command(const Arguments& arguments);

  /// Runs the program here. `redirections` is shell text that overrides the capture; `before` is
  /// shell text before the command, such as `NAME=value`.
  Outcome run(const Arguments& arguments, const std::string& redirections = "",
              const std::string& before = "") const;

  /// The names of the files `*.txt`.
  std::set<std::string> files(const std::filesystem::path& below = ".") const;

 private:
  TemporaryDirectory root_;
};

/// Files of each kind that must not be replaced: a FIFO and a socket, made in a directory whose
/// path is short enough, and the device /dev/null if there is one.
struct SpecialFiles {
  explicit SpecialFiles(const std::filesystem::path& directory);
  std::map<std::filesystem::path, std::string> kinds;  ///< how messages call them
};

bool contains(const std::string& text, const std::string& part);

/// Runs the program and checks that it ends with this usage error and prints nothing else. With
/// `diff` as the first argument, the advice is that of this command.
void check_usage_error(const Sandbox& sandbox, const Arguments& arguments,
                       const std::string& message);

/// Checks the value of a Python expression about the JSON report `r`.
void check_json(const Sandbox& sandbox, const std::string& json, const std::string& question,
                const std::string& expected);

}  // namespace eses::detail::test
