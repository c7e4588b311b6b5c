// Tests of the real program: standard streams, pipes and signals.

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "catch.hpp"
#include "support/sandbox.hpp"
#include "support/temporary_directory.hpp"

namespace fs = std::filesystem;

namespace {

using namespace eses::detail::test;

}  // namespace

TEST_CASE("a full standard output is an error", "[cli]") {
  const Sandbox sandbox;
  if (fs::exists("/dev/full")) {
    for (const Arguments& arguments :
         {Arguments{"pair.xyzr"}, Arguments{"pair.xyzr", "-q"}, Arguments{"pair.xyzr", "--json"},
          Arguments{"--help"}, Arguments{"--version"}}) {
      INFO(Sandbox::command(arguments));
      const Outcome outcome = sandbox.run(arguments, ">/dev/full");
      CHECK(outcome.code == 1);
      CHECK(outcome.err.rfind("eses-blocks: error: cannot write to standard output: ", 0) == 0);
    }
  }
  CHECK(sandbox.run({"pair.xyzr", "-q"}, ">&-").code == 1);
  CHECK(sandbox.run({"pair.xyzr"}, ">&- 2>&- <&-").code == 1);
}

TEST_CASE("closed standard streams do not end up in the files", "[cli]") {
  const Sandbox sandbox;
  REQUIRE(sandbox.run({"pair.xyzr", "-o", "good"}).code == 0);
  REQUIRE(sandbox.run({"pair.xyzr", "-q", "-o", "closed"}, "2>&- <&-").code == 0);
  REQUIRE(sandbox.files("closed") == all_files);
  for (const std::string& name : all_files) {
    CHECK(read_file(sandbox.directory() / "closed" / name) ==
          read_file(sandbox.directory() / "good" / name));
  }
  CHECK(sandbox.run({"pair.xyzr", "-q", "-o", "none"}, ">&- 2>&- <&-").code == 1);
  CHECK_FALSE(fs::exists(sandbox.directory() / "none"));
}

TEST_CASE("a signal ends a run with its exit code and without files", "[cli]") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const eses::detail::test::TemporaryDirectory directory;
    const auto input = directory.path() / "big.xyzr", output = directory.path() / "out";
    std::ofstream(input) << "0 0 0 200\n";
    const pid_t program = fork();
    if (program == 0) {
      std::freopen("/dev/null", "w", stdout);
      std::freopen("/dev/null", "w", stderr);
      std::signal(signal, SIG_DFL);  // the program would inherit an ignored signal
      execl(ESES_BINARY, "eses-blocks", input.c_str(), "--spacing", "0.3", "--write", "edges", "-o",
            output.c_str(), nullptr);
      _exit(127);
    }
    INFO("signal " << signal);
    // The run would take many seconds. It is interrupted as soon as there are files.
    int status = 0;
    const auto has_files = [&] {
      return std::filesystem::exists(output) && !std::filesystem::is_empty(output);
    };
    while (!has_files()) {
      REQUIRE(waitpid(program, &status, WNOHANG) == 0);
      usleep(10000);
    }
    kill(program, signal);
    waitpid(program, &status, 0);
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 128 + signal);
    CHECK(std::filesystem::is_empty(output));
  }
}

TEST_CASE("a closed pipe is an error, not a signal", "[cli]") {
  const Sandbox sandbox;
  // The right side closes its end of the pipe before it lets the left side start.
  REQUIRE(shell("cd " + shell_quoted(sandbox.directory().string()) + " && mkfifo go && { cat go; " +
                Sandbox::command({"pair.xyzr"}) +
                " 2>err; echo $? >code; } | { exec <&-; echo >go; }; cat code >/dev/null") == 0);
  CHECK(read_file(sandbox.directory() / "code") == "1\n");
  CHECK(contains(read_file(sandbox.directory() / "err"), "cannot write to standard output"));
}

TEST_CASE("a closed pipe ends what only prints without a message", "[cli]") {
  for (const Arguments& arguments :
       {Arguments{"measure", "pair.xyzr", "-q"}, Arguments{"interface", "pair.pqr"},
        Arguments{"--help"}, Arguments{"--version"}, Arguments{"diff", "--help"},
        Arguments{"msms", "--help"}}) {
    const Sandbox sandbox;
    write_file(sandbox.directory() / "pair.pqr",
               "ATOM 1 N ALA A 1 0 0 0 0 1.5\nATOM 2 N ALA B 1 3 0 0 0 1.5\n");
    INFO(Sandbox::command(arguments));
    REQUIRE(shell("cd " + shell_quoted(sandbox.directory().string()) +
                  " && mkfifo go && { cat go; " + Sandbox::command(arguments) +
                  " 2>err; echo $? >code; } | { exec <&-; echo >go; }; cat code >/dev/null") == 0);
    CHECK(read_file(sandbox.directory() / "code") == "141\n");
    CHECK(read_file(sandbox.directory() / "err").empty());
  }
}
