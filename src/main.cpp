#include "cli/command.hpp"

int main(int argc, char** argv) { return eses::detail::cli::run_command(argc, argv); }
