#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "processes/mpi_errors.hpp"
#include "processes/shared_file.hpp"

namespace eses {

struct SharedFile::Handle {
  MPI_File file = MPI_FILE_NULL;
};

namespace {

void require(int error, const char* action, const std::string& name) {
  if (error != MPI_SUCCESS)
    throw Error(fmt::format("cannot {} {}: {}", action, name, mpi_error_text(error)));
}

}  // namespace

SharedFile::SharedFile(const Processes& processes, OutputFile* file, const std::string& path,
                       std::string name)
    : processes_(processes), file_(file), name_(std::move(name)) {
  if (processes.count() == 1) return;
  handle_ = std::make_unique<Handle>();
  // All must be able to, or MPI waits for ever: see require_shared_directory.
  const int error =
      MPI_File_open(MPI_COMM_WORLD, path.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &handle_->file);
  processes.agree([&] { require(error, "open", name_); });
}

// Not closed here: after a failure the other processes would not close theirs.
SharedFile::~SharedFile() = default;

void SharedFile::write_at(std::span<const char> bytes, std::uint64_t offset) {
  if (!handle_) {
    file_->write_at(bytes, offset);
    return;
  }
  constexpr std::size_t most = std::size_t{1} << 30;  // MPI counts in int
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(most, bytes.size()));
    MPI_Status status;
    require(MPI_File_write_at(handle_->file, static_cast<MPI_Offset>(offset), part.data(),
                              static_cast<int>(part.size()), MPI_BYTE, &status),
            "write", name_);
    int written = 0;
    MPI_Get_count(&status, MPI_BYTE, &written);
    if (written != static_cast<int>(part.size()))
      throw Error(fmt::format("cannot write {}{}: only part of it was written; is the disk full?",
                              name_, processes_.place()));
    bytes = bytes.subspan(part.size());
    offset += part.size();
  }
}

void SharedFile::close() {
  if (!handle_) return;
  const int error = MPI_File_close(&handle_->file);
  processes_.agree([&] { require(error, "write", name_); });
}

}  // namespace eses
