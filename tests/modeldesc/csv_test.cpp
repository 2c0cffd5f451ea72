// SPDX-License-Identifier: Apache-2.0
// Tests the reader of CSV files: cells, places of errors, and files in other formats.
#include "mebots/data/csv.hpp"
#include "mebots/error.hpp"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

namespace mebots::data {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Row = std::vector<std::string>;

std::vector<Row> rows_of(std::string_view text) {
  CsvReader reader(text, "t.csv");
  std::vector<Row> rows;
  while (reader.next()) {
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < reader.header().size(); ++i) row.emplace_back(reader.cell(i));
  }
  return rows;
}

/// Reads all rows, and converts column `numbers` (from 0) to numbers. Returns the code and the text of the error.
std::pair<ErrorCode, std::string> refusal_of(std::string_view text, std::size_t numbers = 0) {
  try {
    CsvReader reader(text, "t.csv");
    while (reader.next()) static_cast<void>(reader.number(numbers));
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ErrorCode::unspecified, ""};
}

TEST(Csv, ReadsEveryLineEndAndSkipsTheByteOrderMarkAndEmptyLines) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const auto text = "\xEF\xBB\xBF time , u" + end + end + "0,1" + end + "2,3" + end + end;
    CsvReader reader(text, "t.csv");
    EXPECT_THAT(reader.header(), ElementsAre("time", "u"));
    EXPECT_THAT(rows_of(text), ElementsAre(Row{"0", "1"}, Row{"2", "3"}));
  }
  EXPECT_THAT(rows_of("a,b\n1,2"), ElementsAre(Row{"1", "2"}));
  EXPECT_THAT(rows_of("a,b\n"), IsEmpty());
}

TEST(Csv, ReadsQuotedCells) {
  EXPECT_THAT(rows_of("a,b\n\"x,y\",\"say \"\"no\"\"\"\n\"two\nlines\",\"\"\n"),
              ElementsAre(Row{"x,y", "say \"no\""}, Row{"two\nlines", ""}));
  EXPECT_EQ(refusal_of("a,b\n\"x\ny\",1\n2,oops\n", 1).second.substr(0, 8), "t.csv:4:") << "a cell of two lines counts";
}

TEST(Csv, ReadsNumbersWithSignsExponentsAndBlanks) {
  CsvReader reader("x\n +1.5 \n-2e-3\n.5\n0.1\n", "t.csv");
  std::vector<double> numbers;
  while (reader.next()) numbers.push_back(reader.number(0));
  EXPECT_THAT(numbers, ElementsAre(1.5, -2e-3, 0.5, 0.1));
}

TEST(Csv, NamesLineColumnAndValueOfABadCell) {
  using enum ErrorCode;
  EXPECT_THAT(refusal_of("t,u\n0,1\n1,fast\n", 1),
              testing::Pair(wrong_type, HasSubstr("t.csv:3: column 2 ('u'): 'fast'")));
  EXPECT_THAT(refusal_of("t,u\n0,\n", 1),
              testing::Pair(wrong_type, HasSubstr("t.csv:2: column 2 ('u'): the cell is empty")));
  EXPECT_THAT(refusal_of("t,u\n0,\"1,5\"\n", 1), testing::Pair(wrong_type, HasSubstr("point")));
  EXPECT_EQ(refusal_of("t,u\n0,nan\n", 1).first, not_finite);
  EXPECT_EQ(refusal_of("t,u\n0,-inf\n", 1).first, not_finite);
  EXPECT_EQ(refusal_of("t,u\n0,0x10\n", 1).first, wrong_type);
  EXPECT_EQ(refusal_of("t,u\n0,1e999\n", 1).first, wrong_type);
}

TEST(Csv, RefusesRowsOfAnotherLength) {
  EXPECT_THAT(
      refusal_of("t,u\n0,1\n0,5,1,5\n"),
      testing::Pair(ErrorCode::syntax_error, HasSubstr("t.csv:3: this row has 4 cells, and the header names 2")));
  EXPECT_EQ(refusal_of("t,u\n0\n").first, ErrorCode::syntax_error);
  EXPECT_EQ(refusal_of("t,u\n\"0\"x,1\n").first, ErrorCode::syntax_error);
  EXPECT_EQ(refusal_of("t,u\n\"0,1\n").first, ErrorCode::syntax_error);
}

TEST(Csv, RefusesHeadersWithoutNames) {
  EXPECT_THAT(refusal_of(""), testing::Pair(ErrorCode::syntax_error, HasSubstr("header")));
  EXPECT_THAT(refusal_of(",time\n0,0\n"), testing::Pair(ErrorCode::syntax_error, HasSubstr("column 1 has no name")));
  EXPECT_EQ(refusal_of("a,b,a\n").first, ErrorCode::duplicate_name);
}

TEST(Csv, NamesTheSeparatorOfFilesWithADecimalComma) {
  EXPECT_THAT(refusal_of("time;u\n0;0,5\n"), testing::Pair(ErrorCode::syntax_error, HasSubstr("semicolons")));
  EXPECT_THAT(refusal_of("sep=;\ntime;u\n"), testing::Pair(ErrorCode::syntax_error, HasSubstr("semicolons")));
  EXPECT_THAT(refusal_of("time\tu\n0\t0.5\n"), testing::Pair(ErrorCode::syntax_error, HasSubstr("tabs")));
  EXPECT_THAT(rows_of("\"a;b\",c\n1,2\n"), ElementsAre(Row{"1", "2"})) << "quoted, it is part of a name";
}

TEST(Csv, NamesOtherFormats) {
  EXPECT_THAT(refusal_of(std::string_view("PK\x03\x04 and more")),
              testing::Pair(ErrorCode::syntax_error, HasSubstr("workbook")));
  EXPECT_THAT(refusal_of(std::string_view("\xFF\xFEt\0i\0", 6)),
              testing::Pair(ErrorCode::syntax_error, HasSubstr("UTF-16")));
  EXPECT_EQ(refusal_of(std::string_view("t\0,u\n", 5)).first, ErrorCode::syntax_error);
}

TEST(Csv, TitlesHoldNameAndUnit) {
  EXPECT_EQ(csv_title("car.speed [km/h]").name, "car.speed");
  EXPECT_EQ(csv_title("car.speed [km/h]").unit, "km/h");
  EXPECT_EQ(csv_title("rotor[1]").name, "rotor[1]");
  EXPECT_EQ(csv_title("rotor[1] [-]").name, "rotor[1]");
  EXPECT_EQ(csv_title("rotor[1] [-]").unit, "");
}

}  // namespace
}  // namespace mebots::data
