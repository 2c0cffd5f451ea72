// SPDX-License-Identifier: Apache-2.0
//
// Tests --save-state and --load-state.
#include "support.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace mebots::soc::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kClusterRun =
    "run " MEBOTS_BINARY_DIR "/firmware/cluster_selftest.elf --board " MEBOTS_SOURCE_DIR "/configs/boards/ai_deck.json";

/// Returns the report of a run without the speed of the host.
nlohmann::json report_in(const std::string& path) {
  auto report = nlohmann::json::parse(read_file(path));
  report.erase("host_mips");
  return report;
}

/// Returns the text that a run printed before its report.
std::string console_of(const Outcome& run) {
  const auto text = run.out.substr(0, run.out.find("fabric controller"));
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

TEST(State, ARunInTwoPartsEndsLikeAWholeOne) {
  const Folder folder;
  const auto whole = run_tool(fmt::format("{} --json {}", kClusterRun, folder / "whole.json"));
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const auto expected = report_in(folder / "whole.json");
  for (const auto* limit : {"--max-instructions 1", "--max-time 1ms", "--max-time 2.5ms"}) {
    const auto state = folder / "state";
    const auto first = run_tool(fmt::format("{} {} --save-state {}", kClusterRun, limit, state));
    EXPECT_EQ(first.exit_code, 101) << first.err;
    const auto second =
        run_tool(fmt::format("{} --load-state {} --json {}", kClusterRun, state, folder / "second.json"));
    EXPECT_EQ(second.exit_code, 0) << second.err;
    EXPECT_EQ(report_in(folder / "second.json"), expected) << limit;
    EXPECT_EQ(console_of(first) + console_of(second), console_of(whole)) << limit;
    const auto interpreted = run_tool(
        fmt::format("{} --interpret --load-state {} --json {}", kClusterRun, state, folder / "interpreted.json"));
    EXPECT_EQ(report_in(folder / "interpreted.json"), expected) << limit;
  }
}

TEST(State, IsNotSavedIfItCannotContinue) {
  const Folder folder;
  const auto save = [&](std::string_view limit) {
    const auto run = run_tool(fmt::format("{} {} --save-state {}", kClusterRun, limit, folder / "state"));
    EXPECT_EQ(run.exit_code, 102) << limit;
    EXPECT_FALSE(std::filesystem::exists(folder / "state")) << limit;
    return run.err;
  };
  EXPECT_THAT(save(""), HasSubstr("the program has ended"));
  EXPECT_THAT(save("--max-instructions 60000"), HasSubstr("within a step of the cluster; end it with --max-time"));
}

class StateFiles : public testing::Test {
 protected:
  StateFiles() {
    const auto run = run_tool(fmt::format("run {} --max-instructions 50 --save-state {}", program_, state_));
    EXPECT_EQ(run.exit_code, 101) << run.err;
  }
  Outcome load(const std::string& program, const std::string& options = "") {
    return run_tool(fmt::format("run {} --load-state {} {}", program, state_, options));
  }
  static std::string loop(int count) {
    return fmt::format(
        "_start: li t0, {}\n1: addi t0, t0, -1\n bnez t0, 1b\n la t1, tohost\n li t2, 1\n sw t2, 0(t1)\n"
        "2: j 2b\n{}",
        count, kTohost);
  }

  Folder folder_;
  std::string program_ = folder_.program(loop(1000));
  std::string state_ = folder_ / "state";
};

TEST_F(StateFiles, AreRefusedForAnotherProgramBoardOrMemory) {
  EXPECT_EQ(load(program_).exit_code, 0);
  const auto refuses = [](const Outcome& run, std::string_view name) {
    EXPECT_EQ(run.exit_code, 102);
    EXPECT_THAT(run.err, AllOf(HasSubstr("--load-state"), HasSubstr(fmt::format("saved with another {};", name))));
  };
  refuses(load(program_, "--core ri5cy"), "--core");
  refuses(load(program_, "--ram 0x80000000:64K"), "--ram");
  refuses(load(program_, "--board " MEBOTS_SOURCE_DIR "/configs/boards/virt.json"), "--board");
  const Folder other;
  refuses(load(other.program(loop(1001))), "program");
}

TEST_F(StateFiles, AreRefusedIfDamaged) {
  const auto bytes = read_file(state_);
  for (const auto length : {std::size_t{0}, std::size_t{10}, std::size_t{60}, bytes.size() / 2, bytes.size() - 1}) {
    write_file(state_, bytes.substr(0, length));
    const auto run = load(program_);
    EXPECT_EQ(run.exit_code, 102) << length;
    EXPECT_THAT(run.err, HasSubstr("--load-state " + state_)) << length;
  }
  write_file(state_, bytes + "x");
  EXPECT_THAT(load(program_).err, HasSubstr("is damaged"));
  auto flipped = bytes;
  flipped[bytes.size() / 2] ^= 1;
  write_file(state_, flipped);
  EXPECT_THAT(load(program_).err, HasSubstr("is damaged"));
  write_file(state_,
             "\x7f"
             "ELF");
  EXPECT_THAT(load(program_).err, HasSubstr("does not begin with"));
}

TEST_F(StateFiles, GiveAnErrorIfTheLimitLiesBefore) {
  const auto run = load(program_, "--max-instructions 49");
  EXPECT_EQ(run.exit_code, 102);
  EXPECT_THAT(run.err, HasSubstr("--max-instructions 49"));
  EXPECT_EQ(load(program_, "--max-instructions 50").exit_code, 101);
  EXPECT_THAT(load(program_, "--max-time 1ns").err, HasSubstr("--max-time"));
}

TEST_F(StateFiles, ExcludeOptionsThatNeedTheHostOrTheStart) {
  EXPECT_THAT(load(program_, "--user").err, HasSubstr("--user"));
  EXPECT_THAT(load(program_, "--report r.json").err, HasSubstr("--report"));
  EXPECT_THAT(load(program_, "--save-state " + state_).err, HasSubstr("is also --load-state"));
}

}  // namespace
}  // namespace mebots::soc::test
