// SPDX-License-Identifier: Apache-2.0
#include "mebots/nearest_names.hpp"

#include <gmock/gmock.h>

#include <vector>

namespace mebots {
namespace {

const std::vector<std::string> kNames = {"step", "stop_time", "instances", "connections", "cell.voltage"};

TEST(NearestNames, DistanceCountsEdits) {
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("Step", "sTEP"), 0u);
  EXPECT_EQ(edit_distance("setp", "step"), 1u);  // two neighbours are swapped
}

TEST(NearestNames, ANameIsNearUpToAThirdOfItsLength) {
  const std::vector<std::string> known = {"abcdefghi"};
  EXPECT_EQ(suggest("xyzdefghi", known), "Did you mean 'abcdefghi'?");
  EXPECT_EQ(suggest("badcfeghi", known), "Did you mean 'abcdefghi'?");  // three swaps
  EXPECT_EQ(suggest("xyzuefghi", known), "Known are 'abcdefghi'.");
  EXPECT_EQ(suggest("abcdefghi_jklm", known), "Did you mean 'abcdefghi'?");
}

TEST(NearestNames, ATypoIsAnsweredByTheNameThatWasMeant) {
  EXPECT_EQ(suggest("conections", kNames), "Did you mean 'connections'?");
  EXPECT_EQ(suggest("Instances", kNames), "Did you mean 'instances'?");
}

TEST(NearestNames, APartOfANameIsAnsweredByTheWholeName) {
  EXPECT_EQ(suggest("voltage", kNames), "Did you mean 'cell.voltage'?");
}

TEST(NearestNames, ListsAllNamesIfNoneIsNear) {
  EXPECT_EQ(suggest("xyzzy", std::vector<std::string>{"a1", "b2"}), "Known are 'a1', 'b2'.");
  EXPECT_EQ(suggest("x", std::vector<std::string>{}), "There are none.");
}

TEST(NearestNames, ALongListIsCutShort) {
  std::vector<std::string> many;
  for (int i = 0; i < 100; ++i) many.push_back("variable_" + std::to_string(i));
  EXPECT_THAT(suggest("q", many), testing::EndsWith("and 88 more."));
}

}  // namespace
}  // namespace mebots
