// SPDX-License-Identifier: Apache-2.0
#include "generate.hpp"

#include <gtest/gtest.h>

namespace mebots::modeldesc {
namespace {

TEST(CppNames, StructuredNamesFollowFmisGrammar) {
  for (const char* name : {"a", "cell.voltage", "rotor[1].thrust", "m[1,22].x_1", "_a"})
    EXPECT_TRUE(is_structured_name(name)) << name;
  for (const char* name :
       {"", ".", "a.", ".a", "a..b", "1a", "a b", "a[]", "a[1", "a[1,]", "a[x]", "a]", "a[1]b", "\xC3\xA9"})
    EXPECT_FALSE(is_structured_name(name)) << name;
}

TEST(CppNames, IdentifiersAreNoKeywords) {
  EXPECT_TRUE(is_cpp_identifier("classy"));
  EXPECT_FALSE(is_cpp_identifier("class"));
  EXPECT_FALSE(is_cpp_identifier("a.b"));
  EXPECT_FALSE(is_cpp_identifier(""));
  EXPECT_TRUE(is_cpp_namespace("mebots::lag"));
  EXPECT_FALSE(is_cpp_namespace("mebots::"));
  EXPECT_FALSE(is_cpp_namespace("mebots:lag"));
  EXPECT_FALSE(is_cpp_namespace("mebots::class"));
}

TEST(CppNames, MarksBecomeOneUnderscore) {
  EXPECT_EQ(to_cpp_name("rotor[1].thrust"), "rotor_1_thrust");
  EXPECT_EQ(to_cpp_name("m[1,2]"), "m_1_2");
}

TEST(CppNames, LiteralsCompileToTheSameText) {
  EXPECT_EQ(cpp_literal("a \"b\" \\ \n"), R"("a \"b\" \\ \012")");
}

}  // namespace
}  // namespace mebots::modeldesc
