// SPDX-License-Identifier: Apache-2.0
//
// mebots-boardgen BOARD.json --c HEADER.h --cpp HEADER.hpp
// mebots-boardgen BOARD.json --skeleton DEVICE FILE.cpp
//
// The first form generates headers for firmware and for device models. The second form generates a C++ device model, to
// which the device's own behaviour must be added.

#include "board/board_file.hpp"
#include "command_line/command.hpp"
#include "headers.hpp"

#include "mebots/error.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using mebots::Error;
using mebots::soc::BoardDescription;

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw Error(fmt::format("{}: cannot be written", path));
}

const mebots::soc::BoardDevice& device_of(const BoardDescription& board, const std::string& name) {
  std::vector<std::string> known;
  for (const auto& device : board.devices) {
    if (device.name == name) return device;
    known.push_back(device.name);
  }
  throw Error(fmt::format("board {} has no device \"{}\"; it has: {}", board.name, name, fmt::join(known, ", ")));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Writes headers and skeletons of devices from a board file"};
  app.name("mebots-boardgen");
  app.set_version_flag("--version", "mebots-boardgen " MEBOTS_VERSION);
  std::string board_path;
  std::string c_path;
  std::string cpp_path;
  std::pair<std::string, std::string> skeleton;
  app.add_option("board", board_path, "The board file")->required()->type_name("BOARD.json");
  auto* c_option = app.add_option("--c", c_path, "Write addresses, registers and opcodes as a C header for firmware")
                       ->type_name("HEADER.h");
  auto* cpp_option =
      app.add_option("--cpp", cpp_path, "Write the same as a C++ header for device models")->type_name("HEADER.hpp");
  auto* skeleton_option =
      app.add_option("--skeleton", skeleton, "Write a C++ skeleton of a device of this board, without its behaviour")
          ->type_name("DEVICE FILE.cpp");
  if (const auto code = mebots::command_line::handle_hidden_options(app, MEBOTS_VERSION, argc, argv)) return *code;
  try {
    app.parse(argc, argv);
    if (c_option->empty() && cpp_option->empty() && skeleton_option->empty()) {
      throw CLI::ParseError("nothing to write: add --c, --cpp or --skeleton", CLI::ExitCodes::RequiredError);
    }
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const auto board = mebots::soc::read_board(board_path);
    if (!c_option->empty()) write_file(c_path, mebots::boardgen::c_header(board));
    if (!cpp_option->empty()) write_file(cpp_path, mebots::boardgen::cpp_header(board));
    if (!skeleton_option->empty()) {
      write_file(skeleton.second, mebots::boardgen::skeleton(board, device_of(board, skeleton.first)));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "mebots-boardgen: {}\n", error.what());
    return 2;
  }
  return 0;
}
