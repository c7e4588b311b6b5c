// Prints the number of the instruction set that the dispatch chooses, for
// test_instruction_sets.cpp. A process chooses it only once.

#include <cstdio>

#include "system/dispatch.hpp"

int main() { std::printf("%d\n", static_cast<int>(eses::detail::instruction_set())); }
