// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/recording.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "capture/recording_queue.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

using Clock = std::chrono::steady_clock;

/// Longest wait for a camera before `go_on` is asked.
constexpr std::chrono::milliseconds kLook{50};

/// Frames that are not taken are lost, but decoding can wait: its threads get less of a busy
/// processor. [steps of nice]
constexpr int kDecodersNice = 10;

/// Lowers the priority of this thread, if that is possible.
void step_back() {
  static_cast<void>(::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kDecodersNice));
}

double seconds_since(Clock::time_point time) {
  return std::chrono::duration<double>(Clock::now() - time).count();
}

std::string silence_of(const LiveCamera& camera, double seconds) {
  return fmt::format(
      "{}: sent no frame for {:g} s; check its cable, its trigger (it must run freely) and, for "
      "GigE, the size of its packets",
      camera.state().name, seconds);
}

/// Threads that do one thing with frames until there are no more.
class Workers {
 public:
  Workers(RecordingQueue& queue) : queue_(queue) {}
  ~Workers() { join(); }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  template <typename Loop>
  void start(int count, const Loop& loop) {
    for (int i = 0; i < count; ++i) {
      threads_.emplace_back([this, loop] {
        try {
          loop();
        } catch (...) {
          const std::lock_guard lock(mutex_);
          if (!failure_) failure_ = std::current_exception();
          failed_ = true;
          queue_.abort();
        }
      });
    }
  }
  [[nodiscard]] bool failed() const { return failed_; }
  void join() {
    queue_.close();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }
  /// \throws the first exception of the threads.
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  RecordingQueue& queue_;
  std::mutex mutex_;
  std::exception_ptr failure_;
  std::atomic<bool> failed_ = false;
  std::vector<std::thread> threads_;
};

/// Takes frames from the camera until the recording ends.
class Taker {
 public:
  Taker(LiveCamera& camera, const RecordingOptions& options, const RecordingWork& work,
        RecordingQueue& queue)
      : camera_(camera), options_(options), work_(work), queue_(queue) {}

  /// \param failed returns true if a thread that works on the frames has failed.
  void run(const std::function<bool()>& failed, Recording& recording) {
    Clock::time_point heard = Clock::now();
    while (!failed() && go_on(recording)) {
      const std::optional<CameraFrame> frame = camera_.next(kLook);
      if (frame) {
        heard = Clock::now();
        if (options_.seconds && frame->time >= *options_.seconds) return;
        add(*frame, recording);
        if (options_.frames && recording.frames >= *options_.frames) return;
      } else if (seconds_since(heard) > options_.patience) {
        recording.broken_off = silence_of(camera_, options_.patience);
        return;
      }
    }
  }

 private:
  bool go_on(const Recording& recording) const {
    return !work_.go_on || work_.go_on(recording.frames, count_lost(recording.lost));
  }

  void add(const CameraFrame& frame, Recording& recording) {
    if (frame.number > expected_) lose(expected_, frame.number - expected_, false, recording.lost);
    expected_ = frame.number + 1;
    recording.seconds = frame.time;
    const RecordedFrame recorded{.image = frame.image,
                                 .number = frame.number,
                                 .time = frame.time,
                                 .index = recording.frames,
                                 .arrival = Clock::now()};
    if (queue_.put(recorded))
      ++recording.frames;
    else
      lose(frame.number, 1, true, recording.lost);
  }

  static void lose(std::uint64_t first, std::uint64_t count, bool by_memory,
                   std::vector<LostFrames>& lost) {
    if (!lost.empty() && lost.back().by_memory == by_memory &&
        lost.back().first + lost.back().count == first)
      lost.back().count += count;
    else
      lost.push_back({.first = first, .count = count, .by_memory = by_memory});
  }

  LiveCamera& camera_;
  const RecordingOptions& options_;
  const RecordingWork& work_;
  RecordingQueue& queue_;
  std::uint64_t expected_ = 0;  ///< number of the next frame
};

}  // namespace

std::uint64_t count_lost(const std::vector<LostFrames>& lost) {
  std::uint64_t count = 0;
  for (const LostFrames& frames : lost) count += frames.count;
  return count;
}

Recording record(LiveCamera& camera, const RecordingOptions& options, const RecordingWork& work) {
  if (options.frames && *options.frames == 0)
    throw InvalidInput("RecordingOptions::frames is 0; it must be >= 1");
  require("RecordingOptions::seconds", options.seconds, above(0), "s");
  require("RecordingOptions::patience", options.patience, above(0).finite(), "s");
  require("RecordingOptions::writers", options.writers, at_least(1));
  require("RecordingOptions::decoders", options.decoders, at_least(0));
  RecordingQueue queue(options.memory, options.decoders > 0);
  Workers workers(queue);
  workers.start(options.writers, [&] {
    while (const auto frame = queue.take_to_write()) {
      work.write(*frame);
      queue.written(*frame);
    }
  });
  workers.start(options.decoders, [&] {
    step_back();
    while (const auto frame = queue.take_to_decode()) work.decode(*frame);
  });
  Recording recording;
  try {
    camera.start();
    Taker(camera, options, work, queue).run([&] { return workers.failed(); }, recording);
  } catch (const DeviceError& error) {
    recording.broken_off = error.what();
  }
  workers.join();
  workers.rethrow();
  recording.skipped = queue.skipped();
  recording.most_waiting = queue.most_waiting();
  return recording;
}

CameraFrame take_fresh(LiveCamera& camera, double patience) {
  while (camera.next(std::chrono::milliseconds(0))) {
  }
  static_cast<void>(take_next(camera, patience));
  return take_next(camera, patience);
}

CameraFrame take_next(LiveCamera& camera, double patience) {
  const Clock::time_point begin = Clock::now();
  while (seconds_since(begin) <= patience) {
    if (std::optional<CameraFrame> frame = camera.next(kLook)) return std::move(*frame);
  }
  throw DeviceError(silence_of(camera, patience));
}

}  // namespace palpate::sensing
