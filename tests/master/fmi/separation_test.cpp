// SPDX-License-Identifier: Apache-2.0
// Tests that libraries and symbols of FMUs stay separate. Each FMU (tests/fmus/tenant) must use its own gain.
#include "fmi/library_state.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "slave/isolation/child_process.hpp"
#include "support/sanitizer.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace mebots::test {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsSupersetOf;
using testing::Not;

std::string fmu_path(const std::string& name) {
  return fmt::format("{}/tenant_{}.fmu", TENANT_FMUS, name);
}

/// Returns a config with an instance i0, i1 ... of each FMU. The input is 0.5. A gain of 2 gives 1.
std::string config_of(const std::vector<std::string>& fmus, const std::string& keys = "") {
  std::vector<std::string> instances;
  for (std::size_t i = 0; i < fmus.size(); ++i)
    instances.push_back(
        fmt::format(R"("i{}": {{"fmu": "{}", "parameters": {{"u": 0.5}}{}}})", i, fmu_path(fmus[i]), keys));
  return fmt::format(R"({{"step": 0.1, "stop_time": 0.5, "connections": [], "record": ["*.y"], "instances": {{{}}}}})",
                     fmt::join(instances, ", "));
}

class Separation : public testing::Test {
 protected:
  ProgramResult run(const std::string& config, std::vector<std::string> more = {}) const {
    write_file(folder.path() / "some.json", config);
    more.insert(more.begin(), {"run", "some.json"});
    return run_program(more, folder.path());
  }
  std::string last_row() const {
    std::istringstream rows(read_file(folder.path() / "results" / "some" / "results.csv"));
    std::string row;
    for (std::string line; std::getline(rows, line);) row = line;
    return row;
  }

  modeldesc::TemporaryFolder folder{"mebots-test"};
};

struct Pair {
  std::string kind;
  std::string word;  // a word of the notice
};

void PrintTo(const Pair& pair, std::ostream* stream) {
  *stream << pair.kind;
}

class SeparationOfPairs : public Separation, public testing::WithParamInterface<Pair> {};

TEST_P(SeparationOfPairs, GivesEachFmuItsOwnGainInAnyOrder) {
  const auto two = GetParam().kind + "_2";
  const auto three = GetParam().kind + "_3";
  for (const auto& [fmus, row] : {std::pair(std::vector{two, three}, "0.5,1,1.5"), {{three, two}, "0.5,1.5,1"}}) {
    const auto ended = run(config_of(fmus));
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(last_row(), row);
    const auto log = read_file(folder.path() / "results" / "some" / "log.txt");
    EXPECT_THAT(log, AllOf(HasSubstr(fmt::format("i1: tenant_{}.fmu runs in its own process", fmus[1])),
                           HasSubstr(fmt::format("tenant_{}.fmu", fmus[0])), HasSubstr(GetParam().word)));
    EXPECT_THAT(log, Not(HasSubstr("i0: tenant")));
  }
}

TEST_P(SeparationOfPairs, GivesEachFmuItsOwnGainInProcessesOfTheirOwn) {
  if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  for (const auto* process : {"own", "sandboxed"}) {
    const auto ended =
        run(config_of({GetParam().kind + "_2", GetParam().kind + "_3"}, fmt::format(R"(, "process": "{}")", process)));
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(last_row(), "0.5,1,1.5") << process;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, SeparationOfPairs,
                         testing::Values(Pair{"library", "libtenant.so.1"}, Pair{"unique", "STB_GNU_UNIQUE"},
                                         Pair{"opens", "libplugin.so"}),
                         [](const auto& tested) { return tested.param.kind; });

TEST_F(Separation, FmusOfWeakSymbolsShareTheProcess) {
  const auto ended = run(config_of({"weak_2", "weak_3"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(last_row(), "0.5,1,1.5");
}

TEST_F(Separation, AnFmuMayBringALibraryThatMebotsHas) {
  const auto ended = run(config_of({"fmt_5"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(last_row(), "0.5,2.5");
  EXPECT_THAT(
      read_file(folder.path() / "results" / "some" / "log.txt"),
      HasSubstr("tenant_fmt_5.fmu runs in its own process: its archive contains libfmt.so.9, and this process has"));
}

TEST_F(Separation, AnFmuMayBringTheCxxRuntimeAndThrow) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "the sanitizer's runtime comes first";
  if (!sandbox_refusal().empty()) GTEST_SKIP() << sandbox_refusal();
  for (const auto* keys : {"", R"(, "process": "sandboxed")"}) {
    const auto ended = run(config_of({"runtime_4"}, keys));
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(last_row(), "0.5,2");
  }
}

TEST_F(Separation, AFunctionWithTheNameOfOneInMebotsLibrariesIsTheFmusOwn) {
  const auto ended = run(config_of({"preempted_7"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(last_row(), "0.5,3.5");
  EXPECT_THAT(read_file(folder.path() / "results" / "some" / "log.txt"),
              HasSubstr("its calls of zlibCompileFlags would reach"));
}

TEST_F(Separation, DemandedSharingIsRefusedIfNumbersWouldBeWrong) {
  for (const auto& [fmus, word] : {std::pair(std::vector<std::string>{"library_2", "library_3"}, "libtenant.so.1"),
                                   {{"unique_2", "unique_3"}, "STB_GNU_UNIQUE"},
                                   {{"fmt_5"}, "libfmt.so.9"}}) {
    const auto ended = run(config_of(fmus, R"(, "process": "shared")"));
    EXPECT_EQ(ended.code, 2) << ended.err;
    EXPECT_THAT(ended.err, AllOf(HasSubstr("/process"), HasSubstr("cannot run in the \"shared\" process"),
                                 HasSubstr(word), HasSubstr("Leave \"process\" out")));
  }
}

TEST_F(Separation, TheFmuWithMoreInstancesKeepsTheProcess) {
  const auto ended = run(config_of({"library_2", "library_3", "library_3"}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(last_row(), "0.5,1,1.5,1.5");
  EXPECT_THAT(read_file(folder.path() / "results" / "some" / "log.txt"),
              AllOf(HasSubstr("i0: tenant_library_2.fmu runs in its own process"), Not(HasSubstr("i1: tenant"))));
}

TEST_F(Separation, ALaterRunOfTheProcessGetsItsOwnUniqueVariables) {
  // The loader never unloads a library with unique symbols. The FMU counts its instances in such a symbol.
  for (int i = 0; i < 3; ++i) {
    TestRun run(config_of({"unique_2"}));
    EXPECT_EQ(run.to_end().column("i0.y").back(), 1) << i;
    EXPECT_EQ(run.system.notices.size(), i == 0 ? 0U : 1U);
  }
}

TEST_F(Separation, TwoRunsAtATimeGetTheirOwnLibraries) {
  TestRun one(config_of({"library_2"}));
  TestRun other(config_of({"library_3"}));
  one.to_end();
  other.to_end();
  EXPECT_EQ(one.column("i0.y").back(), 1);
  EXPECT_EQ(other.column("i0.y").back(), 1.5);
  EXPECT_THAT(one.system.notices, IsEmpty());
  EXPECT_THAT(other.system.notices, testing::ElementsAre(HasSubstr("tenant_library_2.fmu")));
}

TEST(FmuHost, LoadsTheCLibraryAloneAndExportsNothingElse) {
  if (kSanitizerTakesCrashesAndMemory) GTEST_SKIP() << "it has the sanitizer's runtime";
  const auto host = modeldesc::read_elf_library(MEBOTS_FMU_HOST_PROGRAM);
  EXPECT_THAT(host.needed, Not(IsEmpty()));
  EXPECT_TRUE(std::ranges::all_of(host.needed, master::is_c_library))
      << fmt::format("{}", fmt::join(host.needed, ", "));
  // The host exports only symbols of the C library: variables that the linker copies into a program, and its
  // replacements of _exit() and exec().
  std::vector<std::string> of_c_library;
  for (const auto& library : modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip)) {
    if (!master::is_c_library(library.soname)) continue;
    const auto names = modeldesc::read_elf_library(library.file).exports();
    of_c_library.insert(of_c_library.end(), names.begin(), names.end());
  }
  EXPECT_THAT(of_c_library, IsSupersetOf(host.exports()));
}

TEST(LibraryNeeds, AreReadBeforeAnythingIsLoaded) {
  modeldesc::TemporaryFolder folder("mebots-test");
  modeldesc::unpack(fmu_path("library_2"), folder.path());
  const auto needs =
      master::read_library_needs(folder.path() / "binaries" / "linux64" / "tenant_library_2.so", folder.path(), {});
  EXPECT_TRUE(needs.brought.contains("libtenant.so.1"));
  EXPECT_THAT(needs.names, testing::Contains("libc.so.6"));
  EXPECT_TRUE(needs.interpreter.empty());
  for (const auto& library : modeldesc::loaded_libraries(modeldesc::UniqueSymbols::skip))
    EXPECT_FALSE(library.file.native().starts_with(folder.path().native()));
}

}  // namespace
}  // namespace mebots::test
