// Where a value stands: the file and the JSON pointer that lead to it. Reading functions pass it down, so
// that every error can name file, line, column and pointer.
#pragma once

#include <string>
#include <string_view>

#include "framework/base/api.h"
#include "framework/base/error.h"
#include "framework/base/value.h"

namespace WEIR_API weir {

struct Place {
  std::string file;     ///< the scene file
  std::string pointer;  ///< "/nodes/water/params"
  std::string folder;   ///< what relative paths are relative to

  Place operator/(std::string_view key) const { return {file, pointer + "/" + escape(key), folder}; }
  Place operator/(std::size_t index) const { return {file, pointer + "/" + std::to_string(index), folder}; }

  Location of(const Value& value) const {
    const std::string& source = value.origin ? value.origin->name : file;
    return {.file = source, .line = value.line, .column = value.column, .pointer = pointer};
  }
  /// What a relative path in this value is relative to.
  const std::string& folderOf(const Value& value) const {
    return value.origin ? value.origin->folder : folder;
  }
  /// A scene error at this place.
  Error error(const Value& at, std::string message, std::string allowed = {}, std::string hint = {}) const {
    Error e = sceneError(std::move(message), std::move(allowed), std::move(hint));
    e.at(of(at));
    return e;
  }

 private:
  /// RFC 6901: ~ and / are escaped in a pointer.
  static std::string escape(std::string_view key) {
    std::string text;
    for (const char c : key)
      text += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
    return text;
  }
};

}  // namespace weir
