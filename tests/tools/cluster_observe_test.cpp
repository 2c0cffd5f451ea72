// SPDX-License-Identifier: Apache-2.0
// Tests the profile and the trace of the cluster's cores. Each core has its own profile. Their sum is the chip's
// profile.
#include "board_system.hpp"
#include "observe/profile.hpp"
#include "observe/session.hpp"
#include "observe/trace.hpp"
#include "support.hpp"
#include "support/same_state.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <deque>
#include <map>
#include <sstream>

namespace mebots::soc::test {
namespace {

/// Runs a program with a profile. The default program is the self-test of the cluster's runtime (forks, barriers, DMA,
/// switching the cluster off and on).
struct ProfiledCluster {
  explicit ProfiledCluster(std::string_view file, std::string_view program = "cluster_selftest",
                           std::int64_t end_ns = 20 * kMs, bool translate = true)
      : system(Elf::read(fmt::format("{}/firmware/{}.elf", MEBOTS_BINARY_DIR, program)), settings(translate)),
        profile("--profile", folder / file, system.soc) {
    auto& soc = system.soc;
    for (unsigned number = 0; number < soc.harts(); ++number) soc.observe(number, &profile.hart(number));
    soc.advance(end_ns);
    fabric_controller_translates = soc.hart(0).code().is_translated();
    cluster_translates = soc.hart(1).code().is_translated();
    for (unsigned number = 0; number < soc.harts(); ++number) soc.observe(number, nullptr);
    profile.finish();
    written = read_file(folder / file);
  }
  static Settings settings(bool translate) {
    Settings settings;
    settings.translate = translate;
    return settings;
  }

  Folder folder;
  BoardSystem system;
  observe::Profile profile;
  std::string written;
  bool fabric_controller_translates = false;
  bool cluster_translates = false;
};

/// Returns {name of a function: its costs}, summed over all stacks.
std::map<std::string, observe::Cost> self_costs(observe::Profile& profile, unsigned number) {
  std::map<std::string, observe::Cost> costs;
  const auto& nodes = profile.hart(number).tree().nodes();
  for (std::size_t i = 1; i < nodes.size(); ++i) costs[profile.functions().name(nodes[i].place)] += nodes[i].self;
  return costs;
}

/// Returns the nodes of the call tree. The key contains the names of their frames, the outermost frame first.
std::map<std::string, observe::CallTree::Node> stacks(observe::Profile& profile, unsigned number) {
  const auto& nodes = profile.hart(number).tree().nodes();
  std::map<std::string, observe::CallTree::Node> found;
  std::vector<std::string> names(nodes.size());
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    names[i] = fmt::format("{};{}", names[nodes[i].parent], profile.functions().name(nodes[i].place));
    found[names[i]] = nodes[i];
  }
  return found;
}

std::uint64_t steps_of(observe::Profile& profile, unsigned number) {
  std::uint64_t calls = 0;
  for (const auto& node : profile.hart(number).tree().nodes()) calls += node.calls;
  return calls;
}

void expect_whole_chip(ProfiledCluster& run) {
  auto& soc = run.system.soc;
  ASSERT_EQ(soc.harts(), 9U);
  std::int64_t energy_fj = 0;
  std::int64_t instructions = 0;
  for (unsigned number = 0; number < soc.harts(); ++number) {
    const auto total = run.profile.hart(number).total();
    EXPECT_EQ(total.cycles, static_cast<std::int64_t>(soc.hart(number).counters().cycles)) << number;
    energy_fj += total.energy_fj;
    instructions += total.instructions;
  }
  EXPECT_EQ(instructions, static_cast<std::int64_t>(soc.instructions()));
  EXPECT_EQ(energy_fj, std::llround(soc.energy().total_j() * 1e15));
}

TEST(ClusterProfile, HartsAddUpToTheChipExactly) {
  ProfiledCluster run("p.json");
  const auto& soc = run.system.soc;
  ASSERT_EQ(soc.end(), End::exited);
  expect_whole_chip(run);
  for (unsigned number = 0; number < soc.harts(); ++number) {
    EXPECT_EQ(run.profile.hart(number).total().time_ps, soc.now()) << number;
  }
}

TEST(ClusterProfile, HartsAddUpToTheChipInTheMiddleOfAnInference) {
  ProfiledCluster run("p.json", "network_bench", 30 * kMs);
  expect_whole_chip(run);
  EXPECT_GT(self_costs(run.profile, 1).at("nn_fast_first").energy_fj, 0);
}

TEST(ClusterProfile, GivesACoreTheEnergyOfItsFunctionsAndTheRestToTheFabricController) {
  ProfiledCluster run("p.json");
  std::int64_t of_cores_fj = 0;
  for (unsigned number = 1; number < run.system.soc.harts(); ++number) {
    const auto costs = self_costs(run.profile, number);
    for (const auto& [name, cost] : costs) {
      EXPECT_GE(cost.energy_fj, 0) << name;
      EXPECT_GE(cost.time_ps, 0) << name;
    }
    EXPECT_GT(costs.at("[off]").time_ps, 0) << "before the firmware switches it on";
    EXPECT_EQ(costs.at("[off]").energy_fj, 0);
    EXPECT_EQ(costs.at("[asleep]").energy_fj, 0) << "what a gated core takes is not work of its own";
    EXPECT_GT(costs.at("[asleep]").time_ps, 0);
    of_cores_fj += run.profile.hart(number).total().energy_fj;
  }
  const auto ledger = run.system.soc.energy();
  const auto most_j = ledger[Part::cluster_cores] + ledger[Part::l1] + ledger[Part::l2] + ledger[Part::interconnect];
  EXPECT_GT(of_cores_fj, 0);
  EXPECT_LT(static_cast<double>(of_cores_fj) * 1e-15, most_j) << "of these parts, DMA and gated cores have some too";
}

TEST(ClusterProfile, ForSpeedscopeHasThreeProfilesForEachHartThatRan) {
  ProfiledCluster run("p.json");
  const auto json = nlohmann::json::parse(run.written);
  ASSERT_EQ(json["profiles"].size(), 3U * 9U);
  EXPECT_EQ(json["profiles"][0]["name"], "time");
  EXPECT_EQ(json["profiles"][3]["name"], "time, cluster core 0");
  EXPECT_EQ(json["profiles"][26]["name"], "cycles, cluster core 7");
  for (unsigned number = 0; number < 9; ++number) {
    const auto total = run.profile.hart(number).total();
    EXPECT_EQ(json["profiles"][3 * number + 2]["endValue"].get<std::int64_t>(), total.cycles);
    for (unsigned i = 0; i < 3; ++i) {
      double last = 0;
      for (const auto& event : json["profiles"][3 * number + i]["events"]) {
        ASSERT_GE(event["at"].get<double>(), last) << "speedscope wants it never to go back";
        last = event["at"].get<double>();
      }
    }
  }
}

TEST(ClusterProfile, ForCallgrindHasAPartForEachHartThatRan) {
  ProfiledCluster run("p.callgrind");
  std::istringstream lines(run.written);
  std::map<unsigned, observe::Cost> self;
  unsigned thread = 0;
  bool inclusive = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("thread: ")) thread = static_cast<unsigned>(std::stoul(line.substr(8)));
    observe::Cost cost;
    int position = 0;
    if (std::istringstream(line) >> position >> cost.cycles >> cost.instructions >> cost.time_ps >> cost.energy_fj) {
      if (!inclusive) self[thread] += cost;
    }
    inclusive = line.starts_with("calls=");
  }
  ASSERT_EQ(self.size(), 9U);
  for (unsigned number = 0; number < 9; ++number) EXPECT_EQ(self.at(number + 1), run.profile.hart(number).total());
}

TEST(ClusterProfile, OmitsCoresThatExecutedNothing) {
  const Folder folder;
  BoardSystem system("_start: li t0, POWER_MANAGER_BASE\nsw zero, POWER_MANAGER_EXIT_OFFSET(t0)\nnop\n");
  observe::Profile profile("--profile", folder / "p.json", system.soc);
  system.soc.advance(kMs);
  profile.finish();
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "p.json"))["profiles"].size(), 3U);
}

TEST(ClusterTrace, HasALineForEveryInstructionOfEveryHart) {
  const Folder folder;
  BoardSystem system(Elf::read(MEBOTS_BINARY_DIR "/firmware/cluster_selftest.elf"));
  auto& soc = system.soc;
  observe::Trace trace("--trace", folder / "trace", {}, soc.harts());
  for (unsigned number = 0; number < soc.harts(); ++number) soc.observe(number, &trace.hart(number));
  soc.advance(20 * kMs);
  trace.close();
  std::istringstream file(read_file(folder / "trace"));
  std::map<unsigned, std::uint64_t> lines;
  for (std::string line; std::getline(file, line);) {
    ASSERT_THAT(line, testing::StartsWith("core "));
    ++lines[static_cast<unsigned>(std::stoul(line.substr(4, 4)))];
  }
  ASSERT_EQ(lines.size(), soc.harts());
  for (const auto& [number, count] : lines) EXPECT_EQ(count, soc.hart(number).counters().instructions) << number;
}

/// If the profile is the only observer, hot code stays translated.
TEST(ClusterProfile, IsTheSameForTranslatedAndInterpretedCode) {
  for (const std::string_view program : {"cluster_selftest", "network_bench"}) {
    ProfiledCluster interpreted("interpreted.json", program, 12 * kMs, false);
    ProfiledCluster translated("translated.json", program, 12 * kMs, true);
    ASSERT_TRUE(mebots::test::same_state(interpreted.system.soc, translated.system.soc));
    EXPECT_FALSE(interpreted.cluster_translates || interpreted.fabric_controller_translates);
    EXPECT_TRUE(translated.cluster_translates);
    EXPECT_TRUE(translated.fabric_controller_translates);
    for (unsigned number = 0; number < translated.system.soc.harts(); ++number) {
      const auto expected = stacks(interpreted.profile, number);
      const auto found = stacks(translated.profile, number);
      ASSERT_EQ(found.size(), expected.size()) << number;
      for (const auto& [stack, node] : expected) {
        ASSERT_EQ(found.count(stack), 1U) << stack;
        const auto& other = found.at(stack);
        EXPECT_EQ(other.calls, node.calls) << number << ": " << stack;
        EXPECT_EQ(other.self.cycles, node.self.cycles) << number << ": " << stack;
        EXPECT_EQ(other.self.instructions, node.self.instructions) << number << ": " << stack;
        EXPECT_EQ(other.self.time_ps, node.self.time_ps) << number << ": " << stack;
        // Each step rounds up or down to a whole number of femtojoules.
        const auto most = 2.0 * static_cast<double>(steps_of(interpreted.profile, number));
        EXPECT_NEAR(static_cast<double>(other.self.energy_fj), static_cast<double>(node.self.energy_fj), most) << stack;
      }
    }
  }
}

/// Attaching and detaching observers during a run must not change the chip's state. The state includes the instruction
/// cache, banks, DMA, and the arbitration at devices.
TEST(ClusterObservers, ComeAndGoWithoutChangingABitOfTheRun) {
  struct Case {
    bool translate;
    bool trace;
  };
  for (const auto& [translate, trace] : {Case{true, true}, Case{true, false}, Case{false, true}}) {
    const Folder folder;
    Settings settings;
    settings.translate = translate;
    const auto program = Elf::read(MEBOTS_BINARY_DIR "/firmware/cluster_selftest.elf");
    BoardSystem plain(program, settings);
    BoardSystem watched(program, settings);
    observe::Requests requests;
    if (trace) requests.trace = folder / "trace";
    requests.profile = folder / "p.json";
    std::optional<observe::Session> session;
    constexpr std::int64_t kStep = 97'001;
    for (std::int64_t t = kStep, step = 0; plain.soc.end() == End::none; t += kStep, ++step) {
      ASSERT_LT(t, 20 * kMs);
      if (step % 7 == 0) session.emplace(requests, watched.soc);
      if (step % 7 == 5) session.reset();
      plain.soc.advance(t);
      watched.soc.advance(t);
      ASSERT_TRUE(mebots::test::same_state(plain.soc, watched.soc)) << "at " << t << " ns";
      ASSERT_EQ(plain.soc.energy().total_j(), watched.soc.energy().total_j()) << "at " << t << " ns";
    }
    EXPECT_GT(watched.soc.cluster()->counters().instructions, 300'000U);
  }
}

}  // namespace
}  // namespace mebots::soc::test
