// SPDX-License-Identifier: Apache-2.0
// Tests lists of third-party parts, and their bill of materials.
#include "generate.hpp"
#include "mebots/error.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "pack_fmu.hpp"

#include <gmock/gmock.h>

#include <cstdlib>

namespace mebots::modeldesc {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::vector<Part> read(const std::string& text) {
  const TemporaryFolder folder("mebots-test");
  write_text_file(folder.path() / "parts.txt", text);
  return read_parts(folder.path() / "parts.txt");
}

TEST(Parts, AreReadLineByLine) {
  const auto parts = read("linked|one|1.0|MIT|pkg:deb/debian/one@1.0|/usr/one\nbundled|two||||\n");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].license, "MIT");
  EXPECT_EQ(parts[0].text, "/usr/one");
  EXPECT_EQ(parts[1].name, "two");
  EXPECT_TRUE(parts[1].version.empty());
  EXPECT_TRUE(read("").empty());
}

TEST(Parts, AMistakeIsNamedWithItsLine) {
  for (const std::string line : {"linked|one", "stolen|one|1|MIT||", "linked||1|MIT||", "linked|one|1|MIT|||"}) {
    try {
      read("needed|zero|0|MIT||\n" + line + "\n");
      ADD_FAILURE() << line;
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("parts.txt:2"), HasSubstr(line)));
    }
  }
}

TEST(Spdx, TheSamePartsInAnyOrderGiveTheSameBytes) {
  const Part one{"linked", "lib++", "1", "MIT", "pkg:deb/debian/lib@1", {}};
  const Part two{"needed", "other", "2", "", "", {}};
  const Product product{"it", "0.1", "Apache-2.0"};
  const auto text = spdx_document(product, {one, two});
  EXPECT_EQ(spdx_document(product, {two, one, one}), text);
  EXPECT_NE(spdx_document(product, {one}), text);
  EXPECT_THAT(text, AllOf(HasSubstr("SPDXRef-Package-lib--"), HasSubstr("STATIC_LINK"), HasSubstr("DEPENDS_ON"),
                          HasSubstr("NOASSERTION"), HasSubstr("1980-01-01T00:00:00Z")));
}

TEST(Spdx, TakesItsTimeFromTheBuildsEpoch) {
  setenv("SOURCE_DATE_EPOCH", "1000000000", 1);
  EXPECT_THAT(spdx_document({"it", "", ""}, {}), HasSubstr("2001-09-09T01:46:40Z"));
  setenv("SOURCE_DATE_EPOCH", "yesterday", 1);
  EXPECT_THROW(spdx_document({"it", "", ""}, {}), Error);
  unsetenv("SOURCE_DATE_EPOCH");
}

}  // namespace
}  // namespace mebots::modeldesc
