// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "board/board_file.hpp"
#include "elf/elf.hpp"
#include "mebots/soc/time.hpp"
#include "observe/text_file.hpp"
#include "soc/soc.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::soc::tool {

/// Returns a board for a program that needs no devices. The board has RAM at the load addresses and run addresses of
/// the program's segments. Each RAM starts at the page of its lowest segment, has at least 4 MiB, and ends at least 1
/// MiB after its highest segment. The last RAM ends `heap` bytes after its highest segment. Segments more than 64 MiB
/// apart get separate RAMs. Throws Error if the RAMs would exceed 2 GiB.
BoardDescription board_around(const Elf& program, std::uint64_t heap);

/// Adds RAM that `text` describes as BASE:SIZE, such as 0x80000000:64M. If a memory has this base, changes its size
/// instead. Throws Error if the text is invalid, or if the RAM overlaps a device.
void add_ram(BoardDescription& board, const std::string& text);

/// Parses a time such as 10s, 2.5ms or 3 (seconds). Throws Error that names the option if the text is invalid.
Picoseconds time_of(std::string_view option, const std::string& text);

std::vector<std::filesystem::path> own_boards();

/// Returns the possible paths of a folder with data of MEbots: in share/ of an installation, or next to bin/ of a
/// build.
std::vector<std::filesystem::path> own_folders(std::string_view name);

/// Returns the path of a board file. `asked` is a path, or the name of a board of this installation. For any other
/// name, throws Error that lists these boards.
std::filesystem::path board_file(const std::string& asked);

/// Reads the .png and .pgm files of a folder in the order of their names, and returns their grey pixels row by row.
/// Colours are converted to grey with libpng's weights. Throws Error that names the file if a file cannot be read, is
/// not `width` pixels wide, or has fewer than `least_height` rows. Also throws if the folder contains no pictures.
std::vector<std::vector<std::uint8_t>> read_pictures(const std::filesystem::path& folder, std::uint32_t width,
                                                     std::uint32_t least_height);

/// Writes the words between the symbols begin_signature and end_signature to a file, as 8 hexadecimal digits per line.
class Signature {
 public:
  /// Must be created before the run. Throws Error if the program lacks the symbols, if they are outside its memory, or
  /// if the file cannot be written.
  Signature(const std::string& path, const Soc& soc);
  /// Writes the present words between begin_signature and end_signature.
  void write(const Soc& soc);

 private:
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
  observe::TextFile file_;
};

struct Options {
  std::string program;
  std::vector<std::string> arguments;
  bool user = false;
  std::vector<std::string> ram;
  std::optional<std::string> console;
  std::optional<std::string> board;
  std::optional<std::string> core;
  std::vector<std::string> device_folders;
  std::optional<std::string> flash;
  std::optional<std::string> pictures;
  std::optional<std::string> signature;
  std::optional<std::string> trace;
  bool trace_cycles = false;
  std::optional<std::string> profile;
  std::optional<std::string> power_trace;
  std::optional<std::string> json;
  std::optional<std::string> report;
  std::optional<std::string> coverage;
  std::optional<std::string> pipeline;
  unsigned pipeline_hart = 0;
  std::optional<std::string> page;
  bool interpret = false;
  bool control = false;
  std::optional<std::string> host_files;
  std::optional<int> gdb_port;
  std::optional<std::string> load_state;
  std::optional<std::string> save_state;
  std::optional<std::uint64_t> max_instructions;
  std::optional<std::string> max_time;
  std::optional<std::string> timeout;
};

/// Adds the options and their help texts to the command. Parsing the command line sets `options`.
void add_options(CLI::App& command, Options& options);

/// Throws Error if options are invalid or exclude each other. Also throws if a file name is empty, a file has two
/// purposes, an output is also an input, or the folder of a file does not exist.
void check(const Options& options);

/// Returns advice about the fault that has ended a run, or an empty text. The advice names an option that serves the
/// program's system call, or a board that has a device at the address.
std::string advice_after_fault(const Soc& soc, const Options& options);

inline constexpr int kFaultOrLimit = 101;
inline constexpr int kBadInput = 102;

/// Runs a program to its end and prints the report. Returns the exit code: tohost >> 1, the low 8 bits of the value in
/// EXIT, or kFaultOrLimit. Throws Error for invalid input.
int run(const Options& options);

}  // namespace mebots::soc::tool
