#pragma once

namespace luminav::launcher {

/// A small process beside the deputy that ends the deputy's children should the deputy die without doing so: it holds
/// the reading end of a pipe, and the pipe closes with the deputy, however that ends. To be made before any thread is.
class OrphanGuard {
 public:
  OrphanGuard();
  ~OrphanGuard();
  OrphanGuard(const OrphanGuard&) = delete;
  OrphanGuard& operator=(const OrphanGuard&) = delete;

  void watch(int process_group);
  void forget(int process_group);
  [[nodiscard]] int pid() const { return pid_; }

 private:
  void send(int process_group, bool add);
  int pipe_ = -1;
  int pid_ = -1;
};

}  // namespace luminav::launcher
