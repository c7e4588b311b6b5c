#include "support/sandbox.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "catch.hpp"

namespace fs = std::filesystem;

namespace eses::detail::test {
namespace {

/// Evaluates a Python expression about the JSON report `r`.
std::string ask_json(const Sandbox& sandbox, const std::string& json, const std::string& question) {
  const std::string in = (sandbox.directory() / "report.json").string();
  const std::string out = (sandbox.directory() / "answer").string();
  write_file(in, json);
  const std::string program =
      "import json, sys; r = json.loads(sys.stdin.buffer.read().decode('utf-8', 'strict')); "
      "print(ascii((" +
      question + ")))";
  REQUIRE(shell(shell_quoted(ESES_PYTHON) + " -c " + shell_quoted(program) + " <" +
                shell_quoted(in) + " >" + shell_quoted(out)) == 0);
  return read_file(out);
}

}  // namespace

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

SpecialFiles::SpecialFiles(const fs::path& directory) {
  const fs::path fifo = directory / "fifo", socket_file = directory / "socket";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  kinds[fifo] = "a FIFO";
  sockaddr_un address{};
  if (socket_file.native().size() < sizeof address.sun_path) {
    address.sun_family = AF_UNIX;
    socket_file.native().copy(address.sun_path, sizeof address.sun_path);
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
    REQUIRE(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    ::close(descriptor);
    kinds[socket_file] = "a socket";
  }
  if (fs::is_character_file("/dev/null")) kinds["/dev/null"] = "a character device";
}

Sandbox::Sandbox() {
  fs::create_directory(directory());
  write_file(directory() / "atom.xyzr", "0.1 0.2 0.3 1.5\n");
  write_file(directory() / "pair.xyzr", "0 0 0 1.5\n3 0 0 1.7\n");
}

std::string Sandbox::command(const Arguments& arguments) {
  std::string result = shell_quoted(ESES_BINARY);
  for (const std::string& argument : arguments) result.append(" ").append(shell_quoted(argument));
  return result;
}

Outcome Sandbox::run(const Arguments& arguments, const std::string& redirections,
                     const std::string& before) const {
  const fs::path out = root_.path() / "stdout", err = root_.path() / "stderr";
  const int code = shell("cd " + shell_quoted(directory().string()) + " && " + before + " " +
                         command(arguments) + " </dev/null >" + shell_quoted(out.string()) + " 2>" +
                         shell_quoted(err.string()) + " " + redirections);
  return {code, read_file(out), read_file(err)};
}

std::set<std::string> Sandbox::files(const fs::path& below) const {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(directory() / below)) {
    if (entry.path().extension() == ".txt") names.insert(entry.path().filename().string());
  }
  return names;
}

bool contains(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (contains(line, part)) lines.push_back(line);
  }
  return lines;
}

double value_of(const std::string& text, const std::string& key) {
  const std::vector<std::string> lines = lines_with(text, key);
  REQUIRE(lines.size() == 1);
  return std::stod(lines[0].substr(lines[0].find(key) + key.size()));
}

std::string result_lines(const Outcome& outcome) {
  REQUIRE(outcome.code == 0);
  std::string result;
  for (const std::string key : {"area:", "volume:"}) {
    for (const std::string& line : lines_with(outcome.out, key)) result += line + "\n";
  }
  return result;
}

void check_usage_error(const Sandbox& sandbox, const Arguments& arguments,
                       const std::string& message) {
  INFO(Sandbox::command(arguments));
  const std::string first = arguments.empty() ? "" : arguments.front();
  const std::set<std::string> commands{"diff", "interface", "measure", "msms", "pdb_to_xyzr"};
  const bool is_command = commands.contains(first);
  const Outcome outcome = sandbox.run(arguments);
  CHECK(outcome.code == 2);
  CHECK(outcome.out.empty());
  CHECK(outcome.err == "eses-blocks: error: " + message + "\nTry 'eses-blocks " +
                           (is_command ? first + " " : "") + "--help'.\n");
}

void check_json(const Sandbox& sandbox, const std::string& json, const std::string& question,
                const std::string& expected) {
  CHECK(ask_json(sandbox, json, question) == expected + "\n");
}

}  // namespace eses::detail::test
