// SPDX-License-Identifier: Apache-2.0
#include "record/sink/hdf5_sink.hpp"

#include "mebots/error.hpp"
#include "record/sink/hdf5_file.hpp"

#include <fmt/format.h>

#include <bit>
#include <charconv>
#include <cstring>
#include <set>
#include <string>
#include <utility>

namespace mebots::master {
namespace {

using hdf5::Handle;
using hdf5::library;
using hdf5::put_attribute;
using modeldesc::Type;

constexpr hsize_t kChunkRows = 4096;

Handle memory_type(Type type) {
  const auto copy = [](hid_t native) { return Handle(H5Tcopy(native), &H5Tclose); };
  switch (type) {
    case Type::real:
      return copy(H5T_NATIVE_DOUBLE);
    case Type::float32:
      return copy(H5T_NATIVE_FLOAT);
    case Type::integer:
    case Type::enumeration:
      return copy(H5T_NATIVE_INT32);
    case Type::int8:
      return copy(H5T_NATIVE_INT8);
    case Type::int16:
      return copy(H5T_NATIVE_INT16);
    case Type::int64:
      return copy(H5T_NATIVE_INT64);
    case Type::boolean:
    case Type::uint8:
      return copy(H5T_NATIVE_UINT8);
    case Type::uint16:
      return copy(H5T_NATIVE_UINT16);
    case Type::uint32:
      return copy(H5T_NATIVE_UINT32);
    case Type::uint64:
      return copy(H5T_NATIVE_UINT64);
    case Type::string:
    case Type::binary:
    case Type::clock:
      break;
  }
  return hdf5::text_type();
}

/// Returns the path `instance/variable` of a dataset, without other slashes.
std::string link_name(const std::string& name) {
  auto link = hdf5::without_slashes(name);
  const auto dot = link.find('.');
  if (dot != std::string::npos) link[dot] = '/';
  return link;
}

}  // namespace

struct Hdf5Sink::File {
  struct Column {
    Type type_of_values;
    Handle type;
    Handle dataset;
  };

  hdf5::File file;
  std::vector<Column> columns;  // the first column is the time
  hsize_t rows = 0;
  std::vector<std::byte> numbers;  // values of one column
  std::vector<const char*> texts;

  explicit File(const std::filesystem::path& path) : file(path) {}

  void add(const std::string& link, const RecordColumn& column) {
    constexpr hsize_t kNone = 0;
    constexpr hsize_t kUnlimited = H5S_UNLIMITED;
    Handle type = memory_type(column.type);
    const Handle space(H5Screate_simple(1, &kNone, &kUnlimited), &H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), &H5Pclose);
    H5Pset_chunk(creation, 1, &kChunkRows);
    if (column.kind() != ValueKind::string && column.kind() != ValueKind::binary) {
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 1);
    }
    H5Pset_obj_track_times(creation, false);  // equal runs must give equal files
    const Handle links(H5Pcreate(H5P_LINK_CREATE), &H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    Handle dataset(H5Dcreate2(file.id(), link.c_str(), type, space, links, creation, H5P_DEFAULT), &H5Dclose);
    if (dataset < 0) file.fail();
    put_attribute(dataset, "name", column.name);
    put_attribute(dataset, "unit", column.unit);
    columns.push_back({column.type, std::move(type), std::move(dataset)});
  }

  void append(Column& column, hsize_t count, const void* values) {
    const auto total = rows + count;
    if (H5Dset_extent(column.dataset, &total) < 0) file.fail();
    const Handle space(H5Dget_space(column.dataset), &H5Sclose);
    H5Sselect_hyperslab(space, H5S_SELECT_SET, &rows, nullptr, &count, nullptr);
    const Handle memory(H5Screate_simple(1, &count, nullptr), &H5Sclose);
    if (H5Dwrite(column.dataset, column.type, memory, space, H5P_DEFAULT, values) < 0) file.fail();
  }

  /// Converts a column of a block to the type of its dataset.
  const void* gather(const Column& column, const RowBlock& block, std::size_t index) {
    const auto cell = [&](std::size_t row) { return block.cells[row * block.cells_per_row + index]; };
    const auto fill = [&]<typename T>(T /*type*/, auto convert) -> const void* {
      numbers.resize(block.rows() * sizeof(T));
      for (std::size_t row = 0; row < block.rows(); ++row) {
        const T value = convert(cell(row));
        std::memcpy(numbers.data() + row * sizeof(T), &value, sizeof(T));
      }
      return numbers.data();
    };
    const auto whole = [&]<typename T>(T type) { return fill(type, [](auto bits) { return static_cast<T>(bits); }); };
    switch (column.type_of_values) {
      case Type::real:
        return fill(double{}, [](auto bits) { return std::bit_cast<double>(bits); });
      case Type::float32:
        return fill(float{}, [](auto bits) { return static_cast<float>(std::bit_cast<double>(bits)); });
      case Type::integer:
      case Type::enumeration:
        return whole(std::int32_t{});
      case Type::int8:
        return whole(std::int8_t{});
      case Type::int16:
        return whole(std::int16_t{});
      case Type::int64:
        return whole(std::int64_t{});
      case Type::boolean:
      case Type::uint8:
        return whole(std::uint8_t{});
      case Type::uint16:
        return whole(std::uint16_t{});
      case Type::uint32:
        return whole(std::uint32_t{});
      case Type::uint64:
        return whole(std::uint64_t{});
      case Type::string:
      case Type::binary:
      case Type::clock:
        break;
    }
    texts.resize(block.rows());
    for (std::size_t row = 0; row < texts.size(); ++row) texts[row] = block.texts[cell(row)].c_str();
    return texts.data();
  }
};

Hdf5Sink::Hdf5Sink(const std::vector<RecordColumn>& columns, const std::filesystem::path& file) {
  const std::lock_guard lock(library());
  auto made = std::make_unique<File>(file);  // declared after the lock, so that an error closes the file under the lock
  made->add("time", {"time", "s", Type::real});
  std::set<std::string> used;
  for (const auto& column : columns) {
    auto link = link_name(column.name);
    while (!used.insert(link).second) link += '|';  // makes names unique that differ only in `/` and `|`
    made->add(link, column);
  }
  made->file.check();
  file_ = std::move(made);
}

Hdf5Sink::~Hdf5Sink() {
  const std::lock_guard lock(library());
  file_.reset();
}

void Hdf5Sink::put_parameters(const std::vector<ParameterValue>& parameters) {
  const std::lock_guard lock(library());
  if (H5Lexists(file_->file.id(), "parameters", H5P_DEFAULT) > 0) return;
  const Handle group(H5Gcreate2(file_->file.id(), "parameters", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), &H5Gclose);
  for (const auto& [name, unit, value, parameter_type] : parameters) {
    const auto link = hdf5::without_slashes(name);
    const bool is_number = master::is_number(parameter_type);
    double number = 0;
    if (is_number) std::from_chars(value.data(), value.data() + value.size(), number);
    const Handle type = memory_type(is_number ? Type::real : Type::string);
    const Handle space(H5Screate(H5S_SCALAR), &H5Sclose);
    const Handle set(H5Dcreate2(group, link.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), &H5Dclose);
    const char* text = value.c_str();
    const void* content = is_number ? static_cast<const void*>(&number) : static_cast<const void*>(&text);
    if (set < 0 || H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, content) < 0) file_->file.fail();
    put_attribute(set, "unit", unit);
  }
  file_->file.check();
}

void Hdf5Sink::write(const RowBlock& block) {
  if (block.rows() == 0) return;
  const std::lock_guard lock(library());
  for (std::size_t i = 0; i < file_->columns.size(); ++i) {
    auto& column = file_->columns[i];
    file_->append(column, block.rows(), file_->gather(column, block, i));
  }
  file_->file.check();
  file_->rows += block.rows();
}

void Hdf5Sink::flush() {
  const std::lock_guard lock(library());
  if (file_->file.id() < 0) return;  // already closed
  if (H5Fflush(file_->file.id(), H5F_SCOPE_GLOBAL) < 0) file_->file.fail();
  file_->file.check();
}

void Hdf5Sink::renamed(const std::filesystem::path& file) {
  const std::lock_guard lock(library());
  file_->file.renamed(file);
}

void Hdf5Sink::close() {
  const std::lock_guard lock(library());
  file_->columns.clear();
  file_->file.close();
}

void Hdf5Sink::visit(state::Visitor& v) {
  std::uint64_t rows = file_->rows;
  v("rows", rows);
  if (!v.restores()) return;
  const std::lock_guard lock(library());
  if (rows > file_->rows)
    throw Error(ErrorCode::state_damaged,
                fmt::format("{}: this file has fewer rows than the saved state", file_->file.path().string()));
  const hsize_t extent = rows;
  for (const auto& column : file_->columns) {
    if (H5Dset_extent(column.dataset, &extent) < 0) file_->file.fail();
  }
  file_->rows = rows;
}

}  // namespace mebots::master
