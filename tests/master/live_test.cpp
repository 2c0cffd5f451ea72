// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"

#include <gtest/gtest.h>

namespace mebots::test {
namespace {

TEST(LiveServer, EndsThoughItIsOverBeforeItsThreadListens) {
  for (int i = 0; i < 20; ++i) {
    const live::LiveRun::Server server(0, {});
    EXPECT_EQ(server.address().rfind("http://127.0.0.1:", 0), 0u);
  }
}

}  // namespace
}  // namespace mebots::test
