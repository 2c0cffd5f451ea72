// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include "mebots/error.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace mebots::check {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(CheckArchive, ASoundOneHasNoFindings) {
  Workshop workshop;
  EXPECT_THAT(findings(workshop.culprit("none", {{"resources/a.txt", "a"}, {"documentation/index.html", "b"}})),
              IsEmpty());
}

TEST(CheckArchive, NamesThatHarmAreFound) {
  Workshop workshop;
  const auto of = [&](const std::string& name) { return findings(workshop.culprit("none", {{name, "x"}})); };
  EXPECT_THAT(of("resources/../../evil"), Contains(HasSubstr("would leave the folder")));
  EXPECT_THAT(of("resources\\windows.txt"), Contains(HasSubstr("backslash")));
  EXPECT_THAT(of("/etc/passwd"), Contains(HasSubstr("absolute path")));
  EXPECT_THAT(of("C:/autoexec.bat"), Contains(HasSubstr("absolute path")));
  EXPECT_THAT(of("link:resources/link"), Contains(HasSubstr("symbolic link")));
  EXPECT_THAT(of("MODELDESCRIPTION.XML"), Contains(HasSubstr("differ only in capitals")));
  EXPECT_THAT(of("stuff/a.txt"), Contains(HasSubstr("not part of an FMU in FMI 2.0")));
  EXPECT_THAT(of("./modelDescription.xml"), Contains(HasSubstr("occurs twice")));
}

TEST(CheckArchive, FoldersOfLaterEditionsOfTheStandardAreKnown) {
  Workshop workshop;
  EXPECT_THAT(findings(workshop.culprit("none", {{"extra/org.example/a.txt", "a"}, {"terminalsAndIcons/b.xml", "b"}})),
              IsEmpty());
}

TEST(CheckArchive, ADescriptionInAFolderIsPointedAt) {
  Workshop workshop;
  EXPECT_THAT(findings(workshop.archive({{"culprit/modelDescription.xml", culprit_description("none")}})),
              Contains(HasSubstr("modelDescription.xml is not at the root of the archive")));
}

TEST(CheckArchive, ABombIsFoundWithoutUnpackingIt) {
  Workshop workshop;
  const std::string zeros(32U << 20, '\0');
  EXPECT_THAT(findings(workshop.culprit("none", {{"resources/zeros", zeros}})), Contains(HasSubstr("bomb")));
}

TEST(CheckArchive, SomethingElseThanAnArchiveCannotBeRead) {
  modeldesc::TemporaryFolder folder("mebots-check-test");
  const auto file = folder.path() / "text.fmu";
  std::ofstream(file) << "this is not an archive";
  EXPECT_THROW(check_fmu(file, {}), Error);
  EXPECT_THROW(check_fmu(folder.path() / "missing.fmu", {}), Error);
}

}  // namespace
}  // namespace mebots::check
