// Tests of measure_frames. Expected values are closed forms of spheres.

#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "catch.hpp"
#include "eses/measure_frames.hpp"

namespace eses::detail::test {
namespace {

constexpr double sas_radius = 3.1;  // angstrom
const std::vector<double> radii{1.7, 1.7};

double distance_in(std::size_t frame) { return 1 + 0.05 * static_cast<double>(frame); }

/// Two spheres at a distance that grows with the frame.
void read_pair(std::size_t frame, std::span<Atom> atoms) {
  atoms[0].center = {0, 0, 0};
  atoms[1].center = {0.6 * distance_in(frame), 0, 0.8 * distance_in(frame)};
}

/// The result of a failure: the message of std::invalid_argument.
std::string failure_of(std::size_t frames, const FrameReader& read,
                       const MeasureOptions& options = {}) {
  try {
    measure_frames(
        frames, radii, read, [](std::size_t, Measures&&) {}, options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no failure";
}

}  // namespace

TEST_CASE("frames are measured once each", "[measure]") {
  for (const int threads : {1, 2, 5})
    for (const std::size_t count : {1U, 3U, 60U}) {
      std::vector<double> areas(count);
      measure_frames(count, radii, read_pair,
                     [&areas](std::size_t frame, const Measures& measures) {
                       areas[frame] += measures.sas_area;
                     },
                     {.threads = threads});
      for (std::size_t frame = 0; frame < count; ++frame)
        CHECK(areas[frame] == Catch::Approx(4 * std::numbers::pi * sas_radius *
                                            (sas_radius + distance_in(frame) / 2)));
    }
}

TEST_CASE("the first frame with a fault is named", "[measure]") {
  const FrameReader read = [](std::size_t frame, std::span<Atom> atoms) {
    read_pair(frame, atoms);
    if (frame == 17 || frame >= 20) atoms[1].center.z = 1e9;
  };
  for (const int threads : {1, 2, 5})
    CHECK(failure_of(60, read, {.threads = threads}) ==
          "frame 17 (counted from 0): atom 1 (counted from 0) has z coordinate 1000000000; the "
          "limit is 1000000 angstrom");
}

TEST_CASE("exceptions of callbacks end the loop unchanged", "[measure]") {
  const FrameReader fail = [](std::size_t frame, std::span<Atom> atoms) {
    read_pair(frame, atoms);
    if (frame == 9) throw std::invalid_argument("callback");
  };
  for (const int threads : {1, 2}) {
    CHECK(failure_of(60, fail, {.threads = threads}) == "callback");
    int calls = 0;  // never from two threads at the same time
    const CheckCallback check = [&calls] {
      if (++calls == 20) throw std::invalid_argument("stop");
    };
    CHECK(failure_of(60, read_pair, {.threads = threads, .check = check}) == "stop");
  }
}

// Six atoms just hold a probe. With more room, its void is larger.
TEST_CASE("cavities of frames are filled", "[measure]") {
  constexpr double probe = 0.7;
  const std::vector<double> six(6, 1.0);
  const FrameReader read = [](std::size_t frame, std::span<Atom> atoms) {
    for (std::size_t k = 0; k < 6; ++k) {
      atoms[k].center = {};
      atoms[k].center[k / 2] =
          (k % 2 == 0 ? 1 : -1) * (1 + probe + 0.05 * static_cast<double>(frame));
    }
  };
  const double sphere = 4 * std::numbers::pi / 3 * probe * probe * probe;
  const auto volumes_of = [&](std::optional<double> max_void) {
    std::vector<double> volumes(2);
    measure_frames(2, six, read,
                   [&volumes](std::size_t frame, const Measures& measures) {
                     volumes[frame] = measures.ses_volume;
                   },
                   {.threads = 1}, {.probe_radius = probe, .max_filled_void = max_void});
    return volumes;
  };
  const auto open = volumes_of({}), first = volumes_of(1.01 * sphere), both = volumes_of(100);
  CHECK(first[0] - open[0] == Catch::Approx(sphere).epsilon(1e-6));
  CHECK(both[0] == first[0]);
  CHECK(first[1] == open[1]);
  CHECK(both[1] - open[1] > 1.01 * sphere);
}

TEST_CASE("options are checked before the first frame", "[measure]") {
  for (const std::size_t count : {0U, 1U}) {
    const auto ignore = [](std::size_t, const Measures&) {};
    CHECK_THROWS_AS(measure_frames(count, radii, read_pair, ignore, {}, {.max_filled_void = -1}),
                    std::invalid_argument);
    CHECK(failure_of(count, read_pair, {.probe_radius = -1}) ==
          "the probe radius must be 0 or between 0.01 and 1000 angstrom, and is -1");
    CHECK(failure_of(count, read_pair, {.threads = -1}) ==
          "the number of threads must not be negative, and is -1");
    CHECK(failure_of(count, read_pair, {.threads = 1 << 30}) ==
          "the number of threads must be at most 4096, and is 1073741824");
    CHECK_THROWS_AS(measure_frames(count, radii, {}, ignore), std::invalid_argument);
    CHECK_THROWS_AS(measure_frames(count, radii, read_pair, {}), std::invalid_argument);
  }
  CHECK_THROWS_AS(
      measure_frames(~std::size_t{0}, radii, read_pair, [](std::size_t, const Measures&) {}),
      std::invalid_argument);
}

}  // namespace eses::detail::test
