// SPDX-License-Identifier: Apache-2.0
#include "board/network_folder.hpp"

#include "mebots/data/document.hpp"
#include "mebots/data/object.hpp"
#include "mebots/error.hpp"
#include "mebots/file_kind.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

namespace mebots::soc {
namespace {

/// The member `flight` of network.json.
struct Flight {
  std::string none;  ///< reason why there is no program; empty if there is a program
  std::string program;
  std::string board;
  std::vector<std::string> firmware;  ///< names of the firmware that the program replaces
  std::vector<std::string> outputs;
};

std::vector<std::string> texts(const data::Node& list) {
  std::vector<std::string> result;
  for (const auto& element : list.elements()) result.push_back(element.readable_text());
  return result;
}

/// Returns the name of a file in the folder. Rejects a path, because only files in this folder are inputs of the
/// mission.
std::string file_name(const data::Node& node) {
  auto name = node.readable_text();
  if (std::filesystem::path(name).filename() != name || name == "." || name == "..") {
    node.fail(ErrorCode::invalid_value, fmt::format("\"{}\" must be the name of a file in this folder", name));
  }
  return name;
}

Flight read_flight(const data::Node& node) {
  Flight flight;
  data::Object object(node);
  if (object.read_if("none", flight.none, &data::Node::readable_text)) return flight;
  object.read("program", flight.program, &file_name);
  object.read("board", flight.board, &data::Node::readable_text);
  object.read("firmware", flight.firmware, &texts);
  object.read("outputs", flight.outputs, &texts);
  object.finish();
  return flight;
}

Flight flight_of(const std::filesystem::path& folder) {
  const auto file = folder / "network.json";
  if (!is_folder(folder)) throw Error("there is no such folder; name one that `mebots deploy` has written");
  if (!is_file(file)) throw Error("the folder has no network.json; name one that `mebots deploy` has written");
  data::Document document(file);
  return document.read([](const data::Node& root) {
    Flight flight;
    data::Object(root).read("flight", flight, &read_flight);
    return flight;
  });
}

}  // namespace

std::filesystem::path program_with_network(const std::filesystem::path& folder, std::string_view firmware,
                                           const BoardDescription& board) {
  const auto flight = flight_of(folder);
  if (!flight.none.empty()) throw Error(fmt::format("this network does not fly: {}", flight.none));
  if (flight.board != board.name) {
    throw Error(fmt::format("{} is for board {}, and this chip is board {}; deploy the network again with --board {}",
                            flight.program, flight.board, board.name, board.name));
  }
  if (std::ranges::find(flight.firmware, firmware) == flight.firmware.end()) {
    throw Error(
        fmt::format("with its outputs ({}), it replaces the network of firmware {}, but the mission flies firmware {}",
                    fmt::join(flight.outputs, ", "), fmt::join(flight.firmware, " or "), firmware));
  }
  return folder / flight.program;
}

}  // namespace mebots::soc
