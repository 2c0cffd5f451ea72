// SPDX-License-Identifier: Apache-2.0
#include "mebots/error.hpp"

#include <gtest/gtest.h>

#include <set>

namespace mebots {
namespace {

class Refusal : public Error {
 public:
  using Error::Error;
};

TEST(Error, CarriesCodeAndTextThroughTheBaseClass) {
  try {
    throw Refusal(ErrorCode::unknown_key, "config.json: 'stp'");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unknown_key);
    EXPECT_STREQ(error.what(), "config.json: 'stp'");
  }
}

TEST(Error, HasNoCodeIfItHasOnlyAText) {
  EXPECT_EQ(Error("text").code(), ErrorCode::unspecified);
}

TEST(ErrorCode, HasANameOfItsOwnThatLeadsBackToIt) {
  std::set<std::string_view> names;
  for (const ErrorCodeRow& row : kErrorCodes) {
    EXPECT_EQ(name_of(row.code), row.name);
    EXPECT_EQ(error_code_of(row.name), row.code);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_FALSE(row.meaning.empty()) << row.name;
  }
  EXPECT_EQ(name_of(ErrorCode::state_of_other_build), "state_of_other_build");
  EXPECT_EQ(error_code_of("no_such_code"), std::nullopt);
}

}  // namespace
}  // namespace mebots
