// Values as a row of bytes, for another process of the same program.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/base/error.h"

namespace weir {

class Packer {
 public:
  void addText(std::string_view text) {
    const std::uint64_t size = text.size();
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size).append(text);
  }
  template <class T>
  void addAll(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    addText({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Takes values out in the order in which they were added. Throws an io Error if they are not there.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  std::string_view text() {
    std::uint64_t size = 0;
    std::memcpy(&size, take(sizeof size).data(), sizeof size);
    return take(size);
  }
  template <class T>
  std::vector<T> all() {
    const std::string_view bytes = text();
    if (bytes.size() % sizeof(T) != 0) throw damaged();
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  bool atEnd() const { return rest_.empty(); }

 private:
  static Error damaged() { return ioError("the file is damaged: its contents are inconsistent"); }
  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) throw damaged();
    const std::string_view bytes = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return bytes;
  }

  std::string_view rest_;
};

}  // namespace weir
