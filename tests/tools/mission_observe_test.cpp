// SPDX-License-Identifier: Apache-2.0
// Tests that the gate firmware in the FMU's model has the same bits with and without observers.
#include "fmu/model.hpp"

#include "support.hpp"

#include "mebots/error.hpp"
#include "mebots/state/save.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr std::int64_t kStep = 2'000'000;

/// The FMU's resources folder, as in the archive.
class Resources {
 public:
  Resources() {
    std::filesystem::copy(MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json", folder_ / "ai_deck.json");
    std::filesystem::copy(MEBOTS_BINARY_DIR "/firmware/gate.elf", folder_ / "gate.elf");
  }
  std::filesystem::path path() const { return folder_ / ""; }

 private:
  Folder folder_;
};

/// Runs the FMU's model for some steps. Returns its state at the end. Without a picture, the drone waits on the ground.
/// With a picture, the drone flies, and every camera picture is this picture.
std::vector<std::byte> state_after(const Parameters& parameters, int steps,
                                   const std::function<void(std::string_view)>& on_message = {},
                                   std::span<const std::uint8_t> picture = {}) {
  const Resources resources;
  Listeners listeners;
  listeners.observe = on_message;
  Variables variables;
  variables.parameters = parameters;
  Model model(variables, resources.path(), listeners);
  model.start(0);
  if (!picture.empty()) variables.inputs.flight_phase = FlightPhase::flying;
  for (int i = 0; i < steps; ++i) {
    variables.inputs.camera_frame = fmu::BinaryRef::to(picture);
    variables.inputs.camera_frame_id = variables.outputs.camera_trigger;
    model.step(i * kStep, kStep);
  }
  return state::save(model);
}

TEST(MissionObserve, ProfileTraceAndPowerTraceChangeNothingAndAreWritten) {
  const Folder folder;
  Parameters watched;
  watched.observe_profile = folder / "profile.json";
  watched.observe_trace = folder / "trace";
  watched.observe_power_trace = folder / "power.vcd";
  constexpr int kSteps = 40;
  EXPECT_TRUE(state_after({}, kSteps) == state_after(watched, kSteps));
  EXPECT_THAT(read_file(folder / "profile.json"), testing::HasSubstr("\"main\""));
  EXPECT_THAT(read_file(folder / "profile.json"), testing::Not(testing::HasSubstr("\"$x")));
  EXPECT_GT(read_file(folder / "trace").size(), 1000U);
  EXPECT_THAT(read_file(folder / "power.vcd"), testing::HasSubstr("sasleep"));
}

TEST(MissionObserve, ProfileOfAnInferenceHasTheClustersCoresAndChangesNothing) {
  const Folder folder;
  Parameters unwatched;
  unwatched.mission_navigator = Navigator::network;
  auto watched = unwatched;
  watched.observe_profile = folder / "profile.json";
  const std::vector<std::uint8_t> picture(std::size_t{320} * 320, 100);
  constexpr int kSteps = 60;
  EXPECT_TRUE(state_after(unwatched, kSteps, {}, picture) == state_after(watched, kSteps, {}, picture));
  EXPECT_TRUE(read_file(folder / "profile.json").find("\"cycles, cluster core 7\"") != std::string::npos);
}

TEST(MissionObserve, AnUnwritableFileIsRefusedAtTheStart) {
  Parameters parameters;
  parameters.observe_profile = "/nowhere/p.json";
  try {
    state_after(parameters, 1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("observe.profile /nowhere/p.json: cannot be written"));
  }
}

/// A minimal debugger. It sends one packet at a time and reads the answer.
class Caller {
 public:
  explicit Caller(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  Caller(const Caller&) = delete;
  Caller& operator=(const Caller&) = delete;
  ~Caller() { ::close(socket_); }

  bool connected() const { return connected_; }
  std::string ask(std::string_view content) {
    unsigned sum = 0;
    for (const char c : content) sum += static_cast<std::uint8_t>(c);
    const auto packet = fmt::format("${}#{:02x}", content, sum & 0xffU);
    ::send(socket_, packet.data(), packet.size(), MSG_NOSIGNAL);
    return read_packet();
  }
  std::string read_packet() {
    std::string content;
    char c = 0;
    while (::recv(socket_, &c, 1, 0) == 1 && c != '$') continue;
    while (::recv(socket_, &c, 1, 0) == 1 && c != '#') content += c;
    ::recv(socket_, &c, 1, 0);
    ::recv(socket_, &c, 1, 0);
    ::send(socket_, "+", 1, MSG_NOSIGNAL);
    return content;
  }
  std::string pc() { return ask("p20"); }
  std::string time() { return ask("qRcmd,74696d65"); }  // "time"

 private:
  int socket_;
  bool connected_ = false;
};

/// Starts a thread with a debugger. It connects to the port at the end of the message.
template <typename Talk>
std::jthread start_debugger(std::string_view message, Talk talk) {
  const auto port = std::stoi(std::string(message.substr(message.rfind(':') + 1)));
  return std::jthread([port, talk = std::move(talk)] {
    Caller gdb(port);
    talk(gdb);
  });
}

TEST(MissionObserve, ADebuggerPausesTheMissionWhichThenContinuesWithTheSameBits) {
  Parameters debugged;
  debugged.gdb_port = 0;
  constexpr int kSteps = 20;
  std::vector<std::string> answers;
  std::jthread caller;
  const auto bytes = state_after(debugged, kSteps, [&](std::string_view message) {
    caller = start_debugger(message, [&answers](Caller& gdb) {
      answers.push_back(gdb.ask("?"));
      for (int i = 0; i < 100; ++i) answers.push_back(gdb.ask("s"));
      answers.push_back(gdb.ask("m1c000000,4"));
      answers.push_back(gdb.ask("D"));
    });
  });
  caller.join();
  ASSERT_EQ(answers.size(), 103U);
  EXPECT_EQ(answers[0], "T05thread:1;");
  EXPECT_EQ(answers[100], "T05thread:1;");
  EXPECT_EQ(answers[101].size(), 8U);
  EXPECT_EQ(answers[102], "OK");
  EXPECT_TRUE(bytes == state_after({}, kSteps));
}

/// Each step takes 2 ms. The firmware sleeps most of the time, so some steps have few or no instructions.
TEST(MissionObserve, ADebuggerGoesBackOverStepsOfTheMissionAndTheBitsStay) {
  Parameters debugged;
  debugged.gdb_port = 0;
  constexpr int kSteps = 30;
  const auto handler = Elf::read(MEBOTS_BINARY_DIR "/firmware/gate.elf").symbol("on_timer").value();
  std::vector<std::string> answers;
  std::jthread caller;
  const auto bytes = state_after(debugged, kSteps, [&](std::string_view message) {
    caller = start_debugger(message, [handler, &answers](Caller& gdb) {
      gdb.ask("?");
      const auto begin = gdb.pc();
      const auto begin_time = gdb.time();
      gdb.ask(fmt::format("Z0,{:x},4", handler));
      for (int i = 0; i < 2; ++i) answers.push_back(gdb.ask("c"));  // the handler of the timer, each 20 ms
      const auto present = gdb.pc();
      const auto present_time = gdb.time();
      answers.push_back(gdb.ask("bc"));
      EXPECT_EQ(gdb.pc(), present) << "the same breakpoint";
      EXPECT_NE(gdb.time(), present_time) << "an earlier time";
      answers.push_back(gdb.ask("bc"));
      EXPECT_EQ(gdb.pc(), begin);
      EXPECT_EQ(gdb.time(), begin_time);
      gdb.ask("c");
      gdb.ask("c");
      EXPECT_EQ(gdb.pc(), present);
      EXPECT_EQ(gdb.time(), present_time) << "the same place after a replay";
      gdb.ask("s");
      gdb.ask("s");
      gdb.ask("bs");
      gdb.ask("bs");
      EXPECT_EQ(gdb.pc(), present);
      EXPECT_EQ(gdb.time(), present_time);
      answers.push_back(gdb.ask("D"));
    });
  });
  caller.join();
  ASSERT_EQ(answers.size(), 5U);
  EXPECT_THAT(answers[2], testing::HasSubstr("swbreak"));
  EXPECT_THAT(answers[3], testing::HasSubstr("replaylog:begin"));
  EXPECT_EQ(answers[4], "OK");
  EXPECT_TRUE(bytes == state_after({}, kSteps));
}

/// The debugger goes back, and makes the timer's handler run again. This changes only the number of instructions, so
/// later steps start at other positions than before. `monitor reset` drops this change. Afterwards, the bits are those
/// of a run without a debugger.
TEST(MissionObserve, AfterAChangeInThePastADebuggerGoesBackAgain) {
  Parameters debugged;
  debugged.gdb_port = 0;
  constexpr int kSteps = 30;
  const auto handler = Elf::read(MEBOTS_BINARY_DIR "/firmware/gate.elf").symbol("on_timer").value();
  std::vector<std::string> answers;
  std::jthread caller;
  const auto bytes = state_after(debugged, kSteps, [&](std::string_view message) {
    caller = start_debugger(message, [handler, &answers](Caller& gdb) {
      gdb.ask("?");
      const auto begin = gdb.pc();
      gdb.ask(fmt::format("Z0,{:x},4", handler));
      gdb.ask("c");
      const auto at_handler = gdb.pc();
      const auto first_time = gdb.time();
      gdb.ask("c");
      gdb.ask("bc");
      EXPECT_EQ(gdb.time(), first_time);
      const auto end_of_handler = gdb.ask("p1");  // ra
      for (int i = 0; i < 100 && gdb.pc() != end_of_handler; ++i) gdb.ask("s");
      EXPECT_EQ(gdb.pc(), end_of_handler);
      answers.push_back(gdb.ask("P20=" + at_handler));
      gdb.ask("s");
      gdb.ask("c");
      EXPECT_EQ(gdb.pc(), at_handler);
      const auto second_time = gdb.time();
      EXPECT_NE(second_time, first_time);
      answers.push_back(gdb.ask("bs"));
      EXPECT_NE(gdb.pc(), at_handler);
      gdb.ask("c");
      EXPECT_EQ(gdb.pc(), at_handler);
      EXPECT_EQ(gdb.time(), second_time);
      answers.push_back(gdb.ask("bc"));
      gdb.ask("qRcmd,7265736574");  // "reset"
      EXPECT_EQ(gdb.pc(), begin);
      gdb.ask("c");
      EXPECT_EQ(gdb.time(), first_time);
      answers.push_back(gdb.ask("bs"));
      answers.push_back(gdb.ask("D"));
    });
  });
  caller.join();
  EXPECT_THAT(answers,
              testing::ElementsAre("OK", "T05thread:1;", testing::HasSubstr("replaylog:begin"), "T05thread:1;", "OK"));
  EXPECT_TRUE(bytes == state_after({}, kSteps));
}

TEST(MissionObserve, ADebuggerGoesBackToTheStateThatTheCoSimulationRestoredButNotToTheStart) {
  const auto handler = Elf::read(MEBOTS_BINARY_DIR "/firmware/gate.elf").symbol("on_timer").value();
  const Resources resources;
  std::atomic<bool> restored = false;
  std::vector<std::string> answers;
  std::jthread caller;
  Listeners listeners;
  listeners.observe = [&](std::string_view message) {
    caller = start_debugger(message, [handler, &answers, &restored](Caller& gdb) {
      gdb.ask("?");
      gdb.ask(fmt::format("Z0,{:x},4", handler));
      std::string stop;
      for (int i = 0; i < 10 && !restored; ++i) stop = gdb.ask("c");
      answers.push_back(stop);
      answers.push_back(gdb.ask("bs"));
      answers.push_back(gdb.ask("qRcmd,7265736574"));  // "reset"
      answers.push_back(gdb.ask("D"));
    });
  };
  {
    Variables variables;
    variables.parameters.gdb_port = 0;
    Model model(variables, resources.path(), listeners);
    model.start(0);
    for (int i = 0; i < 3; ++i) model.step(i * kStep, kStep);
    const auto saved = state::save(model);
    constexpr int kSteps = 30;  // 60 ms; the handler runs each 20 ms
    for (int i = 3; i < kSteps; ++i) model.step(i * kStep, kStep);
    state::restore(model, saved);
    restored = true;
    for (int i = 3; i < kSteps; ++i) model.step(i * kStep, kStep);
  }
  caller.join();
  constexpr std::string_view kTheStart = "746865207374617274";  // "the start"
  EXPECT_THAT(answers, testing::ElementsAre(testing::HasSubstr("swbreak"), "T05thread:1;",
                                            testing::HasSubstr(std::string(kTheStart)), "OK"));
}

TEST(MissionObserve, ADebuggerThatVanishesLetsTheMissionContinue) {
  Parameters debugged;
  debugged.gdb_port = 0;
  std::jthread caller;
  const auto bytes = state_after(debugged, 5, [&](std::string_view message) {
    caller = start_debugger(message, [](Caller& gdb) { gdb.ask("?"); });
  });
  caller.join();
  EXPECT_TRUE(bytes == state_after({}, 5));
}

}  // namespace
}  // namespace mebots::soc::test
