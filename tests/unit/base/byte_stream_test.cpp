#include "drivers/base/line/byte_stream.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grp.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <stdexcept>

namespace luminav {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

Bytes read_some(ByteStream& stream) {
  std::array<std::uint8_t, 256> bytes;
  const std::size_t count = stream.read(bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count)};
}

/// Waits (for at most 5 s) until a descriptor can be read.
void await(int descriptor) {
  pollfd readable{descriptor, POLLIN, 0};
  ASSERT_EQ(poll(&readable, 1, 5000), 1);
}

TEST(MemoryPipe, CarriesBytesBothWays) {
  MemoryPipe pipe;
  const auto driver = pipe.open_driver_end();
  const auto robot = pipe.open_robot_end();
  EXPECT_EQ(driver->write(Bytes{1, 2, 3}), 3U);
  EXPECT_THAT(read_some(*robot), testing::ElementsAre(1, 2, 3));
  robot->write(Bytes{4});
  EXPECT_THAT(read_some(*driver), testing::ElementsAre(4));
  EXPECT_TRUE(read_some(*driver).empty());
}

TEST(MemoryPipe, ClosesBothEndsWhenUnpluggedAndOpensAgain) {
  MemoryPipe pipe;
  auto driver = pipe.open_driver_end();
  const auto robot = pipe.open_robot_end();
  robot->write(Bytes{1});
  pipe.unplug();
  EXPECT_FALSE(driver->is_open());
  EXPECT_FALSE(robot->is_open());
  EXPECT_EQ(driver->write(Bytes{1}), 0U);
  EXPECT_THROW(pipe.open_driver_end(), std::runtime_error);
  pipe.plug_in();
  EXPECT_FALSE(driver->is_open());  // an opening from before stays closed
  driver = pipe.open_driver_end();
  EXPECT_TRUE(driver->is_open());
  EXPECT_TRUE(read_some(*driver).empty());
}

TEST(MemoryPipe, LeavesTheLineToTheNewestOpening) {
  MemoryPipe pipe;
  const auto first = pipe.open_driver_end();
  const auto second = pipe.open_driver_end();
  EXPECT_FALSE(first->is_open());
  EXPECT_TRUE(second->is_open());
}

TEST(StreamOpener, RefusesWhatIsNoDevice) {
  for (const char* device :
       {"", "tcp:", "tcp:8101", "tcp:host:", "tcp:host:0", "tcp:host:70000", "tcp:host:12x", "ttyUSB0", "tcp::8101"}) {
    EXPECT_THROW(stream_opener(device, 9600), std::invalid_argument) << device;
  }
  EXPECT_THAT(error_of([] { stream_opener("/tmp", 9600); }), HasSubstr("is a directory, not a serial device"));
  EXPECT_THAT(error_of([] { stream_opener("/etc/passwd", 9600); }), HasSubstr("is a file, not a serial device"));
  EXPECT_NO_THROW(stream_opener("tcp:127.0.0.1:8101", 9600));
  EXPECT_NO_THROW(stream_opener("/dev/ttyUSB0", 9600));
}

TEST(SerialStream, SaysWhyADeviceCannotBeOpened) {
  EXPECT_THAT(error_of([] { SerialStream("/dev/does-not-exist", 9600); }), HasSubstr("No such file"));
  EXPECT_THAT(error_of([] { SerialStream("/tmp", 9600); }), HasSubstr("directory"));
  EXPECT_THAT(error_of([] { SerialStream("/dev/null", 9600); }), HasSubstr("not a serial device"));
}

/// A pseudo terminal: the device that a SerialStream opens, and the side of the robot.
struct Terminal {
  Terminal() : master(posix_openpt(O_RDWR | O_NOCTTY)) {
    const char* given = master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0 ? ptsname(master) : nullptr;
    if (given == nullptr) {
      throw std::runtime_error("no pseudo terminal can be made: is /dev/pts mounted?");
    }
    name = given;
  }
  ~Terminal() { hang_up(); }
  void hang_up() {
    if (master >= 0) {
      close(master);
      master = -1;
    }
  }
  int master;
  std::string name;
};

/// Asks in a process of its own, which gives up the rights of root if it has them.
template <typename Question>
bool holds_for_an_ordinary_user(const Question& question) {
  const pid_t somebody = fork();
  if (somebody == 0) {
    constexpr uid_t kNobody = 65534;
    const bool could_be_root = geteuid() == 0 && (setgroups(0, nullptr) != 0 || setuid(kNobody) != 0);
    _exit(!could_be_root && question() ? 0 : 1);
  }
  int status = 0;
  waitpid(somebody, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(SerialStream, NamesTheGroupThatMayOpenTheDevice) {
  const Terminal terminal;
  const std::string& device = terminal.name;
  ASSERT_EQ(chmod(device.c_str(), 0), 0);
  EXPECT_TRUE(holds_for_an_ordinary_user([&] {
    const std::string why = error_of([&] { SerialStream(device, 9600); });
    return why.find(device + ": permission denied; it belongs to the group \"") == 0 &&
           why.find("sudo usermod -aG ") != std::string::npos;
  }));
}

TEST(SerialStream, PassesEveryByteUnchanged) {
  Terminal terminal;
  SerialStream stream(terminal.name, 38400);
  EXPECT_EQ(stream.baud(), 38400);
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i] = static_cast<std::uint8_t>(i);
  }
  ASSERT_EQ(stream.write(all), all.size());
  Bytes received(all.size());
  std::size_t count = 0;
  while (count < all.size()) {
    const ssize_t some = read(terminal.master, received.data() + count, all.size() - count);
    ASSERT_GT(some, 0);
    count += static_cast<std::size_t>(some);
  }
  EXPECT_EQ(received, all);
  ASSERT_EQ(write(terminal.master, all.data(), all.size()), 256);
  await(stream.descriptor());
  EXPECT_EQ(read_some(stream), all);
}

TEST(SerialStream, IsSilentWithoutBeingClosed) {
  Terminal terminal;
  SerialStream stream(terminal.name, 9600);
  EXPECT_TRUE(read_some(stream).empty());
  EXPECT_TRUE(stream.is_open());
}

TEST(SerialStream, RefusesALineThatSomebodyStillHolds) {
  Terminal terminal;
  auto first = std::make_unique<SerialStream>(terminal.name, 9600);
  const int copy = dup(first->descriptor());  // as a guardian has one
  const auto open_again = [&] { SerialStream(terminal.name, 9600); };
  const auto refused = HasSubstr("is used by another program");
  EXPECT_THAT(error_of(open_again), refused);
  first.reset();
  EXPECT_THAT(error_of(open_again), refused);
  close(copy);
  EXPECT_EQ(error_of(open_again), "");
}

TEST(SerialStream, IsOpenedAgainByAnOrdinaryUserWhileTheOtherEndStays) {
  const Terminal terminal;
  ASSERT_EQ(chmod(terminal.name.c_str(), 0666), 0);
  EXPECT_TRUE(holds_for_an_ordinary_user([&] {
    const auto open_once = [&] { SerialStream(terminal.name, 9600); };
    return error_of(open_once).empty() && error_of(open_once).empty();
  }));
}

TEST(SerialStream, SetsTheRateOfTheLine) {
  Terminal terminal;
  SerialStream stream(terminal.name, 9600);
  ASSERT_TRUE(stream.set_baud(115200));
  termios settings{};
  ASSERT_EQ(tcgetattr(terminal.master, &settings), 0);
  EXPECT_EQ(cfgetospeed(&settings), static_cast<speed_t>(B115200));
}

TEST(SerialStream, ClosesWhenUnplugged) {
  Terminal terminal;
  SerialStream stream(terminal.name, 9600);
  terminal.hang_up();
  EXPECT_TRUE(read_some(stream).empty());
  EXPECT_FALSE(stream.is_open());
  EXPECT_NE(stream.failure(), "");
  EXPECT_EQ(stream.descriptor(), -1);
}

/// A listening socket on a port of the system's choice.
struct Listener {
  Listener() : socket(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    bind(socket, reinterpret_cast<sockaddr*>(&address), size);
    listen(socket, 1);
    getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
  }
  ~Listener() { close(socket); }
  int socket;
  int port = 0;
};

TEST(TcpStream, ConnectsWhileItIsUsed) {
  Listener listener;
  TcpStream client("localhost", listener.port);
  const int accepted = accept(listener.socket, nullptr, nullptr);
  ASSERT_GE(accepted, 0);
  pollfd writable{client.descriptor(), POLLOUT, 0};
  ASSERT_EQ(poll(&writable, 1, 5000), 1);
  EXPECT_EQ(client.write(Bytes{7, 8}), 2U);
  TcpStream server(accepted);
  await(server.descriptor());
  EXPECT_THAT(read_some(server), testing::ElementsAre(7, 8));
  server.close();
  await(client.descriptor());
  EXPECT_TRUE(read_some(client).empty());
  EXPECT_FALSE(client.is_open());
}

TEST(TcpStream, EndsTheConnectionForEveryHolderOfACopy) {
  Listener listener;
  TcpStream client("127.0.0.1", listener.port);
  const int accepted = accept(listener.socket, nullptr, nullptr);
  const int copy = dup(client.descriptor());
  client.close();
  await(accepted);
  char byte = 0;
  EXPECT_EQ(read(accepted, &byte, 1), 0);
  close(copy);
  close(accepted);
}

TEST(TcpStream, SaysThatNobodyListens) {
  int port = 0;
  {
    const Listener listener;
    port = listener.port;
  }
  std::string why = error_of([&] {
    TcpStream client("127.0.0.1", port);
    pollfd writable{client.descriptor(), POLLOUT, 0};
    poll(&writable, 1, 5000);
    read_some(client);
    throw std::runtime_error(client.failure());
  });
  EXPECT_THAT(why, HasSubstr("refused"));
}

TEST(TcpStream, TakesPartOfWhatDoesNotFit) {
  Listener listener;
  TcpStream client("127.0.0.1", listener.port);
  const int accepted = accept(listener.socket, nullptr, nullptr);
  pollfd writable{client.descriptor(), POLLOUT, 0};
  ASSERT_EQ(poll(&writable, 1, 5000), 1);
  const Bytes much(1 << 20, 1);
  std::size_t total = 0;
  std::size_t last = 1;
  while (last > 0 && total < (64U << 20)) {
    last = client.write(much);
    total += last;
  }
  EXPECT_EQ(last, 0U);  // full, and it did not wait
  EXPECT_TRUE(client.is_open());
  close(accepted);
}

}  // namespace
}  // namespace luminav
