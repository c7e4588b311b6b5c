#pragma once
/// The commands with the interface of MSMS and its scripts.

#include "cli/msms_options.hpp"

namespace eses::detail::cli {

/// Computes the surface of a file, writes its files and prints the messages of MSMS.
void run_msms(const MsmsOptions& options);

}  // namespace eses::detail::cli
