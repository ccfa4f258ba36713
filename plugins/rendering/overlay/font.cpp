#include "plugins/rendering/overlay/font.h"

#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::rendering {
std::vector<char32_t> charactersOf(std::string_view text) {
  constexpr char32_t kReplacement = 0xfffd;
  std::vector<char32_t> characters;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8Length(text, at);
    const auto byte = [&](std::size_t i) { return char32_t(static_cast<unsigned char>(text[at + i])); };
    if (length == 0) {
      characters.push_back(kReplacement);
      ++at;
      continue;
    }
    // The first byte of n has n + 1 leading bits that say so; the others have two.
    char32_t character = length == 1 ? byte(0) : byte(0) & (0x7fu >> length);
    for (std::size_t i = 1; i < length; ++i) character = character << 6 | (byte(i) & 0x3f);
    characters.push_back(character);
    at += length;
  }
  return characters;
}

class Font::Face {
 public:
  explicit Face(const std::filesystem::path& file) {
    if (FT_Init_FreeType(&library_)) throw ioError("the font library FreeType cannot be started");
    if (FT_New_Face(library_, file.c_str(), 0, &face_)) {
      FT_Done_FreeType(library_);
      throw ioError("the font " + file.string() + " cannot be read", "a TrueType or OpenType font");
    }
  }
  ~Face() {
    FT_Done_Face(face_);
    FT_Done_FreeType(library_);
  }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  FT_Face operator->() const { return face_; }
  FT_Face get() const { return face_; }

 private:
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
};

Font::Font(const std::filesystem::path& file) : face_(std::make_unique<Face>(file)) {}
Font::~Font() = default;
Font::Font(Font&&) noexcept = default;
Font& Font::operator=(Font&&) noexcept = default;

namespace {

constexpr int kUnits = 64;  // of FreeType's lengths, per pixel

/// Adds a letter, whose origin is at (x, baseline), to a mask.
void stamp(TextMask& mask, const FT_Bitmap& letter, int x, int y) {
  for (int row = 0; row < int(letter.rows); ++row) {
    for (int column = 0; column < int(letter.width); ++column) {
      const int px = x + column, py = y + row;
      if (px < 0 || py < 0 || px >= mask.width || py >= mask.height) continue;
      std::uint8_t& pixel = mask.coverage[std::size_t(py) * std::size_t(mask.width) + std::size_t(px)];
      pixel = std::max(pixel, letter.buffer[row * letter.pitch + column]);
    }
  }
}

}  // namespace

TextMask Font::write(std::string_view text, float size) {
  const FT_Face face = face_->get();
  FT_Set_Char_Size(face, 0, FT_F26Dot6(std::lround(std::max(size, 1.0f) * kUnits)), 72, 72);
  const std::vector<char32_t> characters = charactersOf(text);

  // Two rounds: the first one finds the width.
  TextMask mask;
  const int baseline = int(face->size->metrics.ascender + kUnits - 1) / kUnits;
  mask.height = baseline + int(-face->size->metrics.descender + kUnits - 1) / kUnits;
  for (const bool drawing : {false, true}) {
    FT_Pos pen = kUnits;  // a pixel of room at both ends, for letters that reach beyond their advance
    FT_UInt before = 0;
    for (const char32_t character : characters) {
      const FT_UInt letter = FT_Get_Char_Index(face, character);
      FT_Vector kerning{0, 0};
      if (before && letter) FT_Get_Kerning(face, before, letter, FT_KERNING_DEFAULT, &kerning);
      pen += kerning.x;
      before = letter;
      if (FT_Load_Glyph(face, letter, drawing ? FT_LOAD_RENDER | FT_LOAD_TARGET_LIGHT : FT_LOAD_TARGET_LIGHT))
        continue;
      const FT_GlyphSlot slot = face->glyph;
      if (drawing)
        stamp(mask, slot->bitmap, int(pen / kUnits) + slot->bitmap_left, baseline - slot->bitmap_top);
      pen += slot->advance.x;
    }
    if (!drawing) {
      mask.width = int(pen / kUnits) + 2;
      mask.coverage.assign(std::size_t(mask.width) * std::size_t(mask.height), 0);
    }
  }
  return mask;
}

}  // namespace weir::rendering
