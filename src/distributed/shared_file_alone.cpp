#include "distributed/shared_file.hpp"

namespace eses::detail {

struct SharedFile::Handle {};

SharedFile::SharedFile(const Processes& processes, OutputFile* file)
    : processes_(processes), file_(file) {}

SharedFile::~SharedFile() = default;

void SharedFile::write_at(std::span<const char> bytes, std::uint64_t offset) {
  file_->write_at(bytes, offset);
}

std::uint64_t SharedFile::copy_from(int scratch, const CopyRange& range) {
  return file_->copy_from(scratch, range);
}

void SharedFile::read_at(std::span<char> bytes, std::uint64_t offset) {
  file_->read_at(bytes, offset);
}

void SharedFile::sync() {}

void SharedFile::close() {}

}  // namespace eses::detail
