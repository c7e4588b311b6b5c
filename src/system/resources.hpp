#pragma once
/// Processors, memory, stack and disk space that are available to this process.

#include <bitset>
#include <cstdint>
#include <filesystem>
#include <string>

namespace eses::detail {

/// A set of processors of a machine; bit i is processor i.
using ProcessorSet = std::bitset<1024>;

/// Returns the processors to which this process is bound, or all of them if the system does not
/// bind processes. There is at least one.
ProcessorSet allowed_processors();

/// Returns the processor quota of the control group, rounded up to whole processors, or a large
/// number if there is no quota. `root` is the directory below which proc/ and sys/ are mounted; it
/// ends with a slash.
int processor_quota(const std::string& root = "/");

/// Returns the bytes of memory that this process can still allocate: the minimum of the system's
/// available memory and the remaining memory of the control groups. See processor_quota for `root`.
std::uint64_t available_memory(const std::string& root = "/");

/// Memory in bytes that a run may take without asking for the available memory, and may keep when
/// it is freed: a program that calls the library holds as much itself. Asking takes longer than
/// computing a few atoms.
inline constexpr std::uint64_t small_memory_bytes = std::uint64_t{16} << 20;

/// Returns the resident memory of this process in bytes, or 0 if it is unknown.
std::uint64_t resident_memory();

/// Returns the maximum of the resident memory of this process so far, in bytes, or 0 if it is
/// unknown.
std::uint64_t peak_memory();

/// Returns freed memory to the system. Without this call glibc keeps it for each thread.
void release_free_memory();

/// Lets glibc keep freed memory until release_free_memory(). Otherwise lists that are made for each
/// block go back to the system and are cleared by it again.
void keep_free_memory();

/// Average ratio of the touched memory of a growing list to its size, for estimates of memory.
inline constexpr double list_growth = 1.5;

/// Minimum stack of each thread in bytes: ten times the measured maximum.
inline constexpr std::uint64_t min_stack_bytes = std::uint64_t{256} << 10;

/// Raises the soft limit of the stack (`ulimit -S -s`) to `min_stack_bytes` if it is lower, for the
/// main thread and for threads that start later. Throws Error if the hard limit is lower.
void require_stack();

/// Throws Error if the resident memory of the process exceeds that of `before` by more than
/// `max_memory` bytes. A limit of 0 means no limit.
void require_memory_within(std::uint64_t max_memory, std::uint64_t before);

/// Returns the bytes that this user can write to the file system of `directory`, which must exist,
/// or the largest number if the free space is unknown.
std::uint64_t available_disk(const std::filesystem::path& directory);

}  // namespace eses::detail
