#include "eses/measure_frames.hpp"

#include <atomic>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "api/arguments.hpp"
#include "run/plan.hpp"
#include "system/formatted.hpp"
#include "system/parallel.hpp"
#include "system/serial_check.hpp"

namespace eses {
namespace {

// Frames with more atoms are measured one after the other, each by all threads. This bounds the
// memory, and the time in which the first thread, which may be the only one that sees interrupts,
// waits for the others at the end.
constexpr std::size_t max_atoms_at_once = 20'000;

// Ends the measurement of a frame after a failure of another one, or of a callback.
struct Stopped {};

class FrameMeasurement {
 public:
  FrameMeasurement(std::span<const double> radii, const FrameReader& read,
                   const FrameReceiver& receive, const MeasureOptions& options,
                   const SurfaceOptions& surface)
      : radii_(radii),
        read_(read),
        receive_(receive),
        options_(options),
        surface_(surface),
        check_(options.check) {}

  // Frames start in ascending order, so that all frames before the first one with a fault are
  // measured.
  void run(std::size_t frame_count) {
    const int threads = detail::chosen_threads(options_.threads);
    const bool at_once =
        radii_.size() <= max_atoms_at_once && frame_count >= static_cast<std::size_t>(threads);
    detail::parallel_for(static_cast<std::int64_t>(frame_count), at_once ? threads : 1,
                         [&](std::int64_t frame, int) {
                           measure_frame(static_cast<std::size_t>(frame), at_once ? 1 : threads);
                         });
    if (callback_failure_) std::rethrow_exception(callback_failure_);
    if (failed_frame_ < frame_count) throw std::invalid_argument(failure_);
  }

 private:
  static constexpr std::size_t no_frame = std::numeric_limits<std::size_t>::max();

  // Whether the result of a frame is not needed any more.
  bool is_over(std::size_t frame) const { return is_stopped_ || frame > failed_frame_; }

  // Calls a callback. Its exception ends all frames, and `run` throws it on.
  template <class Callback>
  void call(Callback&& callback) {
    try {
      callback();
    } catch (...) {
      is_stopped_ = true;
      const std::lock_guard lock(mutex_);
      if (!callback_failure_) callback_failure_ = std::current_exception();
      throw Stopped();
    }
  }

  void measure_frame(std::size_t frame, int threads) {
    if (is_over(frame)) return;
    const CheckCallback check = [this, frame] {
      if (is_over(frame)) throw Stopped();
      call([this] { check_(); });
    };
    try {
      check();
      std::vector<Atom> atoms(radii_.size());
      for (std::size_t i = 0; i < atoms.size(); ++i) atoms[i].radius = radii_[i];
      call([&] { read_(frame, atoms); });
      const Surface surface(std::move(atoms), {.probe_radius = surface_.probe_radius,
                                               .max_filled_void = surface_.max_filled_void,
                                               .threads = threads,
                                               .check = check});
      MeasureOptions options = options_;
      options.threads = threads;
      options.check = check;
      Measures measures = measure(surface, options);
      call([&] { receive_(frame, std::move(measures)); });
    } catch (const Stopped&) {
    } catch (const std::invalid_argument& error) {
      fail(frame, error.what());
    } catch (...) {
      is_stopped_ = true;
      throw;
    }
  }

  void fail(std::size_t frame, const char* message) {
    const std::lock_guard lock(mutex_);
    if (frame >= failed_frame_) return;
    failed_frame_ = frame;
    failure_ = detail::formatted("frame {} (counted from 0): {}", frame, message);
  }

  std::span<const double> radii_;
  const FrameReader& read_;
  const FrameReceiver& receive_;
  const MeasureOptions& options_;
  const SurfaceOptions& surface_;
  detail::SerialCheck check_;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<std::size_t> failed_frame_ = no_frame;  // the first frame with a fault
  std::mutex mutex_;                                  // of both failures
  std::string failure_;                               // of the first frame with a fault
  std::exception_ptr callback_failure_;
};

}  // namespace

void measure_frames(std::size_t frame_count, std::span<const double> radii, const FrameReader& read,
                    const FrameReceiver& receive, const MeasureOptions& options,
                    const SurfaceOptions& surface) {
  detail::require_valid(options);
  detail::require_valid(detail::Parameters{.probe_radius = surface.probe_radius,
                                           .max_filled_void = surface.max_filled_void});
  if (!read || !receive)
    throw std::invalid_argument(
        "measure_frames needs a function that reads frames and one that receives "
        "measures");
  if (frame_count > static_cast<std::size_t>(std::numeric_limits<std::int64_t>::max()))
    throw std::invalid_argument(detail::formatted("{} frames are too many", frame_count));
  FrameMeasurement(radii, read, receive, options, surface).run(frame_count);
}

}  // namespace eses
