// SPDX-License-Identifier: Apache-2.0
#include "io/config/command_line.hpp"
#include "io/config/load_system.hpp"
#include "model/system_description.hpp"
#include "test_system.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <ctime>

namespace mebots::master {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

/// Reads a config from a text. "PROBE" is replaced by the path of the probe FMU.
SystemDescription read(const std::string& text) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto file = folder.path() / "mission.json";
  test::write_file(file, test::with_probe(text));
  return read_config(file);
}

std::string reading_error(const std::string& text) {
  return test::input_error([&] { read(text); });
}

/// Returns a valid config with an additional line.
std::string config_with(const std::string& line, const std::string& instance = R"("a": {"fmu": "PROBE"})",
                        const std::string& step = R"("step": 0.1, "stop_time": 2)") {
  return fmt::format(R"({{{} {}, "instances": {{{}}}, "connections": []}})", line, step, instance);
}

TEST(Config, TheSmallestConfigIsRead) {
  const auto system = read(config_with(""));
  EXPECT_EQ(system.step, (ExactTime{1, 10}));
  EXPECT_EQ(system.stop_time_ns, 2'000'000'000);
  ASSERT_EQ(system.instances.size(), 1u);
  EXPECT_EQ(system.instances[0].name, "a");
  EXPECT_EQ(system.instances[0].steps, 1);
  EXPECT_EQ(system.name, "mission");
}

std::string repeated(const std::string& instances, const std::string& connections = "") {
  return fmt::format(R"({{"step": 0.1, "stop_time": 2, "instances": {{{}}}, "connections": [{}]}})", instances,
                     connections);
}

TEST(Config, ARepeatedEntryHasACopyForEachNumber) {
  const auto system = read(repeated(
      R"("p[{i}]": {"repeat": {"i": [1, 3]}, "fmu": "PROBE", "parameters": {"gain": "{i}", "string_in": "no. {i+1}"}})",
      R"({"repeat": {"i": [2, 3]}, "from": "p[{i-1}].real_out", "to": "p[{i}].real_in"})"));
  ASSERT_EQ(system.instances.size(), 3u);
  EXPECT_EQ(system.instances[2].name, "p[3]");
  EXPECT_EQ(std::get<std::int64_t>(system.instances[2].parameters[0].value), 3);
  EXPECT_EQ(std::get<std::string>(system.instances[2].parameters[1].value), "no. 4");
  ASSERT_EQ(system.connections.size(), 2u);
  EXPECT_EQ(system.connections[1].from.instance, "p[2]");
  EXPECT_EQ(system.connections[1].to.instance, "p[3]");
}

TEST(Config, SeveralIndexesGiveAllCombinations) {
  const auto system = read(repeated(
      R"("p[{i}]{side}": {"repeat": {"i": [0, 1], "k": {"side": ["left", "right"], "gain": [0.5, 2]}}, "fmu": "PROBE",
          "parameters": {"gain": "{gain}"}})"));
  ASSERT_EQ(system.instances.size(), 4u);
  EXPECT_EQ(system.instances[1].name, "p[0]right");
  EXPECT_EQ(system.instances[2].name, "p[1]left");
  EXPECT_EQ(std::get<double>(system.instances[2].parameters[0].value), 0.5);
}

TEST(Config, ATableGivesACopyForEachRow) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto file = folder.path() / "mission.json";
  test::write_file(folder.path() / "drones.csv", "gain, label\n0.5, first\n2, second\n");
  test::write_file(file, test::with_probe(repeated(
                             R"("p[{i}]": {"repeat": {"i": "drones.csv"}, "fmu": "PROBE",
                                 "parameters": {"gain": "{gain}", "string_in": "{label}"}})")));
  const auto system = read_config(file);
  ASSERT_EQ(system.instances.size(), 2u);
  EXPECT_EQ(system.instances[1].name, "p[2]");
  EXPECT_EQ(std::get<std::int64_t>(system.instances[1].parameters[0].value), 2);
  EXPECT_EQ(std::get<std::string>(system.instances[1].parameters[1].value), "second");
  EXPECT_THAT(system.source, HasSubstr("0.5, first"));  // includes the table in the hash of the inputs
}

/// Reads a config with an entry that is repeated for each row of a table.
SystemDescription repeated_for_rows(const std::string& table, const std::string& entry) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto file = folder.path() / "mission.json";
  test::write_file(folder.path() / "rows.csv", table);
  test::write_file(file, test::with_probe(repeated(entry)));
  return read_config(file);
}

TEST(Config, ACellWithLeadingZerosIsText) {
  const auto system =
      repeated_for_rows("id, mass\n007, 1.50\n-010, 0.5\n", R"("p{id}": {"repeat": {"i": "rows.csv"}, "fmu": "PROBE",
      "parameters": {"string_in": "{id}", "gain": "{mass}", "text": "{mass} kg"}})");
  EXPECT_EQ(system.instances[0].name, "p007");
  EXPECT_EQ(std::get<std::string>(system.instances[0].parameters[0].value), "007");
  EXPECT_EQ(std::get<double>(system.instances[0].parameters[1].value), 1.5);
  EXPECT_EQ(std::get<std::string>(system.instances[0].parameters[2].value), "1.50 kg");
  EXPECT_EQ(std::get<std::string>(system.instances[1].parameters[0].value), "-010");
}

TEST(Config, ARepeatKeepsAllDigitsOfLargeNumbers) {
  const auto system =
      repeated_for_rows("n\n18446744073709551615\n", R"("p[{i}]": {"repeat": {"i": "rows.csv"}, "fmu": "PROBE",
      "parameters": {"a": "{n}"}}, "q[{i}]": {"repeat": {"i": {"n": [9223372036854775808]}}, "fmu": "PROBE", "parameters": {"a": "{n}"}})");
  ASSERT_EQ(system.instances.size(), 2u);
  EXPECT_EQ(std::get<UntypedText>(system.instances[0].parameters[0].value).text, "18446744073709551615");
  EXPECT_EQ(std::get<UntypedText>(system.instances[1].parameters[0].value).text, "9223372036854775808");
  EXPECT_THAT(test::input_error([] {
                repeated_for_rows("n\n9223372036854775808\n",
                                  R"("p[{n-1}]": {"repeat": {"i": "rows.csv"}, "fmu": "PROBE"})");
              }),
              HasSubstr("the sum exceeds 64 bits"));
  EXPECT_THAT(test::input_error([] {
                repeated_for_rows("n\n18446744073709551615\n",
                                  R"("p[{n+1}]": {"repeat": {"i": "rows.csv"}, "fmu": "PROBE"})");
              }),
              HasSubstr("the sum exceeds 64 bits"));
}

TEST(Config, AColumnNamedLikeTheIndexIsRefused) {
  EXPECT_THAT(test::input_error([] {
                repeated_for_rows("i, mass\n7, 1\n", R"("p[{i}]": {"repeat": {"i": "rows.csv"}, "fmu": "PROBE"})");
              }),
              AllOf(HasSubstr("/instances/p[{i}]/repeat/i"), HasSubstr("there are two values i")));
}

TEST(Config, RepeatsInsideRepeatsAreLimitedTogether) {
  std::string condition = R"("variable": "a.real_out", "above": 1)";
  for (int depth = 0; depth < 6; ++depth) {
    condition = fmt::format(R"("all": [{{"repeat": {{"i{}": [1, 100000]}}, {}}}])", depth, condition);
  }
  EXPECT_THAT(reading_error(config_with(fmt::format(R"("stop_when": [{{{}}}],)", condition))),
              HasSubstr("more than 500000 copies of all entries together"));
}

TEST(Config, MistakesInRepeatedEntriesNameThePlaceAndTheCopy) {
  const auto error = [](const std::string& repeat, const std::string& name = "p[{i}]", const std::string& rest = "") {
    return reading_error(repeated(fmt::format(R"("{}": {{"repeat": {}, "fmu": "PROBE"{}}})", name, repeat, rest)));
  };
  EXPECT_THAT(error(R"({"i": [3, 1]})"), HasSubstr("/instances/p[{i}]/repeat/i/1"));
  EXPECT_THAT(error(R"({"i": [3]})"), HasSubstr("[first, last]"));
  EXPECT_THAT(error("{}"), HasSubstr("name an index"));
  EXPECT_THAT(error(R"({"1": [1, 2]})"), HasSubstr("cannot be in braces"));
  EXPECT_THAT(error(R"({"i": [1, 2]})", "p"), HasSubstr("two entries are named 'p'"));
  EXPECT_THAT(error(R"({"i": {"a": [1, 2], "b": [1]}})"), HasSubstr("this list has 1 values"));
  EXPECT_THAT(error(R"({"i": "none.csv"})"), HasSubstr("there is no file"));
  EXPECT_THAT(error(R"({"i": [1, 1000], "j": [1, 1000]})"), HasSubstr("more than 100000 copies"));
  EXPECT_THAT(error(R"({"i": [1, 2]})", "p[{k}]"), HasSubstr("the repeat has no k; it has i"));
  EXPECT_THAT(error(R"({"i": {"a": ["gain", "gain"], "b": ["ratio", "gain"]}})", "p[{i}]",
                    R"(, "parameters": {"{a}": 1, "{b}": 2})"),
              AllOf(HasSubstr("/instances/p[{i}]"), HasSubstr("two keys of one copy become 'gain'")));
  EXPECT_THAT(reading_error(config_with(
                  R"("stop_when": [{"repeat": {"i": {"a": ["for"], "b": ["for"]}}, "{a}": 1, "{b}": 2, "all": [
                     {"repeat": {"k": [1, 2]}, "variable": "a.real_out", "above": "{k}"}]}],)")),
              AllOf(HasSubstr("/stop_when/0"), HasSubstr("two keys of one copy become 'for'")));
  EXPECT_THAT(error(R"({"mass": {"mass": [0.03, 0.031]}})", "p{mass}"), HasSubstr("there are two values mass"));
  EXPECT_THAT(error(R"({"i": [1, 2]})", "p[{i}]", R"(, "steep": 1)"),
              AllOf(HasSubstr("mission.json: 1:"), HasSubstr("i = 2"), HasSubstr("step")));
  EXPECT_THAT(reading_error(repeated(R"("a": {"fmu": "PROBE"})",
                                     R"({"repeat": {"i": [1, 2]}, "from": "a.real_out", "to": "b[{i}].real_in"})")),
              AllOf(HasSubstr("/connections/0, i = 1"), HasSubstr("b[1]")));
}

TEST(Config, AGroupNamesWhatSeveralEntriesRepeat) {
  const auto system = read(R"({"step": 0.1, "stop_time": 2,
    "groups": {"pair": {"i": [1, 2]}, "wheels": ["pair", {"k": {"side": ["left", "right"]}}]},
    "instances": {"p[{i}]": {"repeat": "pair", "fmu": "PROBE"}, "w[{i}]{side}": {"repeat": "wheels", "fmu": "PROBE"},
      "hub": {"fmu": "PROBE", "parameters": [{"gain": 2}, {"repeat": "pair", "pad[{i}]": "{i}"}]}},
    "connections": [{"repeat": "pair", "from": "p[{i}].real_out", "to": "w[{i}]left.real_in"}],
    "view": {"marks": ["w*left", "hub"],
             "panels": [{"title": "out", "curves": [{"repeat": "wheels", "variable": "w[{i}]{side}.real_out"}]}]}})");
  ASSERT_EQ(system.instances.size(), 7u);
  EXPECT_EQ(system.instances[5].name, "w[2]right");
  const auto& parameters = system.instances[6].parameters;
  ASSERT_EQ(parameters.size(), 3u);
  EXPECT_EQ(parameters[2].variable, "pad[2]");
  EXPECT_EQ(std::get<std::int64_t>(parameters[2].value), 2);
  EXPECT_THAT(parameters[2].place, HasSubstr("i = 2"));
  ASSERT_EQ(system.view.panels[0].curves.size(), 4u);
  EXPECT_EQ(system.view.panels[0].curves[3].variable.text(), "w[2]right.real_out");
  EXPECT_EQ(system.view.marks, (std::vector<std::string>{"w[1]left", "w[2]left", "hub"}));
}

TEST(Config, ConditionsAndTheSummaryReadGroups) {
  const auto system = read(R"({"step": 0.1, "stop_time": 2, "groups": {"pair": {"i": [3, 4]}},
    "instances": {"p[{i}]": {"repeat": "pair", "fmu": "PROBE"}},
    "stop_when": [{"all": [{"repeat": "pair", "any": [
        {"variable": "p[{i}].real_out", "above": 1}, {"variable": "p[{i}].bool_out", "equals": true}]}], "for": 0.5}],
    "outcomes": [{"outcome": "ok", "when": [
        {"count": [{"repeat": "pair", "variable": "p[{i}].real_out", "above": 1, "ever": true}], "below": 2}]}],
    "summary": {"out": [{"repeat": "pair", "variable": "p[{i}].real_out"}],
                "mixed": [{"name": "first", "variable": "p[3].real_out"}, {"variable": "p[4].real_out"}]}})");
  const auto& all = system.stop_when.at(0);
  EXPECT_EQ(all.quantifier, Quantifier::all);
  EXPECT_EQ(all.for_ns, 500'000'000);
  ASSERT_EQ(all.members.size(), 2u);
  EXPECT_EQ(all.members[1].quantifier, Quantifier::any);
  EXPECT_EQ(all.members[1].members.at(0).variable.text(), "p[4].real_out");
  const auto& count = system.outcomes.at(0).when.at(0);
  EXPECT_EQ(count.quantifier, Quantifier::count);
  EXPECT_EQ(count.comparison, Comparison::below);
  EXPECT_TRUE(count.members.at(1).ever);
  ASSERT_EQ(system.summary.size(), 2u);
  EXPECT_EQ(system.summary[0].group.at(1).name, "4");
  EXPECT_EQ(system.summary[1].group.at(0).name, "first");
  EXPECT_EQ(system.summary[1].group.at(1).name, "2");
}

TEST(Config, ARepeatedConditionInTheSummaryGetsNoName) {
  const auto system =
      read(config_with(R"("summary": {"t": {"variable": "a.real_out", "when": [
      {"all": [{"repeat": {"i": [1, 4]}, "variable": "d[{i}].real_out", "above": 1}]}]}},)",
                       R"("a": {"fmu": "PROBE"}, "d[{i}]": {"repeat": {"i": [1, 4]}, "fmu": "PROBE"})"));
  ASSERT_EQ(system.summary.size(), 1u);
  const auto& all = system.summary[0].when.at(0);
  ASSERT_EQ(all.members.size(), 4u);
  EXPECT_EQ(all.members[3].variable.text(), "d[4].real_out");
}

TEST(Config, MistakesInGroupsNameTheirPlace) {
  const auto error = [](const std::string& rest, const std::string& groups = R"({"pair": {"i": [1, 2]}})") {
    return reading_error(fmt::format(
        R"({{"step": 0.1, "stop_time": 2, "groups": {}, "instances": {{"p[{{i}}]": {{"repeat": "pair", "fmu": "PROBE"}}}}, {}}})",
        groups, rest));
  };
  const std::string compared = R"("variable": "p[1].real_out", "above": 1)";
  EXPECT_THAT(error(R"("stop_when": [{"all": [{"repeat": "pear", "variable": "p[{i}].real_out", "above": 1}]}])"),
              AllOf(HasSubstr("/stop_when/0/all/0/repeat"), HasSubstr("pair")));
  EXPECT_THAT(error(R"("stop_when": [])", R"({"pair": {"i": [2, 1]}})"), HasSubstr("/groups/pair/i/1"));
  EXPECT_THAT(error(fmt::format(R"("stop_when": [{{"count": [{{{}}}]}}])", compared)), HasSubstr("exactly one of"));
  EXPECT_THAT(error(fmt::format(R"("stop_when": [{{"count": [{{{}}}], "above": 0.5}}])", compared)),
              HasSubstr("whole number"));
  EXPECT_THAT(error(fmt::format(R"("stop_when": [{{"all": [{{{}}}], "equals": true}}])", compared)),
              HasSubstr("equals"));
  EXPECT_THAT(error(R"("stop_when": [{"any": []}])"), HasSubstr("'any' has no condition"));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "parameters": []})")), HasSubstr("is empty"));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "parameters": [{"gain": 1}, {"gain": 2}]})")),
              HasSubstr("'gain' is set twice"));
  EXPECT_THAT(error(R"("summary": {"x": []})"), HasSubstr("at least one member"));
  EXPECT_THAT(
      error(
          R"("summary": {"x": [{"name": "a", "variable": "p[1].real_out"}, {"name": "a", "variable": "p[2].real_out"}]})"),
      HasSubstr("two members are named 'a'"));
  EXPECT_THAT(
      error(R"("summary": {"x": [{"repeat": "pair", "variable": "p[{i}].real_out"}, {"variable": "q.real_out"}]})"),
      HasSubstr("q"));
}

/// Reads a variant of base.json, the smallest config.
SystemDescription read_variant(const std::string& text, const GivenTimes& times = {}) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  test::write_file(folder.path() / "base.json", test::with_probe(config_with(R"("text": "the base",)")));
  const auto file = folder.path() / "variant.json";
  test::write_file(file, test::with_probe(text));
  return read_config(file, times);
}

TEST(Config, AVariantIsTheOtherConfigWithItsChanges) {
  const auto system = read_variant(R"({"text": "mine", "extends": "base.json", "changes": {
      "stop_time": 3, "instances": {"a": {"step": 0.2}, "b": {"fmu": "PROBE"}}}})");
  EXPECT_EQ(system.name, "variant");
  EXPECT_EQ(system.step, (ExactTime{1, 10}));
  EXPECT_EQ(system.stop_time_ns, 3'000'000'000);
  EXPECT_THAT(system.instance_names(), testing::ElementsAre("a", "b"));
  EXPECT_EQ(system.instances[0].steps, 2);
  EXPECT_THAT(system.source, AllOf(HasSubstr("mine"), HasSubstr("the base"))) << "both are inputs of the run";
  const auto removed = read_variant(R"({"extends": "base.json", "changes": {
      "instances": {"a": null, "b": {"fmu": "PROBE"}}}})");
  EXPECT_THAT(removed.instance_names(), testing::ElementsAre("b"));
}

TEST(Config, AVariantTakesTimesThatAreGiven) {
  EXPECT_EQ(read_variant(R"({"extends": "base.json", "changes": {}})", {.step = 0.5, .stop_time_s = {}}).step,
            (ExactTime{1, 2}));
}

TEST(Config, MistakesOfAVariantSayWhichFileHasThem) {
  const auto error = [](const std::string& text) { return test::input_error([&] { read_variant(text); }); };
  EXPECT_THAT(error(R"({"extends": "base.json", "changes": {"stop_time": "x"}})"),
              HasSubstr("variant.json: changes: /stop_time"));
  EXPECT_THAT(error(R"({"extends": "base.json", "changes": {"instances": {"a": {"fmu": null}}}})"),
              HasSubstr("variant.json: extends base.json: /instances/a: the key 'fmu' is missing"));
  EXPECT_THAT(error(R"({"extends": "base.json", "changes": {"instances": {"new": {"step": 0.2}}}})"),
              HasSubstr("variant.json: changes: /instances/new: the key 'fmu' is missing"));
  EXPECT_THAT(error(R"({"extends": ")" + std::string(300, 'x') + R"(", "changes": {}})"), HasSubstr("there is no xxx"));
  EXPECT_THAT(error(R"({"extends": "base.json"})"), HasSubstr("variant.json:1:1: /: the key 'changes' is missing"));
  EXPECT_THAT(error(R"({"extends": "base.json", "changes": {}, "step": 1})"), HasSubstr("'step' is unknown"));
  EXPECT_THAT(error(R"({"extends": "../base.json", "changes": {}})"), HasSubstr("in the folder of this one"));
  EXPECT_THAT(error(R"({"extends": "nothing.json", "changes": {}})"),
              HasSubstr("variant.json: /extends: there is no nothing.json"));
  EXPECT_THAT(error(R"({"extends": "variant.json", "changes": {}})"), HasSubstr("extends another one"));
}

TEST(Config, InstancesKeepTheirOrder) {
  const auto system = read(config_with("", R"("z": {"fmu": "PROBE"}, "a": {"fmu": "PROBE"}, "m": {"fmu": "PROBE"})"));
  EXPECT_THAT(system.instance_names(), testing::ElementsAre("z", "a", "m"));
}

TEST(Config, ReadingTakesTimeByTheNumberOfInstancesNotByItsSquare) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto seconds = [&](int count) {
    std::string instances;
    for (int i = 0; i < count; ++i) {
      instances += fmt::format(R"({}"i{}": {{"fmu": "{}"}})", i == 0 ? "" : ", ", i, PROBE_FMU);
    }
    test::write_file(folder.path() / "many.json", config_with("", instances));
    const auto before = std::clock();
    EXPECT_EQ(read_config(folder.path() / "many.json").instances.size(), static_cast<std::size_t>(count));
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  // For ten times the elements, a linear reader takes about 10 times as long, and a quadratic reader 100 times.
  EXPECT_LT(seconds(100'000), 40 * seconds(10'000));
}

TEST(Config, ManyUnknownNamesAreRefusedWithoutLookingForTheNearestOfEach) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto file = folder.path() / "many.json";
  const auto seconds = [&](int count) {
    std::string instances;
    std::string connections;
    for (int i = 0; i < count; ++i) {
      instances += fmt::format(R"({}"i{}": {{"fmu": "{}"}})", i == 0 ? "" : ", ", i, PROBE_FMU);
      connections += fmt::format(R"({}{{"from": "j{}.real_out", "to": "i0.real_in"}})", i == 0 ? "" : ", ", i);
    }
    test::write_file(file, fmt::format(R"({{"step": 1, "stop_time": 2, "instances": {{{}}}, "connections": [{}]}})",
                                       instances, connections));
    const auto before = std::clock();
    const auto text = test::input_error([&] { read_config(file); });
    const auto taken_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    EXPECT_THAT(text, HasSubstr("there is no instance 'j0'. Did you mean 'i0'"));
    EXPECT_THAT(text, HasSubstr(fmt::format("and {} more", count - 20)));
    return taken_s;
  };
  // For ten times the elements, a linear reader takes about 10 times as long, and a quadratic reader 100 times.
  EXPECT_LT(seconds(20'000), 40 * seconds(2'000));
}

TEST(Config, FmusThatDoNotExistAreRefusedAsFastAsOthersAreRead) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  const auto file = folder.path() / "many.json";
  constexpr int kCount = 10'000;
  const auto seconds = [&](std::string_view fmu, const auto& read_it) {
    std::string instances;
    for (int i = 0; i < kCount; ++i) {
      instances += fmt::format(R"({}"i{}": {{"fmu": "{}"}})", i == 0 ? "" : ", ", i, fmt::format(fmt::runtime(fmu), i));
    }
    test::write_file(file, config_with("", instances));
    const auto before = std::clock();
    read_it();
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  const double good_s = seconds(PROBE_FMU, [&] { read_config(file); });
  for (const std::string_view missing : {"nowhere", "nowhere{}", "folder/nowhere{}.fmu"}) {
    const double missing_s = seconds(missing, [&] {
      const auto text = test::input_error([&] { read_config(file); });
      EXPECT_THAT(text, AllOf(HasSubstr("there is no FMU "), HasSubstr(fmt::format("and {} more", kCount - 20))));
    });
    // If FMUs do not exist, reading takes 2 to 6 times as long. A search of all folders by every instance would take
    // 100 times as long.
    EXPECT_LT(missing_s, 30 * good_s) << missing;
  }
}

TEST(Config, FmuPathsAreRelativeToTheConfig) {
  const modeldesc::TemporaryFolder folder("mebots-test");
  std::filesystem::create_directories(folder.path() / "configs");
  std::filesystem::copy_file(PROBE_FMU, folder.path() / "beside.fmu");
  test::write_file(folder.path() / "configs" / "x.json", config_with("", R"("a": {"fmu": "../beside.fmu"})"));
  const auto system = read_config(folder.path() / "configs" / "x.json");
  EXPECT_EQ(system.instances[0].fmu_path, std::filesystem::canonical(folder.path() / "beside.fmu"));
}

TEST(Config, AMissingFileIsNamed) {
  EXPECT_THAT(test::input_error([] { read_config("/nowhere/mission.json"); }), HasSubstr("/nowhere/mission.json"));
  EXPECT_THAT(test::input_error([] { read_config("/tmp"); }), HasSubstr("folder"));
}

TEST(Config, BrokenJsonIsAnsweredByLineAndColumn) {
  EXPECT_THAT(reading_error("{\n  \"step\": 0.1,\n  oops\n}"),
              AllOf(HasSubstr("mission.json"), HasSubstr("mission.json:3:3: this is not JSON")));
}

TEST(Config, AnUnknownKeyIsAnsweredByPointerAndNearestKey) {
  EXPECT_THAT(reading_error(config_with(R"("stop_tiem": 1,)")),
              AllOf(HasSubstr("mission.json:1:2: /stop_tiem"), HasSubstr("'stop_time'")));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "paramters": {}})")),
              AllOf(HasSubstr("/instances/a/paramters"), HasSubstr("'parameters'")));
  EXPECT_THAT(reading_error(config_with(R"("stop_when": [{"variable": "a.steps", "above": 1, "fro": 2}],)",
                                        R"("a": {"fmu": "PROBE"})")),
              AllOf(HasSubstr("/stop_when/0/fro"), HasSubstr("'for'")));
}

TEST(Config, ADuplicateKeyIsRejected) {
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE"}, "a": {"fmu": "PROBE"})")),
              HasSubstr("'a' occurs twice"));
}

TEST(Config, TheSchemaKnowsTheKeysThatTheReaderKnows) {
  const auto all = schemas();
  const auto* const of_config = &*std::ranges::find(all, "config", &Schema::kind);
  const auto schema = nlohmann::json::parse(of_config->text);
  const auto names = [](const nlohmann::json& properties) {
    std::vector<std::string> result;
    for (const auto& [name, value] : properties.items()) result.push_back(name);
    return result;
  };
  EXPECT_THAT(names(schema["properties"]), testing::UnorderedElementsAreArray(config_keys()));
  EXPECT_THAT(names(schema["$defs"]["instance"]["properties"]), testing::UnorderedElementsAreArray(instance_keys()));
}

TEST(Config, EveryComplaintHasLineAndColumn) {
  EXPECT_THAT(reading_error(
                  "{\"step\": 0.1,\n \"stop_time\": 2, \"connections\": [],\n  \"instances\": {\"ä\": {}, \"b\": 3}}"),
              HasSubstr("mission.json:3:17: /instances/ä: the key 'fmu' is missing"));
  EXPECT_THAT(reading_error("{\"step\": 0.1,\n\n   \"step\": 0.2}"),
              HasSubstr("mission.json:3:4: /step: the key 'step' occurs twice"));
  EXPECT_THAT(reading_error("{\"step\": 0.1,\n\"st\\u0065p\": 0.2}"),
              HasSubstr(":2:1: /step: the key 'step' occurs twice"));
  std::string umlauts;
  for (int i = 0; i < 3000; ++i) umlauts += "ä";
  EXPECT_THAT(reading_error("{\"text\": \"" + umlauts + "\", \"stpe\": 1}"), HasSubstr("mission.json:1:3014: /stpe"))
      << "characters are counted, in long lines too";
  EXPECT_THAT(reading_error("{\"text\": \"1e999\",\n \"step\": 1e999}"),
              HasSubstr("mission.json:2:10: the number 1e999 is too large"));
}

TEST(Config, DeepNestingIsRefusedAndNeitherCrashesNorHangs) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THAT(reading_error(deep), HasSubstr("mission.json:1:101: this is nested more than 100 levels deep"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += R"({"a":)";
  EXPECT_THAT(reading_error(objects), HasSubstr("nested more than"));
}

TEST(Config, MissingKeysAreNamed) {
  EXPECT_THAT(reading_error(R"({"stop_time": 1, "instances": {}, "connections": []})"), HasSubstr("'step' is missing"));
  EXPECT_THAT(reading_error(R"({"step": 1, "instances": {}, "connections": []})"), HasSubstr("'stop_time' is missing"));
  EXPECT_THAT(reading_error(R"({"step": 1, "stop_time": 1, "connections": []})"), HasSubstr("'instances' is missing"));
  EXPECT_THAT(reading_error(R"({"step": 1, "stop_time": 1, "instances": {}, "connections": []})"),
              HasSubstr("at least one instance"));
  EXPECT_THAT(reading_error(config_with("", R"("a": {})")),
              AllOf(HasSubstr("/instances/a"), HasSubstr("'fmu' is missing")));
}

TEST(Config, ConnectionsMayBeMissing) {
  const auto system = read(R"({"step": 1, "stop_time": 1, "instances": {"a": {"fmu": "PROBE"}}})");
  EXPECT_EQ(system.instances.size(), 1U);
  EXPECT_TRUE(system.connections.empty());
}

TEST(Config, ValuesOfAnotherKindAreNamed) {
  EXPECT_THAT(reading_error("[]"), HasSubstr("an object is expected"));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": 3})")),
              AllOf(HasSubstr("/instances/a/fmu"), HasSubstr("a text is expected"), HasSubstr("3")));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "parameters": {"gain": [1]}})")),
              HasSubstr("/instances/a/parameters/gain"));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE"})", R"("step": "0.1", "stop_time": 2)")),
              AllOf(HasSubstr("/step"), HasSubstr("a number")));
}

TEST(Config, StepsAreWholeNanosecondsAndTheStopTimeAMultiple) {
  const auto with_times = [](const std::string& times) {
    return reading_error(config_with("", R"("a": {"fmu": "PROBE"})", times));
  };
  EXPECT_THAT(with_times(R"("step": 1.5e-9, "stop_time": 3e-9)"),
              AllOf(HasSubstr("/step"), HasSubstr("whole number of nanoseconds")));
  EXPECT_THAT(with_times(R"("step": 0, "stop_time": 1)"), HasSubstr("greater than 0"));
  EXPECT_THAT(with_times(R"("step": -0.1, "stop_time": 1)"), HasSubstr("greater than 0"));
  EXPECT_THAT(with_times(R"("step": 0.1, "stop_time": 0)"), HasSubstr("greater than 0"));
  EXPECT_THAT(with_times(R"("step": 0.3, "stop_time": 1)"),
              AllOf(HasSubstr("/stop_time"), HasSubstr("not a multiple"), HasSubstr("0.9 s and 1.2 s")));
}

TEST(Config, AStepIsReadAsARatio) {
  const auto with_times = [](const std::string& times, const std::string& instance = R"("a": {"fmu": "PROBE"})") {
    return config_with("", instance, times);
  };
  const auto typed = read(with_times(R"("step": "2/120", "stop_time": 1)"));
  EXPECT_EQ(typed.step, (ExactTime{1, 60}));
  EXPECT_TRUE(typed.notices.empty()) << "a ratio that is written needs no notice";
  const auto meant = read(with_times(R"("step": 0.016666666666666666, "stop_time": "7/60")"));
  EXPECT_EQ(meant.step, (ExactTime{1, 60}));
  EXPECT_EQ(meant.stop_time_ns, 116'666'667);
  EXPECT_THAT(meant.notices, testing::ElementsAre(AllOf(HasSubstr("/step"), HasSubstr("is read as 1/60 s"))));
  const auto multiple = read(with_times(R"("step": "1/60", "stop_time": 1)", R"("a": {"fmu": "PROBE", "step": 0.05})"));
  EXPECT_EQ(multiple.instances[0].steps, 3);

  const auto error = [&](const std::string& times, const std::string& instance = R"("a": {"fmu": "PROBE"})") {
    return reading_error(with_times(times, instance));
  };
  EXPECT_THAT(error(R"("step": "1/0", "stop_time": 1)"),
              AllOf(HasSubstr("/step"), HasSubstr("\"1/0\" is not a ratio")));
  EXPECT_THAT(error(R"("step": "1/6O", "stop_time": 1)"), HasSubstr("such as \"1/60\""));
  EXPECT_THAT(error(R"("step": "-1/60", "stop_time": 1)"), HasSubstr("greater than 0"));
  EXPECT_THAT(error(R"("step": "1/300000000", "stop_time": 1)"), HasSubstr("too short"));
  EXPECT_THAT(error(R"("step": 0.0166666666666, "stop_time": 1)"), HasSubstr("whole number of nanoseconds"));
  EXPECT_THAT(
      error(R"("step": "1/60", "stop_time": 1.01)"),
      AllOf(HasSubstr("/stop_time"), HasSubstr("step 1/60 s"), HasSubstr("nearest are 1 s and 1.0166666666666666 s")));
  EXPECT_THAT(
      error(R"("step": "1/60", "stop_time": 1)", R"("a": {"fmu": "PROBE", "step": "1/40"})"),
      AllOf(HasSubstr("/instances/a/step"), HasSubstr("0.025 s is not a multiple of the system's step 1/60 s")));
  EXPECT_THAT(error(R"("step": "1/60", "start_time": 0.3333333333333333, "stop_time": 1)"),
              AllOf(HasSubstr("/start_time"), HasSubstr("whole number of nanoseconds")));
}

TEST(Config, AnInstanceStepIsAMultipleAndTheStopTimeFitsIt) {
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "step": 0.15})")),
              AllOf(HasSubstr("/instances/a/step"), HasSubstr("multiple")));
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "PROBE", "step": 0.3})")),
              AllOf(HasSubstr("/stop_time"), HasSubstr("instance 'a'")));
}

TEST(Config, AMissingFmuIsNamedWithItsPath) {
  EXPECT_THAT(reading_error(config_with("", R"("a": {"fmu": "nothing/here.fmu"})")),
              AllOf(HasSubstr("/instances/a/fmu"), HasSubstr("nothing/here.fmu"), HasSubstr("relative to the config")));
}

TEST(Config, AnInstanceNameMayHoldDotsUnlessAnotherIsItsBeginning) {
  const auto system = read(config_with(R"("summary": {"x": "left.arm.real_out"},)", R"("left.arm": {"fmu": "PROBE"})"));
  EXPECT_EQ(system.summary[0].variable, (VariableName{"left.arm", "real_out"}));
  EXPECT_THAT(reading_error(config_with("", R"("a.b": {"fmu": "PROBE"}, "a": {"fmu": "PROBE"})")),
              HasSubstr("'a.b' could be a variable of the instance 'a'"));
  EXPECT_THAT(
      reading_error(config_with("", R"("a.b.c": {"fmu": "PROBE"}, "a-": {"fmu": "PROBE"}, "a": {"fmu": "PROBE"})")),
      HasSubstr("'a.b.c' could be a variable of the instance 'a'"));
}

TEST(Config, AnUnknownAlgorithmIsReportedTogetherWithOtherMistakes) {
  EXPECT_THAT(reading_error(config_with(R"("algorithm": "gaus-seidel", "recrod": {},)", R"("a": {"fmu": "PROBE"})")),
              AllOf(HasSubstr("/algorithm: there is no algorithm 'gaus-seidel'. Did you mean 'gauss-seidel'?"),
                    HasSubstr("recrod")));
}

TEST(Config, AConnectionNamesInstanceAndVariable) {
  const auto connected = [](const std::string& from) {
    return reading_error(fmt::format(
        R"({{"step": 0.1, "stop_time": 2, "instances": {{"motor": {{"fmu": "PROBE"}}}}, "connections": [{{"from": "{}", "to": "motor.real_in"}}]}})",
        from));
  };
  EXPECT_THAT(connected("moter.real_out"), AllOf(HasSubstr("/connections/0/from"), HasSubstr("Did you mean 'motor'?")));
  EXPECT_THAT(connected("motor"), HasSubstr("write instance.variable"));
}

TEST(Config, AZeroByteIsNoEndOfTheFile) {
  EXPECT_THAT(reading_error(std::string("3\0 }}", 5)), AllOf(HasSubstr(":1:2"), HasSubstr("zero byte")));
}

TEST(Config, AConditionComparesOnce) {
  EXPECT_THAT(reading_error(config_with(R"("stop_when": [{"variable": "a.steps"}],)")), HasSubstr("exactly one of"));
  EXPECT_THAT(reading_error(config_with(R"("stop_when": [{"variable": "a.steps", "above": 1, "below": 3}],)")),
              HasSubstr("exactly one of"));
}

TEST(CommandLine, SetNeedsInstanceVariableAndValue) {
  auto system = read(config_with(""));
  for (const char* text : {"gain=2", "a.gain", "a.=2", ".gain=2", "=2", ""}) {
    EXPECT_THAT(test::input_error([&] { test::apply_set(system, text); }),
                AnyOf(HasSubstr("write INSTANCE.VARIABLE=VALUE"), HasSubstr("write instance.variable")))
        << text;
  }
  EXPECT_THAT(test::input_error([&] { test::apply_set(system, "bb.gain=2"); }), HasSubstr("no instance 'bb'"));
}

TEST(CommandLine, AValueMayHoldAnEqualsSign) {
  auto system = read(config_with(""));
  test::apply_set(system, "a.string_in=x=y");
  EXPECT_EQ(std::get<UntypedText>(system.instances[0].parameters.back().value).text, "x=y");
}

TEST(CommandLine, EachTokenWithAnEqualsSignAfterSetIsAnAssignmentUpToTheNextOption) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(with_each_set({"run", "--set", "a.x=1", "b.y=2", "c.z==", "two.json", "--quiet", "d.w=3"}),
            (Words{"run", "--set", "a.x=1", "--set", "b.y=2", "--set", "c.z==", "two.json", "--quiet", "d.w=3"}));
  EXPECT_EQ(with_each_set({"--set=a.x=1", "b.y=2", "--set", "c.z=-1"}),
            (Words{"--set=a.x=1", "--set", "b.y=2", "--set", "c.z=-1"}));
  EXPECT_EQ(with_each_set({"run", "k=1.json", "--set"}), (Words{"run", "k=1.json", "--set"}));
}

TEST(CommandLine, ANameEndsAtTheEqualsSignAfterTheLongestKnownName) {
  const auto split = [](const std::string& text) {
    const auto setting = with_longest_name(
        read_set(text), [](const std::string& name) { return name == "a.k" || name == "a.k=1" || name == "b=2.k"; });
    return setting.variable + " <- " + std::get<UntypedText>(setting.value).text;
  };
  EXPECT_EQ(split("a.k=3"), "a.k <- 3");
  EXPECT_EQ(split("a.k=1=3"), "a.k=1 <- 3");
  EXPECT_EQ(split("a.k=1"), "a.k <- 1");
  EXPECT_EQ(split("a.k=1=3=4"), "a.k=1 <- 3=4");
  EXPECT_EQ(split("a.k=2=3"), "a.k <- 2=3");
  EXPECT_EQ(split("b=2.k=3"), "b=2.k <- 3");
}

TEST(CommandLine, StopTimeReplacesTheConfigsAndMustFitTheStep) {
  auto system = read(config_with(""));
  set_stop_time(system, read_duration("--stop-time", "0.5"), "--stop-time");
  EXPECT_EQ(system.stop_time_ns, 500'000'000);
  EXPECT_THAT(test::input_error([&] { set_stop_time(system, 550'000'000, "--stop-time"); }),
              HasSubstr("not a multiple"));
  EXPECT_THAT(test::input_error([&] { read_duration("--stop-time", "soon"); }), HasSubstr("neither a number"));
  EXPECT_THAT(test::input_error([&] { read_duration("--stop-time", "-1"); }), HasSubstr("greater than 0"));
}

}  // namespace
}  // namespace mebots::master
