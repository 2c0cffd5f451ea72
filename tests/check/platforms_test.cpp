// SPDX-License-Identifier: Apache-2.0
// Tests `mebots check` on FMUs with binaries for several platforms.
#include "support.hpp"

#include "support/elf32_library.hpp"
#include "support/windows_dll.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(CheckPlatforms, ListsWhatEachBinaryNeeds) {
  Workshop workshop;
  const auto dll = test::windows_dll({"KERNEL32.dll", "VCRUNTIME140.dll", "own.dll"}, {});
  const auto fmu =
      workshop.culprit("none", {{"binaries/win64/culprit.dll", dll}, {"binaries/win64/OWN.DLL", "brought along"}});
  Options options;
  options.run = false;
  const auto report = check_fmu(fmu, options);
  ASSERT_EQ(report.platforms.size(), 2U);
  EXPECT_EQ(report.platforms[0].folder, "linux64");
  EXPECT_THAT(report.platforms[0].glibc, HasSubstr("2."));
  EXPECT_EQ(report.platforms[1].folder, "win64");
  EXPECT_EQ(report.platforms[1].machine, "x86-64 Windows");
  EXPECT_THAT(report.platforms[1].missing, ElementsAre("VCRUNTIME140.dll"));
  EXPECT_THAT(to_text(report), HasSubstr("binaries/win64: x86-64 Windows, needs VCRUNTIME140.dll\n"));
  EXPECT_THAT(to_json(report), HasSubstr("\"machine\": \"x86-64 Windows\""));
}

TEST(CheckPlatforms, ListsWhatA32BitLibraryNeeds) {
  Workshop workshop;
  const auto library = test::elf32_library({"libc.so.6", "libgfortran.so.5"}, "GLIBC_2.17");
  const auto fmu = workshop.culprit("none", {{"binaries/linux32/culprit.so", library}});
  Options options;
  options.run = false;
  const auto report = check_fmu(fmu, options);
  ASSERT_EQ(report.platforms.size(), 2U);
  EXPECT_EQ(to_text(report.platforms[0]), "32-bit x86 Linux, glibc 2.17 or newer, needs libgfortran.so.5");
}

TEST(CheckPlatforms, ADamaged32BitLibraryIsNoCrash) {
  Workshop workshop;
  const auto whole = test::elf32_library({"libc.so.6"}, "GLIBC_2.17");
  Options options;
  options.run = false;
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    const auto fmu = workshop.culprit("none", {{"binaries/linux32/culprit.so", whole.substr(0, size)}});
    EXPECT_EQ(check_fmu(fmu, options).platforms[0].glibc, "") << size;
  }
}

TEST(CheckPlatforms, ABinaryInTheFolderOfAnotherPlatformIsAnError) {
  Workshop workshop;
  const auto fmu = workshop.culprit("none", {{"binaries/win32/culprit.dll", test::windows_dll({}, {})},
                                             {"binaries/aarch64-linux/culprit.so", "not a library"}});
  const auto found = findings(fmu, true);
  EXPECT_THAT(found, Contains(HasSubstr("error: binaries/win32/culprit.dll is for x86-64 Windows, but win32 means")));
  EXPECT_THAT(found, Contains(HasSubstr("binaries/aarch64-linux/culprit.so is no library of a known platform")));
}

TEST(CheckPlatforms, SaysWhyAnFmuForWindowsIsNotRun) {
  setenv("MEBOTS_WINE", "/no/such/wine", 1);
  Workshop workshop;
  const auto fmu = workshop.archive({{"modelDescription.xml", culprit_description("none")},
                                     {"binaries/win64/culprit.dll", test::windows_dll({}, {})}});
  const auto report = check_fmu(fmu, {});
  unsetenv("MEBOTS_WINE");
  const auto plain = std::ranges::find_if(
      report.checks, [](const Check& check) { return check.name.find("under wine") != std::string::npos; });
  ASSERT_NE(plain, report.checks.end());
  EXPECT_THAT(plain->skipped, HasSubstr("there is no file /no/such/wine"));
}

}  // namespace
}  // namespace mebots::check
