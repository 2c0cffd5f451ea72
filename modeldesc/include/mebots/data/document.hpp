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

/// A JSON text (RFC 8259) that knows where each of its values stands, and collects what its readers find wrong. Reading
/// one takes time in proportion to its length. One thread at a time.
class Document {
 public:
  /// Deeper texts are refused: no file of ours needs more, and whoever walks one may recurse.
  static constexpr std::size_t kDeepest = 100;

  /// Throws Error when the file cannot be read, Mistakes when it is not JSON.
  explicit Document(const std::filesystem::path& file);
  /// `name` stands in mistakes.
  Document(std::string_view text, std::string name);
  ~Document();
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  /// What `read` makes of the root. Throws Mistakes when there were any, each key that occurs twice included. Nodes
  /// must not outlive the document.
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
