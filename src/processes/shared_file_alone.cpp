#include <utility>

#include "processes/shared_file.hpp"

namespace eses {

struct SharedFile::Handle {};

SharedFile::SharedFile(const Processes& processes, OutputFile* file, const std::string&,
                       std::string name)
    : processes_(processes), file_(file), name_(std::move(name)) {}

SharedFile::~SharedFile() = default;

void SharedFile::write_at(std::span<const char> bytes, std::uint64_t offset) {
  file_->write_at(bytes, offset);
}

void SharedFile::close() {}

}  // namespace eses
