// SPDX-License-Identifier: Apache-2.0
#include "connection.hpp"
#include "server.hpp"
#include "test_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace mebots::test {
namespace {

TEST(LiveServer, EndsThoughItIsOverBeforeItsThreadListens) {
  for (int i = 0; i < 20; ++i) {
    const live::LiveRun::Server server(0, {});
    EXPECT_EQ(server.address().rfind("http://127.0.0.1:", 0), 0u);
  }
}

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A server with the text "the page", and with data that exceed the socket buffers.
class LiveClients : public testing::Test {
 protected:
  live::LiveRun::Server::Answers answers() {
    live::LiveRun::Server::Answers answers;
    answers.page = [] { return std::string("the page"); };
    answers.data = [this](const auto& /*known*/) {
      return live::LiveRun::Server::Answer{std::string(std::size_t{16} << 20, 'd'), [this] { is_sent_ = true; }};
    };
    return answers;
  }

  int port() const { return std::stoi(server_->address().substr(std::string("http://127.0.0.1:").size())); }
  std::string path() const { return server_->address().substr(server_->address().find('/', 8)); }

  /// Connects to the server and sends only the start of a request. Returns the socket.
  int connect_slowly(const std::string& beginning) {
    const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int buffer = 1 << 16;
    EXPECT_EQ(setsockopt(line, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer), 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(line, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(send(line, beginning.data(), beginning.size(), MSG_NOSIGNAL), static_cast<ssize_t>(beginning.size()));
    lines_.push_back(line);
    return line;
  }
  /// Returns the time in seconds until the server closes the connection, while the client sends `part` repeatedly.
  static double seconds_until_closed(int line, const std::string& part) {
    const auto start = Clock::now();
    while (seconds_since(start) < 20) {
      char byte = 0;
      if (recv(line, &byte, 1, MSG_DONTWAIT) == 0 || send(line, part.data(), part.size(), MSG_NOSIGNAL) < 0) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return seconds_since(start);
  }
  ~LiveClients() override {
    for (const int line : lines_) close(line);
  }

  std::atomic<bool> is_sent_{false};
  std::unique_ptr<live::LiveRun::Server> server_ = std::make_unique<live::LiveRun::Server>(0, answers());
  std::vector<int> lines_;
};

TEST_F(LiveClients, CannotDelayTheEnd) {
  for (int i = 0; i < 50; ++i) connect_slowly("GET / HT");
  const auto start = Clock::now();
  server_.reset();
  EXPECT_LT(seconds_since(start), 3);  // 1 s on an idle machine
}

TEST_F(LiveClients, AreCutOffWhenTheirRequestTakesTooLong) {
  const double deadline_s = std::chrono::duration<double>(live::Connection::kRequestTime).count();
  EXPECT_NEAR(seconds_until_closed(connect_slowly("GET / HTTP/1.1\r\nA: "), "b"), deadline_s, 1);
}

TEST_F(LiveClients, AreCutOffWhenTheirRequestIsTooLarge) {
  EXPECT_LT(seconds_until_closed(connect_slowly("GET / HTTP/1.1\r\n"), std::string(4096, 'A') + ": b\r\n"), 1.5);
}

TEST_F(LiveClients, DoNotBlockABrowser) {
  for (int i = 0; i < 100; ++i) connect_slowly("GET / HTTP/1.1\r\n");
  httplib::Client browser("127.0.0.1", port());
  const auto start = Clock::now();
  const auto page = browser.Get(path());
  ASSERT_TRUE(page);
  EXPECT_EQ(page->body, "the page");
  EXPECT_LT(seconds_since(start), 5);  // 1 s on an idle machine; each slow client takes 2 s
}

TEST_F(LiveClients, HaveAnAnswerOnlyAfterAllOfItWasSent) {
  const int line = connect_slowly("GET " + path() + "data HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port()) +
                                  "\r\nConnection: close\r\n\r\n");
  char byte = 0;
  ASSERT_EQ(recv(line, &byte, 1, 0), 1);  // the server has sent the start of its reply
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(is_sent_);
  std::vector<char> rest(std::size_t{1} << 20);
  while (recv(line, rest.data(), rest.size(), 0) > 0) continue;
  server_.reset();  // waits for the server's threads
  EXPECT_TRUE(is_sent_);
}

TEST_F(LiveClients, DoNotHaveAnAnswerThatTheyLeft) {
  const int line = connect_slowly("GET " + path() + "data HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port()) +
                                  "\r\nConnection: close\r\n\r\n");
  char byte = 0;
  ASSERT_EQ(recv(line, &byte, 1, 0), 1);
  shutdown(line, SHUT_RDWR);
  server_.reset();
  EXPECT_FALSE(is_sent_);
}

TEST(LiveRun, PrintsItsAddressEvenWhenQuiet) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  write_file(folder.path() / "one.json",
             with_probe(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})"));
  const auto done = run_program({"run", "one.json", "--live", "--quiet"}, folder.path());
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, testing::MatchesRegex("live: http://127.0.0.1:[0-9]+/[0-9a-f]+/\n"));
}

}  // namespace
}  // namespace mebots::test
