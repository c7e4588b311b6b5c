#pragma once
/// What the machine grants this process.

#include <cstdint>
#include <filesystem>
#include <string>

namespace eses::detail {

/// Number of processors that the quota of the control group amounts to, rounded up, and a large
/// number if there is no quota. `root` is the directory below which proc/ and sys/ are mounted; it
/// ends with a slash.
int processor_quota(const std::string& root = "/");

/// Bytes of memory that are free for this process: the minimum of what the system has available and
/// what the control group leaves. `root` as above.
std::uint64_t available_memory(const std::string& root = "/");

/// Bytes of memory that this process holds resident, and the most it ever held; 0 if the system
/// does not tell.
std::uint64_t resident_memory();
std::uint64_t peak_memory();

/// Gives freed memory back to the system; glibc would keep it for each thread.
void release_free_memory();

/// Bytes of stack that the program needs for each of its threads: ten times what its deepest calls
/// were seen to use.
inline constexpr std::uint64_t min_stack_bytes = std::uint64_t{256} << 10;

/// Raises a soft limit of the stack (`ulimit -S -s`) that is below `min_stack_bytes`, for the main
/// thread and for threads that start from now on. Throws Error if the hard limit is below it.
void require_stack();

/// Throws Error if the process holds more than `max_memory`, unless that is 0: it was expected to
/// hold less.
void require_memory_within(std::uint64_t max_memory);

/// Bytes free for this user in the file system of `directory`, which must exist; the largest number
/// if that cannot be told.
std::uint64_t available_disk(const std::filesystem::path& directory);

}  // namespace eses::detail
