// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Defines the messages between mebots-fmu-host and mebots-windows-host.exe, which runs the Windows library of an FMU
/// under wine. The type of an FMI function determines how its arguments are sent. Both programs include this header.
namespace mebots::master::windows {

/// Function numbers of requests that call no FMI function. for_each_function() defines the other numbers.
inline constexpr std::uint32_t kLoad = 0xffff'0000;
inline constexpr std::uint32_t kUnload = 0xffff'0001;

enum class Reply : std::uint32_t {
  result,     ///< the last reply of a request; contains the result
  log,        ///< call of the logger: environment, instance, status, category, text
  not_found,  ///< kLoad failed; contains the Windows error code
  exception,  ///< a structured exception ends the process; contains its code and address
};

struct FrameHeader {
  std::uint32_t kind = 0;  ///< function number of a request, or a Reply
  std::uint32_t size = 0;  ///< number of bytes after the header
};

class Writer {
 public:
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { append(&value, sizeof value); }
  void put(std::string_view bytes) {
    put(static_cast<std::uint64_t>(bytes.size()));
    append(bytes.data(), bytes.size());
  }
  void put_text(const char* text) {
    put(text != nullptr);
    if (text != nullptr) put(std::string_view(text));
  }
  void put_binary(const std::uint8_t* bytes, std::size_t size) {
    put(bytes != nullptr);
    if (bytes != nullptr) put(std::string_view(reinterpret_cast<const char*>(bytes), size));
  }

  /// Returns a frame with all values since the last clear().
  const std::string& frame(std::uint32_t kind) {
    const FrameHeader header{kind, static_cast<std::uint32_t>(bytes_.size() - sizeof(FrameHeader))};
    std::memcpy(bytes_.data(), &header, sizeof header);
    return bytes_;
  }
  void clear() { bytes_.resize(sizeof(FrameHeader)); }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  std::string bytes_ = std::string(sizeof(FrameHeader), '\0');
};

/// Reads the values of a message. Throws std::runtime_error if the message ends too early.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string_view get_bytes() { return take(get<std::uint64_t>()); }
  /// Reads a value of put_text() or put_binary(); nullopt if the pointer was null.
  std::optional<std::string> get_text() {
    if (!get<bool>()) return std::nullopt;
    return std::string(get_bytes());
  }

 private:
  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) throw std::runtime_error("a message of the process for Windows is too short");
    const auto taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

  std::string_view bytes_;
};

/// Determines how the arguments of an FMI function are sent. A pointer refers to one value, or to an array whose length
/// is another argument. Constant arrays are sent only to the FMU. Other arrays are sent in both directions.
template <typename... Arguments>
struct Signature {
  static constexpr std::size_t kCount = sizeof...(Arguments);
  static constexpr int kSingle = -1;

  template <std::size_t i>
  using Argument = std::tuple_element_t<i, std::tuple<Arguments...>>;

  /// Returns the index of the argument that is the length of the array `i`; kSingle if the pointer refers to one value.
  /// The length is the next argument or, if that is not a length, the nearest length before the array. An array of
  /// sizes has the length of the array that follows it.
  static consteval int length_of(std::size_t i) {
    constexpr std::array<bool, kCount> kLengths{std::is_same_v<Arguments, std::size_t>...};
    constexpr std::array<bool, kCount> kPointers{std::is_pointer_v<Arguments>...};
    constexpr std::array<bool, kCount> kStates{std::is_same_v<Arguments, void**>...};
    constexpr std::array<bool, kCount> kSizes{
        std::is_same_v<std::remove_const_t<std::remove_pointer_t<Arguments>>, std::size_t>...};
    if (kStates[i]) return kSingle;
    if (i + 1 < kCount && kLengths[i + 1]) return static_cast<int>(i + 1);
    if (kSizes[i] && i + 1 < kCount && kPointers[i + 1]) return length_of(i + 1);
    if (is_directional_derivative() && i == 6) return 2;
    for (auto before = i; before-- > 0;) {
      if (kLengths[before]) return static_cast<int>(before);
    }
    return kSingle;
  }

 private:
  /// True for fmi2GetDirectionalDerivative, whose last array has the length of the first one.
  static consteval bool is_directional_derivative() {
    using Numbers = const unsigned*;
    return std::is_same_v<std::tuple<Arguments...>,
                          std::tuple<void*, Numbers, std::size_t, Numbers, std::size_t, const double*, double*>>;
  }
};

template <typename T>
using Element = std::remove_const_t<std::remove_pointer_t<T>>;

template <typename T>
concept Function = std::is_pointer_v<T> && std::is_function_v<std::remove_pointer_t<T>>;
template <typename T>
concept Value = (std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, void*>);
/// A text that ends with a zero byte: a `const char*` without a length argument. With a length argument, it is an array
/// of bytes.
template <typename T, int length>
concept Text = std::is_same_v<T, const char*> && length < 0;
template <typename T>
concept Array = std::is_pointer_v<T> && !Function<T> && !std::is_same_v<T, void*>;
template <typename T>
concept InputArray = Array<T> && std::is_const_v<std::remove_pointer_t<T>>;
template <typename T>
concept ArrayOfTexts = Array<T> && std::is_same_v < Element<T>,
const char* > ;
template <typename T>
concept ArrayOfBytes = Array<T> && std::is_same_v < Element<T>,
const std::uint8_t* > ;

struct Slot {
  std::uint64_t count = 0;
  bool is_null = false;
  /// The memory that the C function reads or writes: numbers, or pointers to texts and to arrays of bytes.
  std::vector<std::byte> elements;
  std::vector<std::optional<std::string>> texts;

  template <typename T>
  T* as_array() {
    return is_null ? nullptr : reinterpret_cast<T*>(elements.data());
  }
  void keep_bytes(std::string_view bytes) {
    const auto* const start = reinterpret_cast<const std::byte*>(bytes.data());
    elements.assign(start, start + bytes.size());
  }
  /// Stores texts and an array of pointers to them. The pointer of a missing text must be null. It must not point to an
  /// empty text, because for a Binary, the FMU may read as many bytes as the size of the Binary says.
  template <typename Pointer>
  void keep_texts(std::vector<std::optional<std::string>> kept) {
    texts = std::move(kept);
    elements.resize(texts.size() * sizeof(Pointer));
    for (std::size_t i = 0; i < texts.size(); ++i) {
      const auto pointer = texts[i] ? reinterpret_cast<Pointer>(texts[i]->c_str()) : nullptr;
      std::memcpy(elements.data() + i * sizeof pointer, &pointer, sizeof pointer);
    }
  }
};

}  // namespace mebots::master::windows
