// Prints where the robot is, as often as it says so: x and y [m], heading [rad], "?" while it is not sure.
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <luminav/pose_t.hpp>

struct Printer {
  void on_pose(const lcm::ReceiveBuffer*, const std::string&, const luminav::pose_t* pose) {
    const bool is_sure = pose->state == luminav::pose_t::STATE_TRACKING;
    std::printf("%.3f %.3f %.4f%s\n", pose->x, pose->y, pose->theta, is_sure ? "" : " ?");
    std::fflush(stdout);
  }
};

int main(int argc, char** argv) {
  lcm::LCM lcm(argc > 1 ? argv[1] : "udpm://239.255.76.67:7667?ttl=0");  // the robot's $LUMINAV_LCM_URL
  if (!lcm.good()) {
    return 1;
  }
  Printer printer;
  lcm.subscribe("POSE", &Printer::on_pose, &printer);
  while (lcm.handle() == 0) {
  }
}
