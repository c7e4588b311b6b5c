// Prints the number of the instruction set that the dispatch chooses, for
// test_instruction_sets.cpp: within one process it is chosen once.

#include <cstdio>

#include "simd/dispatch.hpp"

int main() { std::printf("%d\n", static_cast<int>(eses::detail::instruction_set())); }
