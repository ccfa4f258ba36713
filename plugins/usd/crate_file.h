// Writes .usdc files, the binary form of USD's layers ("crate"), with what frames need: prims, and attributes
// with arrays of numbers at one time.
//
// The layout is that of version 0.8.0 in OpenUSD's pxr/usd/sdf/crateFile.h. Tables that it wants compressed
// are LZ4 blocks of literals alone, and whole numbers are all of four bytes: next to the arrays they are
// nothing.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

class CrateFile {
 public:
  /// For attributes whose values are of this time.
  explicit CrateFile(double time);

  /// Begins a prim below the one that was begun last and has not been ended. It only adds to one of another
  /// layer (SdfSpecifierOver).
  void beginPrim(std::string_view name);
  void endPrim();

  /// An attribute of the present prim; `type` as USD names it, "point3f[]".
  void add(std::string_view name, std::string_view type, std::span<const Vec3f> values);
  void add(std::string_view name, std::string_view type, std::span<const float> values);
  void add(std::string_view name, std::string_view type, std::span<const std::int32_t> values);
  void add(std::string_view name, std::string_view type, std::span<const std::int64_t> values);

  /// The whole file; all prims must have been ended (WEIR_CHECK).
  std::string finish() &&;

 private:
  enum class Type : std::uint64_t;
  using Rep = std::uint64_t;  // of a value: its type, and the value or where it is in the file

  struct Node {
    int token;  // of its name
    bool isAttribute = false;
    std::string type;  // of an attribute
    Rep samples = 0;   // of an attribute
    std::vector<std::size_t> children;
  };
  struct Tables;

  int tokenOf(std::string_view text);
  Rep valueOf(std::string_view token);
  Rep listOf(const std::vector<int>& tokens);
  Rep samplesOf(Rep value);
  std::uint64_t append(std::string_view bytes);
  void addArray(std::string_view name, std::string_view type, Type element, std::span<const std::byte> bytes,
                std::size_t count);
  void collect(std::size_t node, bool hasSibling, Tables& tables);
  std::vector<std::pair<int, Rep>> fieldsOf(const Node& node);

  double time_;
  std::string content_;
  std::map<std::string, int, std::less<>> tokens_;
  std::vector<std::string> texts_;  // of the tokens
  std::vector<Node> nodes_;         // the first is the root
  std::vector<std::size_t> open_;   // from the root to the present prim
};

}  // namespace weir::rendering
