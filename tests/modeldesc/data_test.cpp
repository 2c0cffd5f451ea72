// SPDX-License-Identifier: Apache-2.0
// Tests the reader of JSON files: places, kinds, and the report of all mistakes at once.
#include "mebots/data/document.hpp"
#include "mebots/data/find_file.hpp"
#include "mebots/data/object.hpp"
#include "mebots/json_document.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include <chrono>
#include <limits>
#include <string>
#include <vector>

namespace mebots::data {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Calls `read` with the root of this text. Returns the code and the place of every mistake.
template <typename Read>
std::vector<std::pair<ErrorCode, std::string>> mistakes_of(std::string_view text, const Read& read) {
  std::vector<std::pair<ErrorCode, std::string>> found;
  try {
    Document document(text, "f.json");
    document.read(read);
  } catch (const Mistakes& mistakes) {
    for (const auto& mistake : mistakes.list()) found.emplace_back(mistake.code, mistake.place);
  }
  return found;
}

const auto kReadNothing = [](const Node& /*root*/) {};

struct Gate {
  std::string name = "none";
  double width_m = 1;
  std::vector<double> place_m;
};

Gate read_gate(const Node& node) {
  Gate gate;
  Object object(node);
  object.comment("text");
  object.read("name", gate.name, &Node::readable_text);
  object.read_if("width", gate.width_m, quantity("m", Limits::positive()));
  object.read_if("place", gate.place_m, numbers());
  object.finish();
  return gate;
}

TEST(Document, GivesValuesInTheOrderOfTheFile) {
  Document document(R"({"b": [1, -2, 3.5, 1e2], "a": {"text": "é\n", "on": true, "off": false, "none": null}})", "f");
  document.read([](const Node& root) {
    const auto members = root.members();
    ASSERT_EQ(members.size(), 2U);
    EXPECT_EQ(members[0].key, "b");
    const auto numbers = members[0].value.elements();
    ASSERT_EQ(numbers.size(), 4U);
    EXPECT_EQ(numbers[0].whole_number(0, 9), 1);
    EXPECT_EQ(numbers[1].whole_number(-9, 9), -2);
    EXPECT_EQ(numbers[2].number(), 3.5);
    EXPECT_EQ(numbers[3].whole_number(0, 100), 100) << "as a schema counts it, 1e2 is a whole number";
    const auto inner = root.at("a");
    EXPECT_EQ(inner.at("text").text(), "\xC3\xA9\n");
    EXPECT_TRUE(inner.at("on").flag());
    EXPECT_FALSE(inner.at("off").flag());
    EXPECT_EQ(inner.at("none").kind(), Kind::null);
    EXPECT_FALSE(inner.has("b"));
  });
}

TEST(Document, KeepsEveryWholeNumberOf64Bits) {
  Document document("[18446744073709551615, -9223372036854775808, 9223372036854775807]", "f");
  document.read([](const Node& root) {
    const auto numbers = root.elements();
    EXPECT_EQ(numbers[0].natural_number(), UINT64_MAX);
    EXPECT_EQ(numbers[1].whole_number(INT64_MIN, 0), INT64_MIN);
    EXPECT_EQ(numbers[2].whole_number(0, INT64_MAX), INT64_MAX);
    EXPECT_THROW(numbers[0].whole_number(0, INT64_MAX), Mistakes);
    EXPECT_THROW(numbers[1].natural_number(), Mistakes);
  });
}

TEST(Document, ReportsLineColumnAndPointerOfEachValue) {
  Document document(
      "\xEF\xBB\xBF{\n  \"\xC3\xA9\\\"/~\": [10,\n    {\"x\" : \"a\\\\\"}, tru"
      "e]\n}",
      "f.json");
  document.read([](const Node& root) {
    EXPECT_EQ(root.place(), "f.json:1:2: /");
    const auto list = root.members().at(0).value;
    EXPECT_EQ(list.place(), "f.json:2:3: /\xC3\xA9\"~1~0");
    EXPECT_EQ(list.elements()[0].place(), "f.json:2:13: /\xC3\xA9\"~1~0/0");
    EXPECT_EQ(list.elements()[1].at("x").place(), "f.json:3:6: /\xC3\xA9\"~1~0/1/x");
    EXPECT_EQ(list.elements()[2].place(), "f.json:3:20: /\xC3\xA9\"~1~0/2");
  });
}

TEST(Document, NamesTheNearestKnownPlaceOfAValue) {
  auto document = JsonDocument::of({{"a", {{"b", 1}}}, {"c", 2}}, "x.ssp", {{"/a", "part.xml:7"}});
  document.read([](const Node& root) {
    EXPECT_EQ(root.at("a").at("b").place(), "x.ssp: part.xml:7: /a/b");
    EXPECT_EQ(root.at("c").place(), "x.ssp: /c");
  });
}

TEST(Document, ReadsAValueAsItsText) {
  const auto listed = [](Document& document) {
    std::vector<std::string> values;
    document.read([&](const Node& root) {
      for (const auto& node : root.elements()) {
        values.push_back(std::string(node.is_integer_literal() ? "literal " : "") + node.shown() + " " +
                         std::to_string(static_cast<int>(node.kind())) + " " + node.pointer());
      }
    });
    return values;
  };
  constexpr std::string_view kText =
      R"([null, true, -3, 18446744073709551615, 3.0, -2.5, 1e300, "a\u00e9", [1, [2]], {"k": {"l": []}, "m": 4}])";
  Document text(kText, "f.json");
  auto value = JsonDocument::of(nlohmann::ordered_json::parse(kText), "f.json", {});
  EXPECT_EQ(listed(value), listed(text));
}

TEST(Document, ReadsNonFiniteNumbersAsNull) {
  auto document = JsonDocument::of(std::numeric_limits<double>::infinity(), "f.json", {});
  document.read([](const Node& root) { EXPECT_EQ(root.kind(), Kind::null); });
}

TEST(Document, RefusesWhatIsNotJsonAtTheCharacterWhereItEnds) {
  const auto place_of = [](std::string_view text) {
    const auto mistakes = mistakes_of(text, kReadNothing);
    return mistakes.size() == 1 && mistakes[0].first == ErrorCode::syntax_error ? mistakes[0].second : "accepted";
  };
  EXPECT_EQ(place_of(""), "f.json:1:1");
  EXPECT_EQ(place_of("{\"a\": 1,\n oops}"), "f.json:2:2");
  EXPECT_EQ(place_of("[1, 2"), "f.json:1:6");
  EXPECT_EQ(place_of("[1] 2"), "f.json:1:5");
  EXPECT_EQ(place_of("// no\n{}"), "f.json:1:1");
  EXPECT_EQ(place_of(std::string_view("{}\0{}", 5)), "f.json:1:3");
  EXPECT_EQ(place_of(std::string(101, '[')), "f.json:1:101");
  EXPECT_EQ(place_of("\"\xff\""), "f.json:1:2");
}

TEST(Document, RefusesNumbersThatNoDoubleHolds) {
  EXPECT_THAT(mistakes_of("{\"a\": [0,\n 1e999]}", kReadNothing),
              ElementsAre(std::pair(ErrorCode::value_out_of_range, "f.json:2:2")));
}

TEST(Document, ReportsEveryDuplicateKey) {
  EXPECT_THAT(mistakes_of(R"({"a": {"b": 1, "b": 2}, "c": 3, "a": 4})", kReadNothing),
              ElementsAre(std::pair(ErrorCode::duplicate_key, "f.json:1:16: /a/b"),
                          std::pair(ErrorCode::duplicate_key, "f.json:1:33: /a")));
}

TEST(Document, ReportsEveryDuplicateKeyAmongMany) {
  std::string text = "{";
  for (int i = 0; i < 30; ++i) text.append("\"").append(std::to_string(i % 27)).append("\": {\"x\": 0},\n");
  text += R"("x": 1})";
  EXPECT_THAT(mistakes_of(text, kReadNothing), ElementsAre(std::pair(ErrorCode::duplicate_key, "f.json:28:1: /0"),
                                                           std::pair(ErrorCode::duplicate_key, "f.json:29:1: /1"),
                                                           std::pair(ErrorCode::duplicate_key, "f.json:30:1: /2")));
}

TEST(Document, TakesTimeInProportionToItsLength) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](int values) {
    std::string text = "[";
    for (int i = 0; i < values; ++i) text += "{\"x\": \"some text\"},";
    text += "0]";
    const auto start = Clock::now();
    Document document(text, "f");
    document.read([](const Node& root) {
      for (const auto& element : root.elements()) static_cast<void>(element.place());
    });
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  seconds(1000);
  // Bounds the time. The text is 50 times as long: a linear reader takes 50 times as long, a quadratic reader 2500
  // times. The bound is ten times the linear time plus a tenth of a second, because the machine may be busy.
  EXPECT_LT(seconds(100'000), 500 * seconds(2000) + 0.1);
}

TEST(Object, ReportsAllMistakesOfAFileAtOnceInTheOrderOfTheFile) {
  const auto text = R"([
    {"name": "", "width": {"value": -1, "unit": "cm", "source": "", "sorce": "x"}},
    {"nmae": "b", "width": 3},
    7,
    {"name": "d", "place": [1, "2", null]}
  ])";
  EXPECT_THAT(mistakes_of(text, list_of(&read_gate)),
              ElementsAre(std::pair(ErrorCode::invalid_value, "f.json:2:6: /0/name"),
                          std::pair(ErrorCode::value_out_of_range, "f.json:2:28: /0/width/value"),
                          std::pair(ErrorCode::wrong_unit, "f.json:2:41: /0/width/unit"),
                          std::pair(ErrorCode::invalid_value, "f.json:2:55: /0/width/source"),
                          std::pair(ErrorCode::unknown_key, "f.json:2:69: /0/width/sorce"),
                          std::pair(ErrorCode::missing_key, "f.json:3:5: /1"),
                          std::pair(ErrorCode::unknown_key, "f.json:3:6: /1/nmae"),
                          std::pair(ErrorCode::wrong_type, "f.json:3:19: /1/width"),
                          std::pair(ErrorCode::wrong_type, "f.json:4:5: /2"),
                          std::pair(ErrorCode::wrong_type, "f.json:5:32: /3/place/1"),
                          std::pair(ErrorCode::wrong_type, "f.json:5:37: /3/place/2")));
}

TEST(Object, SuggestsTheNearestKnownKeyForAnUnknownOne) {
  Document document(R"({"nmae": "b"})", "f.json");
  try {
    document.read(&read_gate);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'nmae' is unknown. Did you mean 'name'?"));
    EXPECT_EQ(error.code(), ErrorCode::missing_key) << "of the first mistake";
  }
}

TEST(Object, LeavesAVariableAloneWhoseMemberIsWrongOrAbsent) {
  Gate gate;
  const auto read = [&](const Node& node) {
    Object object(node);
    EXPECT_FALSE(object.read("width", gate.width_m, number(Limits::at_least(5))));
    EXPECT_FALSE(object.sound());
    EXPECT_FALSE(object.read_if("name", gate.name, &Node::text));
  };
  EXPECT_EQ(mistakes_of(R"({"width": 2})", read).size(), 1U);
  EXPECT_EQ(gate.width_m, 1);
  EXPECT_EQ(gate.name, "none");
}

TEST(Object, WantsTablesThatRise) {
  const auto read = [](const Node& node) { return read_rising_numbers(node, Limits::at_least(0)); };
  EXPECT_THAT(mistakes_of("[0, 1, 1, 2]", read), ElementsAre(std::pair(ErrorCode::invalid_value, "f.json:1:8: /2")));
  EXPECT_THAT(mistakes_of("[]", read), ElementsAre(std::pair(ErrorCode::invalid_value, "f.json:1:1: /")));
  EXPECT_THAT(mistakes_of("[0, 1, 2]", read), testing::IsEmpty());
}

TEST(Object, AnswersAnUnknownWordByTheNearest) {
  Document document(R"("chekcer")", "f.json");
  try {
    document.read(word_of<int>({{"uniform", 0}, {"checker", 1}}));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unknown_name);
    EXPECT_THAT(error.what(), HasSubstr("Did you mean 'checker'?"));
  }
}

TEST(Mistakes, AreShownUpToTwentyAndCounted) {
  std::string text = "{";
  for (int i = 0; i < 25; ++i) text += "\"unknown" + std::to_string(i) + "\": 0,";
  text += "\"name\": \"x\"}";
  try {
    Document(text, "f.json").read(&read_gate);
    FAIL();
  } catch (const Mistakes& mistakes) {
    EXPECT_EQ(mistakes.list().size(), 25U);
    EXPECT_THAT(mistakes.what(), HasSubstr("\nand 5 more"));
  }
}

TEST(Mistakes, BehindAZeroByteAreShown) {
  try {
    Document(R"({"a\u0000b": 0, "unknown": 0, "name": "x"})", "f.json").read(&read_gate);
    FAIL();
  } catch (const Mistakes& mistakes) {
    EXPECT_THAT(mistakes.what(), AllOf(HasSubstr(R"('a\u0000b' is unknown)"), HasSubstr("'unknown' is unknown")));
  }
}

TEST(Text, HoldsNoZeroByte) {
  try {
    Document(R"({"name": "a.fmu\u0000x"})", "f.json").read(&read_gate);
    FAIL();
  } catch (const Mistakes& mistakes) {
    EXPECT_THAT(mistakes.what(),
                AllOf(HasSubstr("f.json:1:2: /name"), HasSubstr(R"("a.fmu\u0000x" contains a zero byte)")));
  }
}

TEST(FindFile, SuggestsTheNearestNameInTheFolder) {
  const std::filesystem::path cells = MEBOTS_SOURCE_DIR "/fmu_battery/params/cells";
  EXPECT_EQ(find_file(cells, "ufx_250", "cell.name"), cells / "ufx_250.json");
  try {
    find_file(cells, "ufx250", "cell.name");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unknown_name);
    EXPECT_THAT(error.what(), HasSubstr("'ufx_250'"));
  }
  EXPECT_THROW(find_file(cells, "ufx_250.json", "cell.name"), Error) << "a path, which is not there";
}

}  // namespace
}  // namespace mebots::data
