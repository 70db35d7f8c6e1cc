#include "services/common/process/channel_filter.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace luminav {
namespace {

/// A socket that filters what it sends to itself; on the loopback device all that is kept is there at once.
class FilteredSocket {
 public:
  explicit FilteredSocket(const std::optional<std::vector<std::string>>& channels,
                          const LcmNetwork& network = "udpm://239.255.76.67:7667?ttl=1") {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(bind(socket_, reinterpret_cast<sockaddr*>(&address_), sizeof address_), 0);
    socklen_t size = sizeof address_;
    EXPECT_EQ(getsockname(socket_, reinterpret_cast<sockaddr*>(&address_), &size), 0);
    std::vector<sock_filter> program = make_socket_filter(network, channels);
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    EXPECT_EQ(setsockopt(socket_, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter), 0);
  }
  FilteredSocket(const FilteredSocket&) = delete;
  FilteredSocket& operator=(const FilteredSocket&) = delete;
  ~FilteredSocket() { close(socket_); }

  bool keeps(const std::string& datagram) {
    sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&address_), sizeof address_);
    std::array<char, 70'000> bytes;
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    const bool kept = count >= 0;
    EXPECT_TRUE(!kept || datagram == std::string(bytes.data(), static_cast<std::size_t>(count)));
    return kept;
  }

 private:
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

TEST(ChannelFilter, DropsFragmentsAndWhatIsNoMessage) {
  for (const auto& channels :
       {std::optional<std::vector<std::string>>{{"STOP"}}, std::optional<std::vector<std::string>>{}}) {
    FilteredSocket socket(channels);
    EXPECT_TRUE(socket.keeps(short_message("STOP")));
    EXPECT_FALSE(socket.keeps(std::string("LC03") + short_message("STOP").substr(4)));
    EXPECT_FALSE(socket.keeps("LC0"));
    EXPECT_FALSE(socket.keeps(""));
  }
  FilteredSocket socket({{"STOP"}});
  EXPECT_FALSE(socket.keeps(short_message("OTHER").substr(0, 10))) << "cut in the channel's name";
}

TEST(ChannelFilter, KeepsAllChannelsWhereNoneIsNamed) {
  FilteredSocket socket(std::nullopt);
  EXPECT_TRUE(socket.keeps(short_message("STOP")));
  EXPECT_TRUE(socket.keeps(short_message("ANYTHING")));
}

TEST(ChannelFilter, HearsItsOwnMachineWhoeverElseMaySpeak) {
  for (const LcmNetwork& network :
       {LcmNetwork("udpm://239.255.76.67:7667?ttl=0"), LcmNetwork("udpm://239.255.76.67:7667"),
        LcmNetwork("udpm://239.255.76.67:7667?ttl=1", {0x0A4D0001, 0x0A4D0002})}) {
    FilteredSocket socket(std::nullopt, network);
    EXPECT_TRUE(socket.keeps(short_message("STOP"))) << network.url;
    FilteredSocket picky({{"STOP", "GOAL"}}, network);
    EXPECT_TRUE(picky.keeps(short_message("GOAL"))) << network.url;
    EXPECT_FALSE(picky.keeps(short_message("GOALS"))) << network.url;
  }
}

TEST(ChannelFilter, WithoutChannelsKeepsNoMessage) {
  FilteredSocket socket(std::vector<std::string>{});
  EXPECT_FALSE(socket.keeps(short_message("STOP")));
}

TEST(MulticastAddress, IsReadAsLcmReadsIt) {
  const auto address = multicast_address("udpm://239.255.76.68:7700?recv_buf_size=9&ttl=1");
  ASSERT_TRUE(address.has_value());
  EXPECT_EQ(address->group, inet_addr("239.255.76.68"));
  EXPECT_EQ(address->port, 7700);
  EXPECT_EQ(address->ttl, 1);
  EXPECT_EQ(multicast_address("udpm://239.255.76.67:7667")->ttl, 0) << "LCM's own default";
  EXPECT_EQ(multicast_address("udpm://239.255.76.67:7667?ttl=much")->ttl, 0);
  EXPECT_EQ(multicast_address("udpm://")->port, 7667);
  for (const char* url :
       {"memq://", "file://log.lcm", "udpm://239.255.76.67:0", "udpm://239.255.76.67:70000", "udpm://robot:7667"}) {
    EXPECT_FALSE(multicast_address(url).has_value()) << url;
  }
}

TEST(ChannelFilter, FindsNothingToFilterWhereThereIsNoSocket) {
  lcm::LCM lcm("memq://");
  EXPECT_FALSE(receive_only(lcm, "memq://", {"STOP"}));
}

}  // namespace
}  // namespace luminav
