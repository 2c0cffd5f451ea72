// SPDX-License-Identifier: Apache-2.0
// Tests callbacks with invalid arguments of an FMU.
#include "fmi/call/callbacks.hpp"
#include "message/message_text.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <dlfcn.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdarg>
#include <cstring>
#include <string>
#include <utility>

namespace mebots::master {
namespace {

using test::TestRun;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string format(const char* text, ...) {
  std::va_list arguments;
  va_start(arguments, text);
  auto result = format_text(text, arguments);
  va_end(arguments);
  return result;
}

class Ignoring final : public CallbackListener {
 public:
  void logged(LoggerCall /*call*/) override {}
  void step_finished(int /*status*/) override {}
};

/// If the end of a step belongs to no known instance, only the FMU whose library made the call counts it. Other runs in
/// the same process must not be affected.
TEST(Callbacks, AStepEndOfNoKnownInstanceCountsForTheLibraryThatCalled) {
  Ignoring listener;
  CallbackTarget of_caller(listener, "a");
  CallbackTarget of_another(listener, "b");
  Dl_info info{};
  void* caller = nullptr;
  ASSERT_NE(dladdr1(reinterpret_cast<const void*>(&format), &info, &caller, RTLD_DL_LINKMAP), 0);
  of_caller.set_library(caller);
  of_another.set_library(&listener);
  CallbackTarget::fmi1_functions(true).stepFinished(nullptr, fmiOK);
  EXPECT_EQ(of_caller.dropped_step_ends(), 1U);
  EXPECT_EQ(of_another.dropped_step_ends(), 0U);
}

TEST(Callbacks, AStepEndFromAnUnknownLibraryCountsForAllInstances) {
  Ignoring listener;
  CallbackTarget first(listener, "a");
  CallbackTarget second(listener, "b");
  first.set_library(&first);
  second.set_library(&second);
  CallbackTarget::fmi1_functions(true).stepFinished(nullptr, fmiOK);
  EXPECT_EQ(first.dropped_step_ends(), 1U);
  EXPECT_EQ(second.dropped_step_ends(), 1U);
}

TEST(FormatText, GivesWhatPrintfGives) {
  const auto check = [](const char* text, auto... arguments) {
    char expected[500];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
#pragma GCC diagnostic ignored "-Wformat-security"
    std::snprintf(expected, sizeof expected, text, arguments...);
#pragma GCC diagnostic pop
    EXPECT_EQ(format(text, arguments...), expected) << text;
  };
  check("plain");
  check("%d|%5d|%-5d|%05d|%+d|% d|%i", 1, 2, 3, 4, 5, 6, -7);
  check("%u %x %#X %o %hhd %hd", 1U, 255U, 255U, 8U, 3, 4);
  check("%ld %lld %zu %jd %td %lu", -1L, -2LL, std::size_t{3}, std::intmax_t{-4}, std::ptrdiff_t{-5}, ~0UL);
  check("%f %.2f %e %g %G %10.3g|%-10g| %a", 1.5, 2.25, 3.5, 1e-7, 1e20, 4.5, 5.5, 0.1);
  check("%Lf %.3Lg", 1.5L, 2.5L);
  check("%s|%10s|%-10s|%.2s|%c|%%", "text", "right", "left", "cut", 'c');
  check("%*d|%-*d|%.*f", 5, 1, 6, 2, 3, 1.0 / 3);
  check("%p", static_cast<void*>(nullptr));
}

TEST(FormatText, AFormatThatDoesNotFitItsArgumentsIsSurvived) {
  int written = 17;
  EXPECT_EQ(format("%n!", &written), "%n!");
  EXPECT_EQ(written, 17);
  EXPECT_EQ(format("%s", reinterpret_cast<const char*>(16)), "(unreadable)");
  EXPECT_EQ(format("%s", static_cast<const char*>(nullptr)), "(null)");
  EXPECT_EQ(format("%1$s %d", 1), "%1$s %d");
  EXPECT_EQ(format("%d %y %d", 1), "1 %y %d");
  EXPECT_EQ(format("%"), "%");
  EXPECT_EQ(format("%ls.", L"wide"), "(wide text).");
  EXPECT_LE(format("%999999999d|%.999999999f", 1, 1.0).size(), 3000U);
}

template <std::size_t... number>
std::string format_numbers(const char* text, std::index_sequence<number...> /*all*/) {
  return format(text, static_cast<int>(number)...);
}

TEST(FormatText, HasNoMoreConversionsThanAreSensible) {
  std::string many;
  for (int i = 0; i < 1000; ++i) many += "%d ";
  // If a missing argument were read, the address sanitizer would detect it.
  const auto text = format_numbers(many.c_str(), std::make_index_sequence<101>());
  EXPECT_THAT(text, AllOf(StartsWith("0 1 2 "), HasSubstr(" 98 99 %d %d "), Not(HasSubstr("100"))));
}

TEST(ReadText, ATextThatEndsWithItsPageIsReadAndOneThatContinuesIsNot) {
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  auto* pages = static_cast<char*>(mmap(nullptr, 2 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(pages, MAP_FAILED);
  mprotect(pages + page, page, PROT_NONE);
  std::memset(pages, 'x', page);
  EXPECT_FALSE(read_text(pages + page - 3));
  EXPECT_EQ(read_text(pages + page - 3, 3), "xxx");
  pages[page - 1] = '\0';
  EXPECT_EQ(read_text(pages + page - 3), "xx");
  EXPECT_EQ(read_text(pages)->size(), page - 1);
  munmap(pages, 2 * page);
}

TEST(PlainText, BytesThatAreNotUtf8AreReplacedOneByOne) {
  EXPECT_EQ(valid_utf8("caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80"), "caf\xc3\xa9 \xe2\x82\xac \xf0\x9f\x98\x80");
  EXPECT_EQ(valid_utf8("caf\xe9!"), "caf\xef\xbf\xbd!");
  EXPECT_EQ(valid_utf8("\xc0\xaf"), "\xef\xbf\xbd\xef\xbf\xbd");                  // overlong form
  EXPECT_EQ(valid_utf8("\xed\xa0\x80"), "\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");  // surrogate
  EXPECT_EQ(valid_utf8("\xe2\x82"), "\xef\xbf\xbd\xef\xbf\xbd");                  // truncated character
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80").size(), 12U);                          // above U+10FFFF
}

TEST(PlainText, RemovesAllControlCharactersOfTerminals) {
  EXPECT_EQ(one_line("a\nb\r\tc\x1b[31m\x7f\xc2\x9b é"), "a\\nb\\r\\tc\\x1b[31m\\x7f\\u009b é");
  EXPECT_EQ(one_line(std::string_view("\0", 1)), "\\x00");
}

TEST(PlainText, FurtherLinesAreIndented) {
  EXPECT_EQ(indented_lines("cell.json: 2 mistakes\n  a: missing\r\n\nb:\tmissing\n"),
            "cell.json: 2 mistakes\n      a: missing\n    b:\\tmissing");
  EXPECT_EQ(indented_lines("one"), "one");
  EXPECT_EQ(indented_lines("\n"), "");
}

TEST(PlainText, FurtherLinesOfAMessageAreNoMessages) {
  EXPECT_EQ(message_text({"a", Severity::warning, "", "one\n[    2.000 s] b: two\n", 1'000'000'000}),
            "[    1.000 s] a: warning: one\n    [    2.000 s] b: two");
}

std::vector<std::string> said(const std::string& fault, const std::string& more = "") {
  TestRun run(fmt::format(R"({{"step": 0.1, "stop_time": 0.2, "connections": [], "instances": {{
    "other": {{"fmu": "PROBE"{0}}}, "a": {{"fmu": "PROBE", "parameters": {{"fault": "{1}", "fault_time": 0.1}}{0}}}}}}})",
                          more, fault));
  run.initialize();
  run.simulation().step();
  return run.messages.lines;
}

class Callbacks : public testing::TestWithParam<const char*> {};

TEST_P(Callbacks, AMessageWithAForeignEnvironmentBelongsToTheInstanceThatIsCalled) {
  EXPECT_THAT(said("log_foreign", GetParam()),
              AllOf(Contains("a/logStatusWarning: foreign environment"), Contains("a/logStatusWarning: no environment"),
                    Contains("a/logStatusWarning: a name that cannot be read")));
}

TEST_P(Callbacks, AThreadOfAnFmuIsHeardByItsEnvironmentOrItsName) {
  const auto lines = said("log_thread", GetParam());
  EXPECT_THAT(lines, AllOf(Contains("a/logStatusWarning: own environment"),
                           Contains("a/logStatusWarning: foreign environment")));
}

TEST_P(Callbacks, HostileFormatsAreShownAndNotObeyed) {
  EXPECT_THAT(said("log_format", GetParam()),
              AllOf(Contains("a/: (unreadable) and %n and     7"), Contains(HasSubstr("1|%y|%d")),
                    Contains("a/: (a message whose text cannot be read)"), Contains("a/: (a message without a text)")));
}

TEST_P(Callbacks, TextsBecomeValidUtf8) {
  EXPECT_THAT(said("log_bytes", GetParam()), Contains("a/logStatusWarning: caf\xef\xbf\xbd \x1b[2J two\nlines"));
}

INSTANTIATE_TEST_SUITE_P(SharedAndOwnProcess, Callbacks, testing::Values("", R"(, "process": "own")"));

TEST(CallbacksOfTheProgram, ControlCharactersAreEscapedAndErrorsThrottled) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto run = [&](const std::string& fault) {
    test::write_file(
        folder.path() / "c.json",
        test::with_probe(fmt::format(
            R"({{"step": 0.01, "stop_time": 1, "connections": [], "instances": {{"a": {{"fmu": "PROBE", "parameters": {{"fault": "{}", "fault_time": 0.1}}}}}}}})",
            fault)));
    return test::run_program({"run", "c.json", "--out", "out"}, folder.path());
  };
  const auto bytes = run("log_bytes");
  EXPECT_EQ(bytes.code, 0);
  EXPECT_THAT(bytes.err, AllOf(HasSubstr("\\x1b[2J two\n    lines"), Not(HasSubstr("\x1b"))));
  EXPECT_THAT(test::read_file(folder.path() / "out" / "log.txt"),
              AllOf(HasSubstr("\\x1b[2J two\n    lines"), Not(HasSubstr("\x1b"))));
  const auto errors = run("log_errors");
  EXPECT_EQ(errors.code, 0);
  std::size_t shown = 0;
  for (auto at = errors.err.find("all the same"); at != std::string::npos; at = errors.err.find("all the same", at + 1))
    ++shown;
  EXPECT_EQ(shown, 20U);
  EXPECT_THAT(errors.err, HasSubstr("a: more errors follow; they are in log.txt only"));
}

}  // namespace
}  // namespace mebots::master
