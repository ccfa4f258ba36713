// Letters from a font file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

namespace weir::rendering {

/// How much of each pixel a text covers, 0 to 255, row by row from the top.
struct TextMask {
  int width = 0, height = 0;
  std::vector<std::uint8_t> coverage;
};

class Font {
 public:
  /// Throws an io Error if the file is not a font.
  explicit Font(const std::filesystem::path& file);
  ~Font();
  Font(Font&&) noexcept;
  Font& operator=(Font&&) noexcept;

  /// One line of UTF-8 text; `size` is the height of the font's square in pixels, at least 1. The mask is as
  /// high as the font's line, so that texts of one size have one baseline. Bytes that are no UTF-8 show as
  /// "�".
  TextMask write(std::string_view text, float size);

 private:
  class Face;
  std::unique_ptr<Face> face_;
};

/// The characters of UTF-8 text.
std::vector<char32_t> charactersOf(std::string_view text);

}  // namespace weir::rendering
