// Makes one system call or allocation of a program fail. The library is loaded with LD_PRELOAD. The
// environment variable ESES_FAULT chooses the fault as `CALL NUMBER ACTION`:
//
//   CALL    open close lock write read cut rename unlink    on a file that is being written, or on
//           its lock
//           file      any of these calls
//           alloc     an allocation
//           space     the disk is full: writing beyond byte NUMBER of a file whose name contains
//                     ACTION fails
//   NUMBER  number of the call in the whole process, from 1
//   ACTION  fail=N    the call fails once with errno N
//           stay=N    the call and all later ones fail with errno N
//           signal=N  signal N is raised before the call
//           hang      the call takes an hour
//
// When the fault occurs, the file named by ESES_FAULT_MARK is created.

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): glibc's own names
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

namespace {

struct Fault {
  std::array<char, 16> call{};
  long number = 0;
  std::array<char, 64> action{};
  const char* mark = nullptr;
};
Fault fault;
std::atomic<long> calls = 0;

__attribute__((constructor)) void read_environment() {
  const char* const text = std::getenv("ESES_FAULT");
  fault.mark = std::getenv("ESES_FAULT_MARK");
  if (text)
    std::sscanf(text, "%15s %ld %63s", fault.call.data(), &fault.number, fault.action.data());
}

void mark() {
  if (!fault.mark) return;
  const long file = syscall(SYS_openat, AT_FDCWD, fault.mark, O_WRONLY | O_CREAT, 0666);
  if (file >= 0) syscall(SYS_close, file);
}

int number_of_action() { return std::atoi(std::strchr(fault.action.data(), '=') + 1); }

// Sleeps longer than any test waits. A program that ends has not waited for this call.
void sleep_for_an_hour() {
  timespec left{3600, 0};
  while (nanosleep(&left, &left) != 0 && errno == EINTR) {
  }
}

// Counts the call. Returns whether it must fail, and sets errno.
bool fails() {
  const std::string_view action = fault.action.data();
  const long count = ++calls;
  if (count < fault.number || (count > fault.number && !action.starts_with("stay"))) return false;
  if (count == fault.number) mark();
  if (action == "hang") sleep_for_an_hour();
  if (action.starts_with("signal")) raise(number_of_action());
  if (!action.starts_with("fail") && !action.starts_with("stay")) return false;
  errno = number_of_action();
  return true;
}

bool allocation_fails() { return std::string_view("alloc") == fault.call.data() && fails(); }

bool is_output(std::string_view path) {
  return path.ends_with(".part") || path.ends_with(".eses-blocks.lock") ||
         path.ends_with(".eses-blocks.results") || path.find("/.eses-blocks.resume/") != path.npos;
}

bool call_fails(std::string_view call) {
  const std::string_view wanted = fault.call.data();
  return (wanted == call || wanted == "file") && fails();
}

bool path_call_fails(std::string_view call, const char* path) {
  return is_output(path) && call_fails(call);
}

std::string_view path_of(int descriptor, std::array<char, 4096>& buffer) {
  std::array<char, 64> link{};
  std::snprintf(link.data(), link.size(), "/proc/self/fd/%d", descriptor);
  const ssize_t size = readlink(link.data(), buffer.data(), buffer.size());
  std::string_view path(buffer.data(), size > 0 ? static_cast<std::size_t>(size) : 0);
  constexpr std::string_view deleted = " (deleted)";
  if (path.ends_with(deleted)) path.remove_suffix(deleted.size());
  return path;
}

bool descriptor_call_fails(std::string_view call, int descriptor) {
  if (fault.number == 0) return false;
  std::array<char, 4096> buffer;
  return is_output(path_of(descriptor, buffer)) && call_fails(call);
}

// Returns how many of `size` bytes fit on the disk; all of them if the fault is for another file.
std::size_t room_for(int descriptor, std::size_t size, off_t offset) {
  if (std::string_view("space") != fault.call.data()) return size;
  std::array<char, 4096> buffer;
  const std::string_view path = path_of(descriptor, buffer);
  if (path.find(fault.action.data()) == std::string_view::npos) return size;
  const long room = fault.number - 1 - offset;
  if (room >= static_cast<long>(size)) return size;
  mark();
  return room > 0 ? static_cast<std::size_t>(room) : 0;
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) { return allocation_fails() ? nullptr : __libc_malloc(size); }

void* calloc(std::size_t count, std::size_t size) {
  return allocation_fails() ? nullptr : __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  return allocation_fails() ? nullptr : __libc_realloc(old, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return allocation_fails() ? nullptr : __libc_memalign(alignment, size);
}

int openat(int directory, const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & O_CREAT) != 0) {
    va_list arguments;
    va_start(arguments, flags);
    mode = va_arg(arguments, mode_t);
    va_end(arguments);
  }
  if (path_call_fails("open", path)) return -1;
  return static_cast<int>(syscall(SYS_openat, directory, path, flags, mode));
}

int close(int descriptor) {
  // close() closes the file even if it fails.
  const bool is_failing = descriptor_call_fails("close", descriptor);
  const int error = errno;
  const auto result = static_cast<int>(syscall(SYS_close, descriptor));
  if (!is_failing) return result;
  errno = error;
  return -1;
}

int flock(int descriptor, int operation) {
  if (descriptor_call_fails("lock", descriptor)) return -1;
  return static_cast<int>(syscall(SYS_flock, descriptor, operation));
}

ssize_t pwrite(int descriptor, const void* bytes, std::size_t size, off_t offset) {
  if (descriptor_call_fails("write", descriptor)) return -1;
  const std::size_t room = room_for(descriptor, size, offset);
  if (room == 0 && size > 0) {
    errno = ENOSPC;
    return -1;
  }
  return next<ssize_t(int, const void*, std::size_t, off_t)>("pwrite")(descriptor, bytes, room,
                                                                       offset);
}

ssize_t pread(int descriptor, void* bytes, std::size_t size, off_t offset) {
  if (descriptor_call_fails("read", descriptor)) return -1;
  return next<ssize_t(int, void*, std::size_t, off_t)>("pread")(descriptor, bytes, size, offset);
}

int ftruncate(int descriptor, off_t size) noexcept {
  if (descriptor_call_fails("cut", descriptor)) return -1;
  return static_cast<int>(syscall(SYS_ftruncate, descriptor, size));
}

int renameat(int old_directory, const char* from, int directory, const char* to) {
  if (path_call_fails("rename", from)) return -1;
  return next<int(int, const char*, int, const char*)>("renameat")(old_directory, from, directory,
                                                                   to);
}

int unlinkat(int directory, const char* path, int flags) {
  if (call_fails("unlink")) return -1;
  return static_cast<int>(syscall(SYS_unlinkat, directory, path, flags));
}

int remove(const char* path) noexcept {
  if (call_fails("unlink")) return -1;
  return next<int(const char*)>("remove")(path);
}
}
