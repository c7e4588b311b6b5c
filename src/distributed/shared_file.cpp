// The parts of a shared file that do not depend on MPI.
#include "distributed/shared_file.hpp"

namespace eses::detail {

std::uint64_t SharedFile::write_by_rank(std::uint64_t begin,
                                        const std::function<void(const TextSink& sink)>& make) {
  std::uint64_t bytes = 0;
  if (processes_.count() > 1) {
    make([&](std::string_view part) { bytes += part.size(); });
    begin += processes_.sum_before(bytes);
    bytes = 0;
  }
  make([&](std::string_view part) {
    write_at(part, begin + bytes);
    bytes += part.size();
  });
  return processes_.sum(bytes);
}

}  // namespace eses::detail
