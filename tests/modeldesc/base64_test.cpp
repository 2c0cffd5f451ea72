// SPDX-License-Identifier: Apache-2.0
#include "mebots/base64.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mebots {
namespace {

std::string of(std::string_view text) {
  return encode_base64(std::vector<std::uint8_t>(text.begin(), text.end()));
}

TEST(Base64, GivesTheTestVectorsOfRfc4648) {
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(Base64, UsesTheLastTwoLettersOfTheStandardAlphabet) {
  EXPECT_EQ(encode_base64(std::vector<std::uint8_t>{0xfb, 0xff, 0xbf}), "+/+/");
}

TEST(Base64, DecodesTheTestVectorsOfRfc4648) {
  const std::vector<std::pair<std::string, std::string>> vectors{{"", ""},
                                                                 {"Zg==", "f"},
                                                                 {"Zm8=", "fo"},
                                                                 {"Zm9v", "foo"},
                                                                 {"Zm9vYg==", "foob"},
                                                                 {"Zm9vYmE=", "fooba"},
                                                                 {"Zm9vYmFy", "foobar"}};
  std::vector<std::uint8_t> bytes;
  for (const auto& [text, plain] : vectors) {
    EXPECT_TRUE(decode_base64(text, bytes)) << text;
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), plain);
  }
  for (const auto* bad : {"Z", "Zg=", "Z===", "Zg==Zg==", "Z?==", "Zg=a"})
    EXPECT_FALSE(decode_base64(bad, bytes)) << bad;
}

}  // namespace
}  // namespace mebots
