// SPDX-License-Identifier: Apache-2.0
#include "elf/source_lines.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

namespace mebots::soc {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// Reads a section that may be truncated or damaged. After the end of the section, all values are 0, and good() returns
/// false.
class Cursor {
 public:
  explicit Cursor(Bytes bytes) : bytes_(bytes) {}

  bool good() const { return good_; }
  bool more() const { return good_ && at_ < bytes_.size(); }

  std::uint32_t number(std::size_t size) {
    const auto part = take(size);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < part.size() && i < sizeof value; ++i) value |= std::uint32_t{part[i]} << (8 * i);
    return value;
  }

  /// Reads a LEB128 number, truncated to 32 bits.
  std::uint32_t unsigned_number() { return leb128().first; }
  std::int32_t signed_number() {
    const auto [value, bits] = leb128();
    const bool negative = bits > 0 && bits < 32 && (value >> (bits - 1) & 1) != 0;
    return static_cast<std::int32_t>(negative ? value | ~0U << bits : value);
  }

  std::string_view text() {
    const auto rest = bytes_.subspan(at_);
    const auto size = static_cast<std::size_t>(std::find(rest.begin(), rest.end(), 0) - rest.begin());
    const auto part = take(size + 1);
    return part.empty() ? std::string_view() : std::string_view(reinterpret_cast<const char*>(part.data()), size);
  }

  Bytes rest() { return take(bytes_.size() - at_); }
  /// Returns the next `size` bytes, or no bytes if fewer are left.
  Bytes take(std::size_t size) {
    if (size > bytes_.size() - at_) good_ = false;
    if (!good_) return {};
    const auto part = bytes_.subspan(at_, size);
    at_ += size;
    return part;
  }

 private:
  /// Returns the low 32 bits of a LEB128 number, and the number of bits that its bytes contain.
  std::pair<std::uint32_t, unsigned> leb128() {
    std::uint32_t value = 0;
    for (unsigned bits = 0;; bits += 7) {
      const auto byte = number(1);
      if (bits < 32) value |= (byte & 0x7f) << bits;
      if ((byte & 0x80) == 0) return {value, bits + 7};
    }
  }

  Bytes bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

std::string_view text_at(const std::vector<std::uint8_t>& section, std::uint32_t offset) {
  if (offset >= section.size()) return {};
  return Cursor(Bytes(section).subspan(offset)).text();
}

enum class Form : std::uint32_t {
  data2 = 0x05,
  data4 = 0x06,
  data8 = 0x07,
  string = 0x08,
  block = 0x09,
  data1 = 0x0b,
  strp = 0x0e,
  udata = 0x0f,
  data16 = 0x1e,
  line_strp = 0x1f,
};

constexpr std::uint32_t kPath = 1;    // DW_LNCT_path
constexpr std::uint32_t kFolder = 2;  // DW_LNCT_directory_index

struct FormValue {
  std::string_view text;
  std::uint32_t number = 0;
};

/// Reads a value in the DWARF form `form`. Skips the value of a form that is neither text nor a short number. After an
/// unknown form, the cursor's good() returns false.
FormValue read_form(Cursor& cursor, std::uint32_t form, const LineSections& sections) {
  switch (static_cast<Form>(form)) {
    case Form::string:
      return {cursor.text()};
    case Form::strp:
      return {text_at(sections.string, cursor.number(4))};
    case Form::line_strp:
      return {text_at(sections.line_string, cursor.number(4))};
    case Form::udata:
      return {{}, cursor.unsigned_number()};
    case Form::block:
      cursor.take(cursor.unsigned_number());
      return {};
    case Form::data1:
      return {{}, cursor.number(1)};
    case Form::data2:
      return {{}, cursor.number(2)};
    case Form::data4:
      cursor.take(4);
      return {};
    case Form::data8:
      cursor.take(8);
      return {};
    case Form::data16:
      cursor.take(16);
      return {};
  }
  cursor.take(static_cast<std::size_t>(-1));
  return {};
}

struct Entry {
  std::string_view path;
  std::uint32_t folder = 0;
};

/// Reads the table of folders or of files in DWARF 5. It begins with a list that describes the fields of its entries.
std::vector<Entry> described_entries(Cursor& cursor, const LineSections& sections) {
  struct Field {
    std::uint32_t content, form;
  };
  std::vector<Field> fields(cursor.number(1));
  for (auto& field : fields) {
    field.content = cursor.unsigned_number();
    field.form = cursor.unsigned_number();
  }
  const auto count = cursor.unsigned_number();
  std::vector<Entry> entries;
  if (fields.empty()) return entries;
  for (std::uint32_t i = 0; i < count && cursor.good(); ++i) {
    Entry entry;
    for (const auto& field : fields) {
      const auto value = read_form(cursor, field.form, sections);
      if (field.content == kPath) entry.path = value.text;
      if (field.content == kFolder) entry.folder = value.number;
    }
    entries.push_back(entry);
  }
  return entries;
}

/// The folders and files of a compilation unit. Folder 0 is the folder in which the compiler ran. Before DWARF 5, the
/// table does not contain the name of folder 0.
struct FileTable {
  std::vector<Entry> folders;
  std::vector<Entry> files;

  /// Returns the path of the file that has this number in the line number program.
  std::string path(std::uint32_t number) const {
    if (number >= files.size()) return {};
    const auto& file = files[number];
    auto path = std::string(file.path);
    const auto first = folders.empty() ? std::string_view() : folders.front().path;
    for (auto folder = file.folder; !path.starts_with('/') && folder < folders.size(); folder = 0) {
      const auto& name = folders[folder].path;
      // If the program was compiled with -ffile-prefix-map, the path may already begin with folder 0. In this case, the
      // code does not insert folder 0 again.
      const bool is_inside = folder == 0 && !first.empty() && path.starts_with(first);
      if (!name.empty() && !is_inside) path.insert(0, "/").insert(0, name);
      if (folder == 0) break;
    }
    return path;
  }
};

FileTable read_files(Cursor& cursor, unsigned version, const LineSections& sections) {
  FileTable table;
  if (version >= 5) {
    table.folders = described_entries(cursor, sections);
    table.files = described_entries(cursor, sections);
    return table;
  }
  table.folders.emplace_back();
  table.files.emplace_back();  // file numbers start at 1
  for (auto name = cursor.text(); cursor.good() && !name.empty(); name = cursor.text()) table.folders.push_back({name});
  for (auto name = cursor.text(); cursor.good() && !name.empty(); name = cursor.text()) {
    table.files.push_back({name, cursor.unsigned_number()});
    for (int field = 0; field < 2; ++field) cursor.unsigned_number();  // time and size of the file
  }
  return table;
}

struct Row {
  std::uint32_t address = 0;
  std::uint32_t file = 1;
  std::uint32_t line = 1;
  bool statement = true;
};

/// Executes a unit's line number program, a state machine that produces rows of (address, file, line).
class LineProgram {
 public:
  LineProgram(Bytes unit, unsigned version, const LineSections& sections) : cursor_(unit) {
    const auto header = cursor_.number(4);
    Cursor fields(cursor_.take(header));
    least_length_ = fields.number(1);
    if (version >= 4) fields.number(1);  // operations per instruction, which is more than one only for VLIW
    first_.statement = fields.number(1) != 0;
    line_base_ = static_cast<std::int32_t>(fields.number(1));
    if (line_base_ > 127) line_base_ -= 256;  // a signed byte
    line_range_ = fields.number(1);
    opcode_base_ = fields.number(1);
    for (unsigned op = 1; op < opcode_base_; ++op) operands_.push_back(static_cast<std::uint8_t>(fields.number(1)));
    files_ = read_files(fields, version, sections);
    good_ = fields.good() && line_range_ != 0 && opcode_base_ != 0;
    row_ = first_;
  }

  /// Calls `use` with each row and the address of the next row in its sequence, until `use` returns true. A row applies
  /// up to the address of the next row.
  template <typename Use>
  void for_each(Use use) {
    std::optional<Row> last;
    while (good_ && cursor_.more()) {
      const auto event = next();
      if (event == Event::none) continue;
      if (last && use(*last, row_.address)) return;
      last = row_;
      if (event == Event::end) {
        last.reset();
        row_ = first_;
      }
    }
  }

  std::optional<Row> find(std::uint32_t address) {
    std::optional<Row> found;
    for_each([&](const Row& row, std::uint32_t end) {
      if (row.address <= address && address < end) found = row;
      return found.has_value();
    });
    return found;
  }

  std::string file(std::uint32_t number) const { return files_.path(number); }

 private:
  enum class Event { none, row, end };
  static constexpr unsigned kNamedOpcodes = 12;  // highest standard opcode that this reader interprets

  Event next() {
    const auto opcode = cursor_.number(1);
    if (opcode >= opcode_base_) {
      const auto adjusted = opcode - opcode_base_;
      row_.address += adjusted / line_range_ * least_length_;
      row_.line += static_cast<std::uint32_t>(line_base_ + static_cast<std::int32_t>(adjusted % line_range_));
      return Event::row;
    }
    if (opcode == 0) return extended();
    if (opcode > kNamedOpcodes) {
      for (unsigned i = 0; i < operands_[opcode - 1]; ++i) cursor_.unsigned_number();
      return Event::none;
    }
    return standard(opcode);
  }

  Event standard(unsigned opcode) {
    switch (opcode) {
      case 1:  // copy
        return Event::row;
      case 2:  // advance_pc
        row_.address += cursor_.unsigned_number() * least_length_;
        break;
      case 3:  // advance_line
        row_.line += static_cast<std::uint32_t>(cursor_.signed_number());
        break;
      case 4:  // set_file
        row_.file = cursor_.unsigned_number();
        break;
      case 5:   // set_column
      case 12:  // set_isa
        cursor_.unsigned_number();
        break;
      case 6:  // negate_stmt
        row_.statement = !row_.statement;
        break;
      case 8:  // const_add_pc
        row_.address += (255 - opcode_base_) / line_range_ * least_length_;
        break;
      case 9:  // fixed_advance_pc
        row_.address += cursor_.number(2);
        break;
      default:  // flags without operands
        break;
    }
    return Event::none;
  }

  Event extended() {
    Cursor body(cursor_.take(cursor_.unsigned_number()));
    const auto opcode = body.number(1);
    if (opcode == 1) return Event::end;
    if (opcode == 2) row_.address = body.number(4);
    return Event::none;
  }

  Cursor cursor_;
  std::uint32_t least_length_ = 1;
  std::int32_t line_base_ = 0;
  std::uint32_t line_range_ = 0;
  std::uint32_t opcode_base_ = 0;
  std::vector<std::uint8_t> operands_;  // number of operands of each standard opcode, starting with opcode 1
  FileTable files_;
  Row first_;  // first row of each sequence
  Row row_;
  bool good_ = false;
};

}  // namespace

std::string SourceLine::text() const {
  return fmt::format("{}:{}", file, line);
}

namespace {

/// Calls `use` with the line number program of each unit, until `use` returns true.
template <typename Use>
void for_each_unit(const LineSections& sections, Use use) {
  Cursor units(sections.line);
  while (units.more()) {
    // A unit in the 64-bit format begins with 0xffffffff. This length exceeds the size of the section, so the loop ends
    // here.
    Cursor unit(units.take(units.number(4)));
    const auto version = unit.number(2);
    if (version < 2 || version > 5) continue;
    if (version == 5) unit.take(2);  // skips the sizes of address and segment selector
    LineProgram program(unit.rest(), version, sections);
    if (use(program)) return;
  }
}

}  // namespace

std::optional<SourceLine> find_line(const LineSections& sections, std::uint32_t address) {
  std::optional<SourceLine> found;
  for_each_unit(sections, [&](LineProgram& program) {
    const auto row = program.find(address);
    if (!row || row->line == 0) return false;
    const auto path = program.file(row->file);
    found = SourceLine{path.substr(path.find_last_of('/') + 1), row->line};
    return true;
  });
  return found;
}

/// In optimised code, a row of the line number table often has the same address as the next row, so that its range is
/// empty. The list also contains such a range, because the instruction at its address is executed each time the
/// statement begins.
std::vector<LineRange> all_lines(const LineSections& sections) {
  std::vector<LineRange> ranges;
  for_each_unit(sections, [&](LineProgram& program) {
    program.for_each([&](const Row& row, std::uint32_t end) {
      if (row.statement && row.line != 0 && row.address <= end) {
        ranges.push_back({row.address, end, program.file(row.file), row.line});
      }
      return false;
    });
    return false;
  });
  return ranges;
}

}  // namespace mebots::soc
