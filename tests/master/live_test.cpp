// SPDX-License-Identifier: Apache-2.0
#include "server.hpp"
#include "test_system.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mebots::test {
namespace {

TEST(LiveServer, EndsThoughItIsOverBeforeItsThreadListens) {
  for (int i = 0; i < 20; ++i) {
    const live::LiveRun::Server server(0, {});
    EXPECT_EQ(server.address().rfind("http://127.0.0.1:", 0), 0u);
  }
}

TEST(LiveRun, TellsItsAddressEvenWhenQuiet) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  write_file(folder.path() / "one.json",
             with_probe(R"({"step": 0.1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}, "connections": []})"));
  const auto done = run_program({"run", "one.json", "--live", "--quiet"}, folder.path());
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.out, testing::MatchesRegex("live: http://127.0.0.1:[0-9]+/[0-9a-f]+/\n"));
}

}  // namespace
}  // namespace mebots::test
