// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/data/mistakes.hpp"
#include "mebots/data/node.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace mebots::data {

/// Holds a parsed JSON text (RFC 8259) and the line and column of each value. Collects the mistakes that readers find
/// in it. Parsing takes linear time. Not thread-safe.
class Document {
 public:
  /// The greatest permitted depth of nesting. Deeper texts are rejected, because readers may be recursive.
  static constexpr std::size_t kDeepest = 100;

  /// Parses a file. Throws Error if the file cannot be read, Mistakes if it is not JSON.
  explicit Document(const std::filesystem::path& file);
  /// Parses a text. Error messages use `name` as the file name.
  Document(std::string_view text, std::string name);
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// Calls `read` with the root node and returns its result. Throws Mistakes if a reader or the parser reported a
  /// mistake. Nodes must not outlive the document.
  template <typename Read>
  auto read(const Read& read) {
    using Result = std::invoke_result_t<const Read&, const Node&>;
    const Node top = root();
    if constexpr (std::is_void_v<Result>) {
      top.attempt([&] { read(top); });
      check();
    } else {
      std::optional<Result> result;
      top.attempt([&] { result.emplace(read(top)); });
      check();
      return std::move(*result);
    }
  }

 private:
  friend class Node;
  friend struct JsonDocument;
  struct Content;

  explicit Document(std::unique_ptr<Content> content);
  Node root();
  void check();

  std::unique_ptr<Content> content_;
};

}  // namespace mebots::data
