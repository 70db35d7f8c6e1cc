// Preloaded into the processes of one host of a test (LD_PRELOAD), shifts their wall clock by as many microseconds as
// stand in the file $LUMINAV_CLOCK_SHIFT, an int64 that may change while they run. Monotonic clocks stay.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {

const volatile std::int64_t* open_shift() {
  const char* file = std::getenv("LUMINAV_CLOCK_SHIFT");
  const int descriptor = file != nullptr ? open(file, O_RDONLY | O_CLOEXEC) : -1;
  if (descriptor < 0) {
    return nullptr;
  }
  void* memory = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, descriptor, 0);
  close(descriptor);
  return memory != MAP_FAILED ? static_cast<const volatile std::int64_t*>(memory) : nullptr;
}

std::int64_t shift_us() {
  static const volatile std::int64_t* const shift = open_shift();
  return shift != nullptr ? *shift : 0;
}

}  // namespace

extern "C" int clock_gettime(clockid_t id, timespec* time) noexcept {
  const auto status = static_cast<int>(syscall(SYS_clock_gettime, id, time));
  if (status == 0 && (id == CLOCK_REALTIME || id == CLOCK_REALTIME_COARSE)) {
    const std::int64_t us = static_cast<std::int64_t>(time->tv_sec) * 1'000'000 + time->tv_nsec / 1000 + shift_us();
    time->tv_sec = us / 1'000'000;
    time->tv_nsec = (us % 1'000'000) * 1000 + time->tv_nsec % 1000;
  }
  return status;
}

extern "C" int gettimeofday(timeval* time, void*) noexcept {
  timespec now{};
  const int status = clock_gettime(CLOCK_REALTIME, &now);
  time->tv_sec = now.tv_sec;
  time->tv_usec = now.tv_nsec / 1000;
  return status;
}

extern "C" time_t time(time_t* result) noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  if (result != nullptr) {
    *result = now.tv_sec;
  }
  return now.tv_sec;
}
