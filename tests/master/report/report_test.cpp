// SPDX-License-Identifier: Apache-2.0
// Tests the content of the page of a results folder. tests/web tests the page in a browser.
#include "test_system.hpp"

#include "base/packed.hpp"
#include "mebots/packed.hpp"
#include "record/sink/png_file.hpp"
#include "report/page.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>

namespace mebots::test {
namespace {

using master::gunzipped;
using master::report::payload_of;
using master::report::read_results;
using master::report::read_run_folder;
using master::report::ResultTable;
using master::report::RunFolder;
using mebots::deflated;
using mebots::gzipped;
using mebots::Packing;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class Report : public testing::Test {
 protected:
  std::filesystem::path table(const std::string& text) const {
    write_file(folder.path() / "results.csv", text);
    return folder.path() / "results.csv";
  }
  modeldesc::TemporaryFolder folder{"mebots-test"};
};

TEST_F(Report, ReadsColumnsWithTheirUnits) {
  const auto results = read_results(table("time [s],a.x [m/s],\"a.y[1,2] [-]\"\n0,1.5,2\n0.1,-1e-300,3\n"));
  ASSERT_THAT(results.columns, SizeIs(3));
  EXPECT_EQ(results.columns[1].name, "a.x");
  EXPECT_EQ(results.columns[1].unit, "m/s");
  EXPECT_THAT(results.columns[1].values, ElementsAre(1.5, -1e-300));
  EXPECT_EQ(results.columns[2].name, "a.y[1,2]");
  EXPECT_EQ(results.rows, 2U);
}

TEST_F(Report, LeavesOutTextsByName) {
  const auto results = read_results(table("time [s],a.word [-],a.x [m]\n0,\"one, \"\"1\"\"\",4\n1,two,5\n"));
  ASSERT_THAT(results.columns, SizeIs(2));
  EXPECT_THAT(results.columns[1].values, ElementsAre(4, 5));
  EXPECT_THAT(results.texts, ElementsAre("a.word"));
}

TEST_F(Report, IgnoresALineThatAKilledRunTruncated) {
  const auto results = read_results(table("time [s],a.x [m]\n0,4\n1,5\n2,6"));
  EXPECT_THAT(results.columns[1].values, ElementsAre(4, 5));
}

TEST_F(Report, ThinsOutATableThatIsTooLongAndKeepsItsExtremesAndItsEnd) {
  std::string text = "time [s],a.grows [J],a.x [m]\n";
  const auto rows = ResultTable::kMostValues / 3 * 2 + 1;
  for (std::size_t i = 0; i < rows; ++i) {
    text += std::to_string(i) + "," + std::to_string(2 * i) + "," + (i == 1001 ? "9" : i == 1002 ? "-7" : "1") + "\n";
  }
  const auto results = read_results(table(text));
  EXPECT_EQ(results.rows, rows);
  EXPECT_EQ(results.span, 5U) << "twice as many numbers as there may be, less a fraction";
  const auto& times = results.columns[0].values;
  EXPECT_LE(3 * times.size(), ResultTable::kMostValues);
  EXPECT_EQ(times[0], 0);
  EXPECT_EQ(times[1], 4);
  EXPECT_EQ(times[2], 5);
  EXPECT_EQ(times.back(), static_cast<double>(rows - 1));
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_EQ(results.columns[1].values[i], 2 * times[i]);
  // A long table keeps the two extremes of each span in their original order. Rows 1001 and 1002 are the extremes of
  // the 201st span.
  EXPECT_EQ(results.columns[2].values[400], 9);
  EXPECT_EQ(results.columns[2].values[401], -7);
  EXPECT_EQ(results.columns[2].values[402], 1);
}

TEST_F(Report, EveryRowOfAChosenSpanStays) {
  std::string text = "time [s],a.x [m]\n";
  const std::size_t rows = 2 * ResultTable::kMostValues;
  for (std::size_t row = 0; row < rows; ++row) text += fmt::format("{},{}\n", row, row % 7);
  const auto results = read_results(table(text), {{1000.5, 1100}, {500000, 500003}});
  const auto& times = results.columns[0].values;
  const auto& values = results.columns[1].values;
  EXPECT_LT(times.size(), ResultTable::kMostValues);
  EXPECT_TRUE(std::ranges::is_sorted(times));
  EXPECT_EQ(times.front(), 0);
  EXPECT_EQ(times.back(), static_cast<double>(rows - 1));
  for (const auto& [from, to] : {std::pair{1001, 1100}, std::pair{500000, 500003}}) {
    auto at = static_cast<std::size_t>(std::ranges::lower_bound(times, from) - times.begin());
    for (int row = from; row <= to; ++row, ++at) {
      EXPECT_EQ(times[at], row);
      EXPECT_EQ(values[at], row % 7);
    }
    EXPECT_GT(times[at], to);
  }
}

TEST_F(Report, ATableThatFitsIsNotThinnedOut) {
  EXPECT_EQ(ResultTable::span_of(ResultTable::kMostValues, 1), 1U);
  EXPECT_GT(ResultTable::span_of(ResultTable::kMostValues + 1, 1), 2U) << "a span of two saves nothing";
}

TEST_F(Report, RefusesWhatIsNoTableOfResults) {
  EXPECT_THROW(read_results(table("hello\n")), InputError);
  EXPECT_THROW(read_results(table("")), InputError);
  EXPECT_THROW(read_results(table("time [s],a.x [m]\n0\n")), InputError);
  EXPECT_THROW(read_results(table("time [s],a.x [m]\n0,1,2\n")), InputError);
  EXPECT_THROW(read_results(table("time [s],a.x [m]\nnoon,1\n")), InputError);
}

TEST_F(Report, RefusesAFolderThatIsNoRunsAndADamagedFile) {
  EXPECT_THROW(read_run_folder(folder.path() / "nowhere"), InputError);
  EXPECT_THROW(read_run_folder(folder.path()), InputError);
  table("time [s],a.x [m]\n0,1\n");
  EXPECT_TRUE(read_run_folder(folder.path()).summary.is_null());
  write_file(folder.path() / "summary.json", "{\"outcome\": ");
  EXPECT_THROW(read_run_folder(folder.path()), InputError);
}

TEST_F(Report, PicturesComeInTheOrderOfTime) {
  table("time [s],a.x [m]\n0,1\n");
  const auto pictures = folder.path() / "pictures" / "world.camera.frame";
  std::filesystem::create_directories(pictures);
  write_file(pictures / "0010.500000.png", "late");
  write_file(pictures / "0002.250000.png", "early");
  write_file(pictures / "notes.txt", "");
  const auto run = read_run_folder(folder.path());
  ASSERT_THAT(run.pictures, SizeIs(1));
  ASSERT_THAT(run.pictures[0].pictures, SizeIs(2));
  EXPECT_EQ(run.pictures[0].pictures[0].time_s, 2.25);
  EXPECT_EQ(run.pictures[0].pictures[1].png, "late");
}

/// Writes `count` pictures of grey noise, which does not compress, with one picture per second.
void write_noise(const std::filesystem::path& folder, unsigned count, std::size_t width) {
  std::filesystem::create_directories(folder);
  std::mt19937 noise(1);
  std::vector<std::uint8_t> pixels(width * width);
  for (unsigned i = 0; i < count; ++i) {
    for (auto& pixel : pixels) pixel = static_cast<std::uint8_t>(noise());
    master::write_png(folder / fmt::format("{:011.6f}.png", static_cast<double>(i)), pixels, width);
  }
}

std::size_t bytes_of(const std::vector<master::report::Picture>& pictures) {
  std::size_t bytes = 0;
  for (const auto& picture : pictures) bytes += picture.png.size();
  return bytes;
}

TEST_F(Report, PicturesThatFitStayAsTheyAre) {
  table("time [s],a.x [m]\n0,1\n");
  const auto pictures = folder.path() / "pictures" / "world.camera.frame";
  write_noise(pictures, 10, 320);
  const auto run = read_run_folder(folder.path());
  ASSERT_THAT(run.pictures[0].pictures, SizeIs(10));
  EXPECT_EQ(run.pictures[0].every, 1U);
  EXPECT_EQ(run.pictures[0].pictures[3].shrunk, 1U);
  EXPECT_EQ(run.pictures[0].pictures[3].png, read_file(pictures / "0003.000000.png"));
}

TEST_F(Report, PicturesOfALongRunAreSmallerButForAChosenSpan) {
  table("time [s],a.x [m]\n0,1\n");
  const auto pictures = folder.path() / "pictures" / "world.camera.frame";
  write_noise(pictures, 40, 320);
  const auto run = read_run_folder(folder.path(), {{5, 7}});
  const auto& kept = run.pictures[0].pictures;
  ASSERT_THAT(kept, SizeIs(40));
  EXPECT_EQ(run.pictures[0].every, 1U);
  for (const auto& picture : kept) {
    const bool is_chosen = picture.time_s >= 5 && picture.time_s <= 7;
    EXPECT_EQ(picture.shrunk, is_chosen ? 1U : 2U) << picture.time_s;
    const auto read = master::read_png(picture.png);
    ASSERT_TRUE(read.has_value());
    EXPECT_EQ(read->width, is_chosen ? 320U : 160U) << picture.time_s;
    EXPECT_EQ(read->pixels.size(), read->width * read->width);
  }
  const auto whole = master::read_png(read_file(pictures / "0000.000000.png"));
  ASSERT_TRUE(whole.has_value());
  const auto at = [&](std::size_t x, std::size_t y) { return static_cast<double>(whole->pixels[y * 320 + x]); };
  const auto mean = (at(10, 6) + at(11, 6) + at(10, 7) + at(11, 7)) / 4;
  EXPECT_NEAR(master::read_png(kept[0].png)->pixels[3 * 160 + 5], mean, 0.5) << "rounded to a grey level";
}

TEST_F(Report, PicturesThatGetNoSmallerAreFewer) {
  table("time [s],a.x [m]\n0,1\n");
  write_noise(folder.path() / "pictures" / "world.camera.frame", 120, 160);
  const auto run = read_run_folder(folder.path(), {{11, 12}});
  const auto& [name, kept, every] = run.pictures[0];
  EXPECT_EQ(every, 3U) << "120 x 25.6 kB in 1.5 MB";
  EXPECT_THAT(kept, SizeIs(118 / 3 + 1 + 2));
  EXPECT_LE(bytes_of(kept), master::report::kMostPictureBytes + std::size_t{2} * 27'000);
  EXPECT_EQ(kept[1].time_s, 3);
  EXPECT_TRUE(std::ranges::any_of(kept, [](const auto& picture) { return picture.time_s == 11; }));
}

TEST_F(Report, APictureThatIsNoPngIsLeftAsItIs) {
  table("time [s],a.x [m]\n0,1\n");
  const auto pictures = folder.path() / "pictures" / "world.camera.frame";
  write_noise(pictures, 20, 320);
  write_file(pictures / "0003.000000.png", "no picture");
  const auto run = read_run_folder(folder.path());
  EXPECT_EQ(run.pictures[0].pictures[3].png, "no picture");
  EXPECT_EQ(run.pictures[0].pictures[3].shrunk, 1U);
  EXPECT_EQ(run.pictures[0].pictures[4].shrunk, 2U);
}

struct Unpacked {
  nlohmann::json header;
  std::string blocks;
};

Unpacked unpacked(const std::string& payload) {
  std::uint32_t length = 0;
  for (unsigned i = 0; i < 4; ++i) length |= static_cast<std::uint32_t>(static_cast<std::uint8_t>(payload[i])) << 8 * i;
  return {nlohmann::json::parse(payload.substr(4, length)), payload.substr(4 + length)};
}

TEST_F(Report, ColumnsComeBackToTheBit) {
  const std::vector<double> values = {0.1, -0.0, 1e-310, std::numeric_limits<double>::max()};
  RunFolder run;
  run.name = "a";
  run.results.columns = {{"time", "s", {0, 1, 2, 3}}, {"a.x", "m", values}, {"a.still", "-", {7, 7, 7, 7}}};
  const auto [header, blocks] = unpacked(payload_of(std::span(&run, 1)));
  const auto& columns = header.at("runs").at(0).at("columns");
  EXPECT_EQ(columns.at(2).at("still"), 7);
  const std::size_t offset = columns.at(1).at("block").at("offset");
  EXPECT_EQ(columns.at(1).at("block").at("length"), 8 * values.size());
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t plane = 0; plane < 8; ++plane) {
      bits += static_cast<std::uint64_t>(static_cast<std::uint8_t>(blocks[offset + plane * values.size() + i]))
              << 8 * plane;
    }
    EXPECT_EQ(bits, std::bit_cast<std::uint64_t>(values[i])) << i;
  }
}

TEST_F(Report, GzippedBytesComeBackAndDamagedOnesAreRefused) {
  const std::string text = "a scene" + std::string(300000, 'x');
  const auto packed = gzipped(text, Packing::small);
  EXPECT_EQ(gunzipped(packed), text);
  EXPECT_EQ(packed.substr(4, 4), std::string(4, '\0')) << "no date: the same scene is the same file";
  EXPECT_THROW(gunzipped(packed.substr(0, packed.size() / 2)), Error);
  EXPECT_THROW(gunzipped("a scene"), Error);
}

TEST_F(Report, DeflatedBytesInflateToWhatTheyWere) {
  const std::string text(100000, 'x');
  const auto packed = deflated(text, Packing::small);
  EXPECT_LT(packed.size(), 1000U);
  std::string back(text.size(), '\0');
  auto length = static_cast<uLongf>(back.size());
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(back.data()), &length, reinterpret_cast<const Bytef*>(packed.data()),
                       packed.size()),
            Z_OK);
  EXPECT_EQ(back, text);
}

TEST_F(Report, NamesAreTextAndNoMarkup) {
  RunFolder run;
  run.name = "<script>alert(1)</script>";
  run.results.columns = {{"time", "s", {0}}};
  const auto page =
      make_page({"<title>{{title}}</title>{{connect}}{{style}}{{script}}{{data}}", "", ""}, std::span(&run, 1));
  EXPECT_THAT(page, testing::Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("&lt;script>alert"));
}

class ReportProgram : public Report {
 protected:
  ReportProgram() { write_file(folder.path() / "two.json", with_probe(kConfig)); }
  ProgramResult run(std::vector<std::string> arguments) const { return run_program(arguments, folder.path()); }
  nlohmann::json system() const { return nlohmann::json::parse(read_file(folder.path() / "results/two/system.json")); }

  static constexpr const char* kConfig = R"({"step": 0.1, "stop_time": 1, "instances": {
      "a": {"fmu": "PROBE", "parameters": {"gain": 2, "real_in": 3}}, "b": {"fmu": "PROBE"}},
    "connections": [{"from": "a.real_out", "to": "b.real_in"}],
    "view": {"scene": "a.string_out", "marks": ["b"],
             "panels": [{"title": "Rates", "kind": "stack", "curves": [{"rate_of": "b.integral", "label": "in"}]}]}})";
};

TEST_F(ReportProgram, ARunSaysWhatItsResultsAreResultsOf) {
  ASSERT_EQ(run({"run", "two.json"}).code, 0);
  const auto json = system();
  EXPECT_EQ(json["name"], "two");
  EXPECT_THAT(json["instances"], SizeIs(2));
  EXPECT_EQ(json["connections"][0]["from"], "a.real_out");
  EXPECT_EQ(json["connections"][0]["to"], "b.real_in");
  EXPECT_EQ(json["variables"]["a.real_out"]["type"], "Real");
  EXPECT_EQ(json["view"]["marks"][0], "b");
  EXPECT_EQ(json["view"]["panels"][0]["kind"], "stack");
  EXPECT_EQ(json["view"]["panels"][0]["curves"][0]["rate_of"], "b.integral");
  EXPECT_EQ(json["view"]["scene"]["instance"], "a");
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "results/two/scene.json.gz"));
}

TEST_F(ReportProgram, AnEarlierRunsSceneGoesWithIt) {
  ASSERT_EQ(run({"run", "two.json"}).code, 0);
  auto config = nlohmann::json::parse(read_file(folder.path() / "two.json"));
  config.erase("view");
  write_file(folder.path() / "two.json", config.dump());
  ASSERT_EQ(run({"run", "two.json"}).code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "results/two/scene.json.gz"));
  EXPECT_FALSE(system()["view"].contains("scene"));
}

TEST_F(ReportProgram, RefusesAViewOfWhatIsNotThere) {
  const auto refused = [&](const nlohmann::json& view) {
    auto config = nlohmann::json::parse(with_probe(kConfig));
    config["view"] = view;
    write_file(folder.path() / "two.json", config.dump());
    const auto result = run({"run", "two.json"});
    EXPECT_EQ(result.code, 2) << view << result.err;
    return result.err;
  };
  EXPECT_THAT(refused({{"scene", "a.string_uot"}}), HasSubstr("string_out"));
  EXPECT_THAT(refused({{"scene", "a.real_out"}}), HasSubstr("not a String"));
  EXPECT_THAT(refused({{"marks", {"c"}}}), HasSubstr("/view/marks/0"));
  const nlohmann::json both = {{"variable", "a.real_out"}, {"rate_of", "a.real_out"}};
  EXPECT_THAT(refused({{"panels", {{{"title", "t"}, {"curves", {both}}}}}}), HasSubstr("/view/panels/0/curves/0"));
  const nlohmann::json unknown = {{"variable", "a.real_uot"}};
  EXPECT_THAT(refused({{"panels", {{{"title", "t"}, {"curves", {unknown}}}}}}), HasSubstr("real_out"));
}

TEST_F(ReportProgram, ReportRefusesAFolderThatIsNoRunsInOneLine) {
  const auto result = run({"report", "."});
  if (result.code == 1) GTEST_SKIP() << "built without pages: " << result.err;
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("results.csv"));
  EXPECT_THAT(result.out, IsEmpty());
}

}  // namespace
}  // namespace mebots::test
