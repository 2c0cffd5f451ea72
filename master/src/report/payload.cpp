// SPDX-License-Identifier: Apache-2.0
#include "report/page.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace mebots::master::report {
namespace {

using Json = nlohmann::json;

/// The blocks of bytes that follow the header in payload_of().
class Blocks {
 public:
  Json add(std::string_view bytes) {
    Json place = {{"offset", bytes_.size()}, {"length", bytes.size()}};
    bytes_ += bytes;
    return place;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

std::string byte_planes(std::span<const double> values) {
  std::string planes(8 * values.size(), '\0');
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto bits = std::bit_cast<std::uint64_t>(values[i]);
    const auto difference = bits - before;
    before = bits;
    for (std::size_t plane = 0; plane < 8; ++plane) {
      planes[plane * values.size() + i] = static_cast<char>(difference >> (8 * plane) & 0xff);
    }
  }
  return planes;
}

Json column_json(const ResultTable::Column& column, Blocks& blocks) {
  Json json = {{"name", column.name}, {"unit", column.unit}};
  const auto& values = column.values;
  const bool still = std::ranges::adjacent_find(values, std::ranges::not_equal_to()) == values.end();
  if (still && !values.empty()) {
    json["still"] = values.front();
  } else {
    json["block"] = blocks.add(byte_planes(values));
  }
  return json;
}

Json run_json(const RunFolder& run, bool with_pictures, Blocks& blocks) {
  Json json = {{"name", run.name},           {"system", run.system},     {"summary", run.summary},  {"log", run.log},
               {"texts", run.results.texts}, {"rows", run.results.rows}, {"span", run.results.span}};
  json["whole"] = Json::array();
  for (const auto& [from_s, to_s] : run.results.whole) json["whole"].push_back({from_s, to_s});
  json["kept"] = run.results.columns.front().values.size();
  for (const auto& column : run.results.columns) json["columns"].push_back(column_json(column, blocks));
  json["scene"] =
      run.scene.is_null() ? Json() : blocks.add(run.scene.dump(-1, ' ', false, Json::error_handler_t::replace));
  json["profiles"] = run.profiles;
  json["live"] = run.live;
  json["pictures"] = Json::array();
  if (!with_pictures) return json;
  for (const auto& series : run.pictures) {
    Json entry = {{"name", series.name}, {"every", series.every}, {"pictures", Json::array()}};
    for (const auto& picture : series.pictures) {
      auto place = blocks.add(picture.png);
      place["time"] = picture.time_s;
      place["shrunk"] = picture.shrunk;
      entry["pictures"].push_back(std::move(place));
    }
    json["pictures"].push_back(std::move(entry));
  }
  return json;
}

}  // namespace

std::string payload_of(std::span<const RunFolder> runs) {
  Blocks blocks;
  Json header = {{"format", 1}, {"runs", Json::array()}};
  for (std::size_t i = 0; i < runs.size(); ++i) header["runs"].push_back(run_json(runs[i], i == 0, blocks));
  const auto text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string bytes;
  for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(text.size() >> shift & 0xff);
  return bytes + text + blocks.bytes();
}

}  // namespace mebots::master::report
