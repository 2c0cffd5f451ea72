// SPDX-License-Identifier: Apache-2.0
// Tests that a debugger's bytes may be divided into packets in any way.
#include "debug/connection.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <string_view>

namespace mebots::soc::debug {
namespace {

/// Returns a blocking socket that is connected to `connection`, as that of a debugger.
Socket debugger_of(const Connection& connection) {
  Socket socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(connection.port()));
  EXPECT_EQ(::connect(socket.descriptor(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return socket;
}

/// Returns true if an interrupt arrives within ten seconds.
bool receives_interrupt(Connection& connection) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (std::chrono::steady_clock::now() < end) {
    if (connection.interrupted()) return true;
  }
  return false;
}

void say(const Socket& socket, std::string_view bytes) {
  ASSERT_EQ(::send(socket.descriptor(), bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
}

TEST(GdbConnection, InterruptThatComesWithThePacketBeforeItIsHeard) {
  Connection connection(0);
  const auto debugger = debugger_of(connection);
  ASSERT_TRUE(connection.accept(true));
  say(debugger, "$c#63\x03");
  ASSERT_EQ(connection.receive(), "c");
  EXPECT_TRUE(connection.interrupted());
  EXPECT_FALSE(connection.interrupted()) << "once";
  say(debugger, "+\x03");
  EXPECT_TRUE(receives_interrupt(connection));
}

TEST(GdbConnection, PacketThatComesTooEarlyStopsTheProgramAndIsAnswered) {
  Connection connection(0);
  const auto debugger = debugger_of(connection);
  ASSERT_TRUE(connection.accept(true));
  say(debugger, "$c#63$g#67");
  ASSERT_EQ(connection.receive(), "c");
  EXPECT_TRUE(connection.interrupted());
  EXPECT_EQ(connection.receive(), "g");
  EXPECT_FALSE(connection.interrupted());
}

TEST(GdbConnection, DebuggerThatHasGoneIsNotAnInterruptTwice) {
  Connection connection(0);
  {
    const auto debugger = debugger_of(connection);
    ASSERT_TRUE(connection.accept(true));
  }
  EXPECT_TRUE(receives_interrupt(connection));
  EXPECT_FALSE(connection.connected());
  EXPECT_FALSE(connection.interrupted());
}

}  // namespace
}  // namespace mebots::soc::debug
