#include "drivers/simulator/board_server.hpp"

#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "drivers/p3dx/arcos/arcos_commands.hpp"
#include "drivers/p3dx/arcos/arcos_packet.hpp"
#include "drivers/simulator/arcos/arcos_controller.hpp"
#include "tests/unit/p3dx/hex.hpp"

namespace luminav {
namespace {

using Bytes = std::vector<std::uint8_t>;

int port_of(const BoardServer& server) {
  return std::stoi(server.address().substr(server.address().rfind(':') + 1));
}

/// Lets the server work until the stream has `count` bytes, or is closed, or 5 s have passed.
Bytes exchange(BoardServer& server, ByteStream& stream, std::size_t count) {
  Bytes received;
  for (int i = 0; i < 500 && received.size() < count && stream.is_open(); ++i) {
    server.poll();
    std::array<std::uint8_t, 256> bytes;
    const std::size_t some = stream.read(bytes);
    received.insert(received.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(some));
    if (some == 0 && stream.is_open()) {
      pollfd readable{stream.descriptor(), POLLIN, 0};
      poll(&readable, 1, 10);
    }
  }
  return received;
}

/// Lets the server work until the condition holds; false after 5 s. A terminal hands bytes on in its own time.
template <typename Condition>
bool work_until(BoardServer& server, Condition condition) {
  for (int i = 0; i < 5000 && !condition(); ++i) {
    server.poll();
    poll(nullptr, 0, 1);
  }
  return condition();
}

void write_all(BoardServer& server, ByteStream& stream, const Bytes& bytes) {
  for (int i = 0; i < 500; ++i) {
    if (stream.write(bytes) == bytes.size()) {
      return;
    }
    server.poll();
    poll(nullptr, 0, 1);
  }
  FAIL() << "the connection does not take bytes";
}

const Bytes kSync0 = encode_packet(0);

void open_session(ByteStream& client) {
  for (const std::uint8_t sync : {packet_type::kSync0, packet_type::kSync1, packet_type::kSync2}) {
    client.write(encode_packet(sync));
  }
  client.write(encode_command(ArcosCommand::kOpen));
}

TEST(TcpBoardServer, AnswersAClient) {
  ArcosController controller({});
  const auto server = BoardServer::on_tcp(controller, 0);
  TcpStream client("127.0.0.1", port_of(*server));
  write_all(*server, client, kSync0);
  EXPECT_EQ(exchange(*server, client, kSync0.size()), kSync0);
  EXPECT_TRUE(server->has_client());
}

TEST(TcpBoardServer, RefusesASecondClient) {
  ArcosController controller({});
  const auto server = BoardServer::on_tcp(controller, 0);
  TcpStream first("127.0.0.1", port_of(*server));
  write_all(*server, first, kSync0);
  exchange(*server, first, kSync0.size());
  TcpStream second("127.0.0.1", port_of(*server));
  exchange(*server, second, 1);
  EXPECT_FALSE(second.is_open());
  write_all(*server, first, kSync0);
  EXPECT_EQ(exchange(*server, first, kSync0.size()), kSync0);  // and the first is not disturbed
}

TEST(TcpBoardServer, TakesTheNextClientOnTheSamePort) {
  ArcosController controller({});
  const auto server = BoardServer::on_tcp(controller, 0);
  for (int i = 0; i < 5; ++i) {
    TcpStream client("127.0.0.1", port_of(*server));
    write_all(*server, client, kSync0);
    EXPECT_EQ(exchange(*server, client, kSync0.size()), kSync0);
    client.close();
    EXPECT_TRUE(work_until(*server, [&] { return !server->has_client(); }));
  }
}

TEST(TcpBoardServer, ComesBackOnItsPortAtOnce) {
  ArcosController controller({});
  auto server = BoardServer::on_tcp(controller, 0);
  const int port = port_of(*server);
  TcpStream client("127.0.0.1", port);
  write_all(*server, client, kSync0);
  exchange(*server, client, kSync0.size());
  server.reset();
  EXPECT_NO_THROW(BoardServer::on_tcp(controller, port));
}

TEST(TcpBoardServer, SaysThatThePortIsTaken) {
  ArcosController controller({});
  const auto server = BoardServer::on_tcp(controller, 0);
  EXPECT_THROW(BoardServer::on_tcp(controller, port_of(*server)), std::runtime_error);
}

TEST(TcpBoardServer, LetsNobodyInWhileUnplugged) {
  ArcosController controller({});
  const auto server = BoardServer::on_tcp(controller, 0);
  TcpStream client("127.0.0.1", port_of(*server));
  write_all(*server, client, kSync0);
  exchange(*server, client, kSync0.size());
  server->set_unplugged(true);
  exchange(*server, client, 1);
  EXPECT_FALSE(client.is_open());
  TcpStream again("127.0.0.1", port_of(*server));
  exchange(*server, again, 1);
  EXPECT_FALSE(again.is_open());
  server->set_unplugged(false);
  TcpStream third("127.0.0.1", port_of(*server));
  write_all(*server, third, kSync0);
  EXPECT_EQ(exchange(*server, third, kSync0.size()), kSync0);
}

TEST(PtyBoardServer, AnswersAtItsRateOnly) {
  ArcosController controller({});
  const auto server = BoardServer::on_pty(controller);
  EXPECT_FALSE(server->has_client());
  SerialStream client(server->address(), 38400);
  EXPECT_TRUE(server->has_client());
  client.write(kSync0);
  pollfd arrived{server->descriptors().front(), POLLIN, 0};
  ASSERT_EQ(poll(&arrived, 1, 30'000), 1);
  server->poll();
  EXPECT_EQ(controller.baud(), 9600);
  std::array<std::uint8_t, 64> bytes;
  EXPECT_EQ(client.read(bytes), 0U);  // it could not understand
  client.set_baud(9600);
  client.write(kSync0);
  EXPECT_EQ(exchange(*server, client, kSync0.size()), kSync0);
}

TEST(PtyBoardServer, FollowsHostBaud) {
  ArcosController controller({});
  const auto server = BoardServer::on_pty(controller);
  SerialStream client(server->address(), 9600);
  open_session(client);
  const ConfigurationPacket flash;
  const std::size_t answers =
      2 * kSync0.size() + encode_identity({flash.name, flash.robot_class, flash.subclass}).size();
  EXPECT_EQ(exchange(*server, client, answers).size(), answers);
  client.write(encode_command(ArcosCommand::kHostBaud, 4));
  EXPECT_TRUE(work_until(*server, [&] { return controller.baud() == 115200; }));
  client.set_baud(115200);
  const Bytes question = encode_command(ArcosCommand::kConfiguration);
  client.write(question);
  const Bytes answer = exchange(*server, client, 100);
  ASSERT_GE(answer.size(), 4U);
  EXPECT_EQ(answer[0], 0xFA);
  EXPECT_EQ(answer[3], packet_type::kConfiguration);
}

TEST(PtyBoardServer, AnswersTheNextClientAtTheFirstRateAfterClose) {
  ArcosController controller({});
  const auto server = BoardServer::on_pty(controller);
  SerialStream client(server->address(), 9600);
  open_session(client);
  client.write(encode_command(ArcosCommand::kHostBaud, 2));
  ASSERT_TRUE(work_until(*server, [&] { return controller.baud() == 38400; }));
  client.set_baud(38400);
  client.write(encode_command(ArcosCommand::kClose));
  EXPECT_TRUE(work_until(*server, [&] { return controller.baud() == 9600; }));
}

TEST(PtyBoardServer, HearsTheLastWordsOfAClientThatHasLeft) {
  ArcosController controller({});
  const auto server = BoardServer::on_pty(controller);
  SerialStream client(server->address(), 9600);
  open_session(client);
  EXPECT_TRUE(work_until(*server, [&] { return controller.session_open(); }));
  client.write(encode_command(ArcosCommand::kClose));
  client.close();
  EXPECT_TRUE(work_until(*server, [&] { return !controller.session_open(); }));
}

TEST(PtyBoardServer, ReplacesALinkAndNothingElseOfItsName) {
  ArcosController controller({});
  const std::string name = testing::TempDir() + "board_server_test_file";
  std::filesystem::remove(name);
  std::filesystem::create_symlink("/dev/gone", name);
  EXPECT_EQ(BoardServer::on_pty(controller, name)->address(), name);
  EXPECT_FALSE(std::filesystem::is_symlink(name)) << "the link goes with its server";
  std::ofstream(name) << "somebody's work";
  try {
    BoardServer::on_pty(controller, name);
    ADD_FAILURE() << "a file of that name is in the way";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
  EXPECT_EQ(std::filesystem::file_size(name), 15U);
  std::filesystem::remove(name);
}

TEST(PtyBoardServer, LeavesTheLinkOfItsSuccessor) {
  ArcosController controller({});
  const std::string name = testing::TempDir() + "board_server_test_successor";
  auto first = BoardServer::on_pty(controller, name);
  const auto second = BoardServer::on_pty(controller, name);
  first.reset();
  EXPECT_TRUE(std::filesystem::is_symlink(name));
}

TEST(PtyBoardServer, TakesTheNextClient) {
  ArcosController controller({});
  const auto server = BoardServer::on_pty(controller, testing::TempDir() + "board_server_test_line");
  for (int i = 0; i < 3; ++i) {
    SerialStream client(server->address(), 9600);
    client.write(kSync0);
    EXPECT_EQ(exchange(*server, client, kSync0.size()), kSync0);
    client.close();
    EXPECT_FALSE(server->has_client());
    server->poll();
  }
}

}  // namespace
}  // namespace luminav
