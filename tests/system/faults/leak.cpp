// Preloaded into a process (LD_PRELOAD), makes it leak 100 MB/s while the file $LUMINAV_LEAK exists.
#include <pthread.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace {

void* leak(void* file) {
  constexpr std::size_t kPiece = 5 << 20;
  for (;;) {
    usleep(50'000);
    if (access(static_cast<const char*>(file), F_OK) != 0) {
      continue;
    }
    if (void* lost = std::malloc(kPiece)) {
      std::memset(lost, 1, kPiece);
    }
  }
}

__attribute__((constructor)) void begin() {
  if (char* file = std::getenv("LUMINAV_LEAK")) {
    pthread_t thread{};
    pthread_create(&thread, nullptr, leak, file);
    pthread_detach(thread);
  }
}

}  // namespace
