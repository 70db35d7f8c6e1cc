#include "services/common/process/channel_filter.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace luminav {
namespace {

/// A socket that filters what it sends to itself; on the loopback device all that is kept is there at once.
class FilteredSocket {
 public:
  explicit FilteredSocket(const std::vector<std::string>& channels) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address_), sizeof address_), 0);
    socklen_t size = sizeof address_;
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address_), &size), 0);
    std::vector<sock_filter> program = make_channel_filter(channels);
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter), 0);
  }
  FilteredSocket(const FilteredSocket&) = delete;
  FilteredSocket& operator=(const FilteredSocket&) = delete;
  ~FilteredSocket() { close(socket_); }

  /// The second datagram is always kept: what is read first tells what became of the first.
  bool keeps(const std::string& datagram) {
    const std::string fragment = "LC03 is never dropped";
    for (const std::string& bytes : {datagram, fragment}) {
      sendto(socket_, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&address_), sizeof address_);
    }
    const std::string first = read_one();
    if (first == fragment) {
      return false;
    }
    EXPECT_EQ(first, datagram);
    EXPECT_EQ(read_one(), fragment);
    return true;
  }

 private:
  std::string read_one() {
    std::array<char, 70'000> bytes;
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
    return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }

  int socket_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address_{};
};

/// As LCM 1.3.1 sends a message that fits a datagram.
std::string short_message(const std::string& channel, std::size_t size = 8) {
  return std::string("LC02") + std::string("\0\0\1\7", 4) + channel + '\0' + std::string(size, 'x');
}

TEST(ChannelFilter, KeepsMessagesOnItsChannelsAndNoOthers) {
  const std::vector<std::string> channels = {"STOP", "VELOCITY_COMMAND", "GOAL_X", "ABC", "A"};
  FilteredSocket socket(channels);
  for (const std::string& channel : channels) {
    EXPECT_TRUE(socket.keeps(short_message(channel))) << channel;
    EXPECT_TRUE(socket.keeps(short_message(channel, 60'000))) << channel;
    EXPECT_FALSE(socket.keeps(short_message(channel + "S"))) << "longer than " << channel;
    EXPECT_FALSE(socket.keeps(short_message("Z" + channel))) << "before " << channel;
  }
  for (const std::string other : {"STO", "VELOCITY_COMMANE", "VELOCITY_COMMENT", "GOAL_Y", "GOAL", "B", "stop"}) {
    EXPECT_FALSE(socket.keeps(short_message(other))) << other;
  }
}

TEST(ChannelFilter, KeepsWhatIsNotAShortMessage) {
  FilteredSocket socket({"STOP"});
  EXPECT_TRUE(socket.keeps(std::string("LC03") + short_message("OTHER").substr(4)));
  EXPECT_FALSE(socket.keeps(short_message("OTHER").substr(0, 10))) << "cut in the channel's name";
}

TEST(ChannelFilter, WithoutChannelsKeepsNoMessage) {
  FilteredSocket socket({});
  EXPECT_FALSE(socket.keeps(short_message("STOP")));
}

TEST(ChannelFilter, FindsNothingToFilterWhereThereIsNoSocket) {
  lcm::LCM lcm("memq://");
  EXPECT_FALSE(receive_only(lcm, "memq://", {"STOP"}));
}

}  // namespace
}  // namespace luminav
