#include "services/viewer/http/http_request.hpp"

#include <gtest/gtest.h>

#include <random>

namespace luminav {
namespace {

const std::string kPost =
    "POST /api/stop?x=1 HTTP/1.1\r\nHost: robot:8080\r\nContent-LENGTH:  16\r\nX-Mine:\tb \r\n\r\n{\"engaged\":true}";

int status_of(const std::string& bytes) {
  try {
    return read_http_head(bytes) ? 200 : 0;
  } catch (const HttpError& error) {
    return error.status();
  }
}

std::string with_header(const std::string& header) {
  return "POST / HTTP/1.1\r\nHost: a\r\n" + header + "\r\n\r\n";
}

TEST(HttpRequest, ReadsTheHeadAndSaysWhatFollows) {
  const auto head = read_http_head(kPost);
  ASSERT_TRUE(head);
  EXPECT_EQ(head->request.method, "POST");
  EXPECT_EQ(head->request.path, "/api/stop");
  EXPECT_EQ(head->request.query, "x=1");
  EXPECT_EQ(head->request.header("host"), "robot:8080");
  EXPECT_EQ(head->request.header("x-mine"), "b");
  EXPECT_EQ(head->request.header("absent"), "");
  EXPECT_EQ(head->body_size, 16U);
  EXPECT_EQ(head->size + head->body_size, kPost.size());
  EXPECT_TRUE(head->request.keeps_alive);
}

TEST(HttpRequest, WaitsForTheEndOfTheHead) {
  const std::size_t end = kPost.find("\r\n\r\n") + 4;
  for (std::size_t size = 0; size < end; ++size) {
    EXPECT_FALSE(read_http_head(std::string_view(kPost).substr(0, size))) << size;
  }
  EXPECT_TRUE(read_http_head(std::string_view(kPost).substr(0, end)));
}

TEST(HttpRequest, RefusesAHeadWithoutAnEnd) {
  EXPECT_EQ(status_of("GET /" + std::string(kLargestHead, 'a')), 431);
  std::string headers = "GET / HTTP/1.1\r\n";
  while (headers.size() < kLargestHead) {
    headers += "X: y\r\n";
  }
  EXPECT_EQ(status_of(headers), 431);
}

TEST(HttpRequest, RefusesABodyWhoseSizeIsNotKnownBeforeItIsRead) {
  EXPECT_EQ(status_of(with_header("Transfer-Encoding: chunked")), 415);
  EXPECT_EQ(status_of(with_header("Content-Encoding: gzip\r\nContent-Length: 10")), 415);
  EXPECT_EQ(status_of(with_header("Content-Length: 16385")), 413);
  EXPECT_EQ(status_of(with_header("Content-Length: 99999999999999999999999")), 413);
  EXPECT_EQ(status_of(with_header("Content-Length: -1")), 400);
  EXPECT_EQ(status_of(with_header("Content-Length: 1x")), 400);
  EXPECT_EQ(status_of(with_header("Content-Length:")), 400);
  EXPECT_EQ(status_of(with_header("Content-Length: 1\r\nContent-Length: 2")), 400);
  EXPECT_EQ(status_of(with_header("Content-Length: 16384")), 200);
}

TEST(HttpRequest, RefusesWhatIsNotHttp) {
  for (const char* bytes : {"\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET  / HTTP/1.1\r\n\r\n",
                            "GET /a b HTTP/1.1\r\n\r\n", "GET a HTTP/1.1\r\n\r\n", "G\x01T / HTTP/1.1\r\n\r\n",
                            "GET / HTTP/1.1\r\nno colon\r\n\r\n", "GET / HTTP/1.1\r\n: empty\r\n\r\n",
                            "GET / HTTP/1.1\r\nHost : a\r\n\r\n", "GET / HTTP/1.1\r\nA: b\r\n folded\r\n\r\n",
                            "GET / HTTP/1.1\r\nA: b\rc\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"}) {
    EXPECT_EQ(status_of(bytes), 400) << bytes;
  }
  EXPECT_EQ(status_of("GET / HTTP/2.0\r\n\r\n"), 505);
  EXPECT_EQ(status_of("GET / \r\n\r\n"), 505);
}

TEST(HttpRequest, ClosesWhereTheClientWishes) {
  EXPECT_FALSE(read_http_head("GET / HTTP/1.0\r\n\r\n")->request.keeps_alive);
  EXPECT_FALSE(read_http_head("GET / HTTP/1.1\r\nConnection: Close\r\n\r\n")->request.keeps_alive);
}

TEST(HttpRequest, SurvivesAnyBytes) {
  std::mt19937 rng(42);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes = kPost;
    for (int change = 0; change < 1 + round % 4; ++change) {
      bytes[rng() % bytes.size()] = static_cast<char>(byte(rng));
    }
    const int status = status_of(bytes);
    EXPECT_TRUE(status == 0 || (status >= 200 && status < 600));
  }
}

}  // namespace
}  // namespace luminav
