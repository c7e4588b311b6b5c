#include <fcntl.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "distributed/mpi_errors.hpp"
#include "distributed/shared_file.hpp"
#include "system/file_descriptor.hpp"
#include "system/formatted.hpp"

namespace eses::detail {

struct SharedFile::Handle {
  MPI_File file = MPI_FILE_NULL;
  FileDescriptor local;  // the same file; open only if copy_from may use it
};

namespace {

// Calls `action(part, offset, status)` for parts of the bytes. MPI counts are of type int.
template <class Byte, class Action>
void in_parts(std::span<Byte> bytes, std::uint64_t offset, Action&& action) {
  constexpr std::size_t max_part = std::size_t{1} << 30;
  for (std::size_t begin = 0; begin < bytes.size(); begin += max_part) {
    MPI_Status status;
    action(bytes.subspan(begin, std::min(max_part, bytes.size() - begin)),
           static_cast<MPI_Offset>(offset + begin), &status);
  }
}

bool is_done(const MPI_Status& status, std::size_t bytes) {
  int done = 0;
  MPI_Get_count(&status, MPI_BYTE, &done);
  return done == static_cast<int>(bytes);
}

void require(int error, const char* action, const std::string& name) {
  if (error != MPI_SUCCESS)
    throw Error(formatted("cannot {} {}: {}", action, name, mpi_error_text(error)));
}

}  // namespace

SharedFile::SharedFile(const Processes& processes, OutputFile* file)
    : processes_(processes), file_(file) {
  if (processes.count() == 1) return;
  name_ = processes.broadcast(file != nullptr ? file->path() : "");
  const std::string path = processes.broadcast(file != nullptr ? file->temporary_path() : "");
  handle_ = std::make_unique<Handle>();
  // MPI waits forever unless all processes can open the file. See require_shared_directories.
  const int error =
      MPI_File_open(MPI_COMM_WORLD, path.c_str(), MPI_MODE_RDWR, MPI_INFO_NULL, &handle_->file);
  processes.all_or_throw([&] { require(error, "open", name_); });
  const bool is_one_machine = processes.machine(1).processes == processes.count();
  FileDescriptor local(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (is_one_machine && local.is_open() && local.is_in_local_file_system())
    handle_->local = std::move(local);
}

// The file is not closed here, as MPI_File_close is collective: after a failure the other processes
// would not call it.
SharedFile::~SharedFile() = default;

void SharedFile::write_at(std::span<const char> bytes, std::uint64_t offset) {
  if (!handle_) {
    file_->write_at(bytes, offset);
    return;
  }
  in_parts(bytes, offset, [&](std::span<const char> part, MPI_Offset at, MPI_Status* status) {
    require(MPI_File_write_at(handle_->file, at, part.data(), static_cast<int>(part.size()),
                              MPI_BYTE, status),
            "write", name_);
    if (!is_done(*status, part.size()))
      throw Error(formatted("cannot write {}{}: only part of it was written; is the disk full?",
                            name_, processes_.on_machine()));
  });
}

std::uint64_t SharedFile::copy_from(int scratch, const CopyRange& range) {
  if (!handle_) return file_->copy_from(scratch, range);
  if (!handle_->local.is_open()) return 0;
  try {
    return handle_->local.copy_from(scratch, range);
  } catch (const std::system_error& error) {
    throw Error(
        formatted("cannot write {}{}: {}", name_, processes_.on_machine(), error.code().message()));
  }
}

void SharedFile::read_at(std::span<char> bytes, std::uint64_t offset) {
  if (!handle_) {
    file_->read_at(bytes, offset);
    return;
  }
  in_parts(bytes, offset, [&](std::span<char> part, MPI_Offset at, MPI_Status* status) {
    require(MPI_File_read_at(handle_->file, at, part.data(), static_cast<int>(part.size()),
                             MPI_BYTE, status),
            "read back", name_);
    if (!is_done(*status, part.size()))
      throw Error(formatted("cannot read back {}{}: it is shorter than what was written", name_,
                            processes_.on_machine()));
  });
}

// MPI guarantees that other processes see the written bytes after a sync of the writer and one of
// the reader.
void SharedFile::sync() {
  if (!handle_) return;
  for (int i = 0; i < 2; ++i) {
    const int error = MPI_File_sync(handle_->file);
    processes_.all_or_throw([&] { require(error, "write", name_); });
  }
}

void SharedFile::close() {
  if (!handle_) return;
  const int error = MPI_File_close(&handle_->file);
  processes_.all_or_throw([&] { require(error, "write", name_); });
}

}  // namespace eses::detail
