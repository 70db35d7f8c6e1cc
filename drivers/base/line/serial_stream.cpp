#include <fcntl.h>
#include <grp.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "drivers/base/line/byte_stream.hpp"

namespace luminav {
namespace {

speed_t speed_of(int baud) {
  switch (baud) {
    case 9600:
      return B9600;
    case 19200:
      return B19200;
    case 38400:
      return B38400;
    case 57600:
      return B57600;
    case 115200:
      return B115200;
    default:
      throw std::runtime_error("baud = " + std::to_string(baud) + ": must be 9600, 19200, 38400, 57600 or 115200");
  }
}

/// Says which group owns the device: that is the one to join.
std::string permission_advice(const std::string& device) {
  struct stat status {};
  if (stat(device.c_str(), &status) != 0) {
    return device + ": permission denied";
  }
  const group* owner = getgrgid(status.st_gid);
  const std::string name = owner != nullptr ? owner->gr_name : std::to_string(status.st_gid);
  return device + ": permission denied; it belongs to the group \"" + name + "\": `sudo usermod -aG " + name +
         " $USER`, then log in again";
}

int open_device(const std::string& device) {
  const int descriptor = open(device.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    throw std::runtime_error(errno == EACCES ? permission_advice(device) : device + ": " + std::strerror(errno));
  }
  if (isatty(descriptor) == 0) {
    close(descriptor);
    throw std::runtime_error(device + ": is not a serial device");
  }
  // Two programs that read one line steal each other's bytes. TIOCEXCL does not keep root out; a lock does, and it is
  // shared by all copies of the descriptor: the guardian of a driver that died keeps the next driver waiting.
  if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    close(descriptor);
    throw std::runtime_error(device + ": is used by another program");
  }
  return descriptor;
}

bool is_pseudo_terminal(int descriptor) {
  constexpr unsigned kFirst = 136;  // majors in the kernel's list of devices
  constexpr unsigned kLast = 143;
  struct stat status {};
  return fstat(descriptor, &status) == 0 && major(status.st_rdev) >= kFirst && major(status.st_rdev) <= kLast;
}

/// Keeps out programs that ask for no lock. A pseudo terminal would stay closed to all but root until its other end is
/// closed, too: a driver that was started again could not open it.
bool keep_others_out(int descriptor) {
  return is_pseudo_terminal(descriptor) || ioctl(descriptor, TIOCEXCL) == 0;
}

}  // namespace

SerialStream::SerialStream(const std::string& device, int baud) : DescriptorStream(open_device(device)) {
  speed_of(baud);
  if (!keep_others_out(descriptor()) || !set_baud(baud)) {
    throw std::runtime_error(device + ": cannot be set to " + std::to_string(baud) + " baud: " + std::strerror(errno));
  }
}

bool SerialStream::set_baud(int bits_per_second) {
  termios settings{};
  if (!is_open() || tcgetattr(descriptor(), &settings) != 0) {
    return false;
  }
  cfmakeraw(&settings);
  settings.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | PARENB | CRTSCTS | CSIZE);
  settings.c_cflag |= CS8 | CLOCAL | CREAD;
  settings.c_cc[VMIN] = 1;  // with 0 an idle line would read as an end of file
  settings.c_cc[VTIME] = 0;
  const speed_t speed = speed_of(bits_per_second);
  cfsetispeed(&settings, speed);
  cfsetospeed(&settings, speed);
  if (tcsetattr(descriptor(), TCSANOW, &settings) != 0) {
    return false;
  }
  tcflush(descriptor(), TCIFLUSH);
  baud_ = bits_per_second;
  return true;
}

}  // namespace luminav
