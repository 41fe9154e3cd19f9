// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A camera of V4L2, /dev/video97, for programs that are started with this library in LD_PRELOAD:
// it answers the calls of the kernel's interface that OpenCV makes, as a driver would. Its frames
// have a size of up to 640 x 480 px and are those of simulated_v4l2.h.
//   SIMULATED_V4L2_LOSES=N      frame N is never delivered
//   SIMULATED_V4L2_UNPLUGGED=N  the camera is gone from frame N on
//   SIMULATED_V4L2_YUYV=1       grey frames in the format YUYV, of the first channel
#include "simulated_v4l2.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <vector>

namespace palpate::apps {
namespace {

constexpr const char* kDevice = "/dev/video97";
constexpr std::uint32_t kMostColumns = 640, kMostRows = 480, kMostBuffers = 8;
constexpr std::uint32_t kLeastRate = 10, kHighestRate = 60;
constexpr int kLeastExposure = 1, kMostExposure = 300;  // 100 us
constexpr long kNanosecondsPerSecond = 1000000000;

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// The number in an environment variable, or one that no frame has.
std::uint64_t frame_of(const char* variable) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? ~std::uint64_t{0} : std::strtoull(text, nullptr, 10);
}

int fail(int error) {
  errno = error;
  return -1;
}

/// The camera. A timer of the kernel stands for it, so that select() and poll() work: it can be
/// read when it is time for a frame.
class Camera {
 public:
  int open() {
    timer_ = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    return timer_;
  }
  [[nodiscard]] bool is(int file) const { return file >= 0 && file == timer_; }

  void* map(std::size_t length, long offset) {
    const auto index = static_cast<std::size_t>(offset / sysconf(_SC_PAGESIZE));
    void* const memory = next<void*(void*, std::size_t, int, int, int, long)>("mmap")(
        nullptr, length, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (index < buffers_.size()) buffers_[index] = static_cast<std::uint8_t*>(memory);
    return memory;
  }

  int control(unsigned long request, void* argument) {
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& capability = *static_cast<v4l2_capability*>(argument);
        capability.capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        return 0;
      }
      case VIDIOC_G_FMT:
        describe_format(*static_cast<v4l2_format*>(argument));
        return 0;
      case VIDIOC_S_FMT:
        return set_format(*static_cast<v4l2_format*>(argument));
      case VIDIOC_G_PARM:
      case VIDIOC_S_PARM:
        return set_rate(*static_cast<v4l2_streamparm*>(argument), request == VIDIOC_S_PARM);
      case VIDIOC_QUERYCTRL:
        return describe_control(*static_cast<v4l2_queryctrl*>(argument));
      case VIDIOC_G_CTRL:
      case VIDIOC_S_CTRL:
        return set_control(*static_cast<v4l2_control*>(argument), request == VIDIOC_S_CTRL);
      case VIDIOC_REQBUFS: {
        auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
        wanted.count = std::min(wanted.count, kMostBuffers);
        buffers_.assign(wanted.count, nullptr);
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = frame_bytes();
        buffer.m.offset = buffer.index * static_cast<std::uint32_t>(sysconf(_SC_PAGESIZE));
        return 0;
      }
      case VIDIOC_QBUF:
        queued_.push_back(static_cast<v4l2_buffer*>(argument)->index);
        return 0;
      case VIDIOC_DQBUF:
        return deliver(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        return run(true);
      case VIDIOC_STREAMOFF:
        return run(false);
      default:
        return fail(ENOTTY);
    }
  }

 private:
  [[nodiscard]] std::uint32_t pixel_bytes() const { return yuyv_ ? 2 : 3; }
  [[nodiscard]] std::uint32_t frame_bytes() const { return pixel_bytes() * columns_ * rows_; }

  void describe_format(v4l2_format& format) const {
    format.fmt.pix.width = columns_;
    format.fmt.pix.height = rows_;
    format.fmt.pix.pixelformat = yuyv_ ? V4L2_PIX_FMT_YUYV : V4L2_PIX_FMT_BGR24;
    format.fmt.pix.bytesperline = pixel_bytes() * columns_;
    format.fmt.pix.sizeimage = frame_bytes();
  }
  int set_format(v4l2_format& format) {
    if (running_) return fail(EBUSY);
    columns_ = std::clamp<std::uint32_t>(format.fmt.pix.width / 16 * 16, 16, kMostColumns);
    rows_ = std::clamp<std::uint32_t>(format.fmt.pix.height / 16 * 16, 16, kMostRows);
    describe_format(format);
    return 0;
  }
  int set_rate(v4l2_streamparm& parameters, bool set) {
    auto& interval = parameters.parm.capture.timeperframe;
    if (set && interval.numerator > 0)
      rate_ = std::clamp(interval.denominator / interval.numerator, kLeastRate, kHighestRate);
    interval = {1, rate_};
    return 0;
  }
  static int describe_control(v4l2_queryctrl& query) {
    if (query.id == V4L2_CID_EXPOSURE_AUTO) {
      query.maximum = V4L2_EXPOSURE_APERTURE_PRIORITY;
    } else if (query.id == V4L2_CID_EXPOSURE_ABSOLUTE) {
      query.minimum = kLeastExposure;
      query.maximum = kMostExposure;
    } else {
      return fail(EINVAL);
    }
    query.step = 1;
    return 0;
  }
  int set_control(v4l2_control& control, bool set) {
    int* const value = control.id == V4L2_CID_EXPOSURE_AUTO       ? &by_hand_
                       : control.id == V4L2_CID_EXPOSURE_ABSOLUTE ? &exposure_
                                                                  : nullptr;
    if (value == nullptr) return fail(EINVAL);
    if (set && value == &exposure_)
      control.value = std::clamp(control.value, kLeastExposure, kMostExposure);
    if (set) *value = control.value;
    control.value = *value;
    return 0;
  }
  int run(bool on) {
    running_ = on;
    const long interval = on ? kNanosecondsPerSecond / static_cast<long>(rate_) : 0;
    const itimerspec period = {{0, interval}, {0, interval}};
    if (!on) queued_.clear();
    return timerfd_settime(timer_, 0, &period, nullptr);
  }
  /// Frames that nobody fetches in time are lost, as with a driver whose buffers are full.
  int deliver(v4l2_buffer& buffer) {
    if (!running_ || queued_.empty()) return fail(EINVAL);
    std::uint64_t expired = 0;
    if (::read(timer_, &expired, sizeof expired) < 0) return fail(EAGAIN);
    number_ += expired;
    const std::uint64_t frame = number_ - 1;
    if (frame == frame_of("SIMULATED_V4L2_LOSES")) return fail(EAGAIN);
    if (frame >= frame_of("SIMULATED_V4L2_UNPLUGGED")) return fail(ENODEV);
    buffer.index = queued_.front();
    queued_.pop_front();
    std::uint8_t* value = buffers_[buffer.index];
    for (std::uint32_t row = 0; row < rows_; ++row) {
      for (std::uint32_t column = 0; column < columns_; ++column) {
        *value++ = simulated_value(frame, row, column, 0);
        if (yuyv_) {
          *value++ = 128;  // no colour
        } else {
          for (const std::uint32_t channel : {1U, 2U})
            *value++ = simulated_value(frame, row, column, channel);
        }
      }
    }
    buffer.bytesused = buffer.length = frame_bytes();
    const std::uint64_t microseconds = 1000000 * frame / rate_;
    buffer.timestamp = {static_cast<long>(microseconds / 1000000),
                        static_cast<long>(microseconds % 1000000)};
    buffer.sequence = static_cast<std::uint32_t>(frame);
    return 0;
  }

  int timer_ = -1;
  bool yuyv_ = std::getenv("SIMULATED_V4L2_YUYV") != nullptr;
  bool running_ = false;
  std::uint32_t columns_ = kMostColumns, rows_ = kMostRows, rate_ = 30;
  int by_hand_ = V4L2_EXPOSURE_APERTURE_PRIORITY, exposure_ = 100;
  std::vector<std::uint8_t*> buffers_;
  std::deque<std::uint32_t> queued_;
  std::uint64_t number_ = 0;
};

Camera& camera() {
  static Camera one;
  return one;
}

}  // namespace
}  // namespace palpate::apps

using palpate::apps::camera;
using palpate::apps::kDevice;
using palpate::apps::next;

extern "C" {

int open(const char* path, int flags, ...) {
  if (std::strcmp(path, kDevice) == 0) return camera().open();
  va_list more;
  va_start(more, flags);
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = creates ? va_arg(more, mode_t) : 0;
  va_end(more);
  return next<int(const char*, int, ...)>("open")(path, flags, mode);
}

// On systems where all files have 64-bit offsets, both are the same.
int open64(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const bool creates = (flags & O_CREAT) != 0 || (flags & O_TMPFILE) == O_TMPFILE;
  const mode_t mode = creates ? va_arg(more, mode_t) : 0;
  va_end(more);
  return open(path, flags, mode);
}

int access(const char* path, int mode) noexcept {
  if (std::strcmp(path, kDevice) == 0) return 0;
  return next<int(const char*, int)>("access")(path, mode);
}

int ioctl(int file, unsigned long request, ...) noexcept {
  va_list more;
  va_start(more, request);
  void* const argument = va_arg(more, void*);
  va_end(more);
  if (camera().is(file)) return camera().control(request, argument);
  return next<int(int, unsigned long, ...)>("ioctl")(file, request, argument);
}

void* mmap(void* address, std::size_t length, int protection, int flags, int file,
           long offset) noexcept {
  if (camera().is(file)) return camera().map(length, offset);
  return next<void*(void*, std::size_t, int, int, int, long)>("mmap")(address, length, protection,
                                                                      flags, file, offset);
}

void* mmap64(void* address, std::size_t length, int protection, int flags, int file,
             long offset) noexcept {
  return mmap(address, length, protection, flags, file, offset);
}

}  // extern "C"
