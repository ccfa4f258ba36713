// Arrays by name in one file, as NumPy's load() reads them: a zip archive, not compressed, of .npy files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/base/vec.h"

namespace weir::rendering {

class NpzFile {
 public:
  // Names are different, of ASCII letters, digits and _. Vectors become rows of three numbers. Throws an io
  // Error where the file would be larger than 4 GB, which such archives do not hold.
  void add(std::string_view name, std::span<const float> values);
  void add(std::string_view name, std::span<const Vec3f> values);
  void add(std::string_view name, std::span<const Vec3i> values);
  void add(std::string_view name, std::string_view bytes);
  /// Rows and columns of vectors.
  void add(std::string_view name, std::span<const Vec3f> values, int height, int width);

  /// The whole file; nothing can be added any more.
  std::string finish() &&;

 private:
  void add(std::string_view name, std::string_view type, const std::string& shape,
           std::span<const std::byte> bytes);

  std::string content_, directory_;
  int entries_ = 0;
};

}  // namespace weir::rendering
