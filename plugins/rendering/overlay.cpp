#include "plugins/rendering/overlay.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <vector>

#include "framework/base/error.h"
#include "framework/base/text.h"
#include "framework/run/progress.h"

namespace weir::rendering {

namespace {

struct Ink {
  float r, g, b;  // sRGB, 0 to 1
};

constexpr Ink kText{0.13f, 0.15f, 0.18f};
constexpr Ink kFaintText{0.30f, 0.33f, 0.37f};
constexpr Ink kPlate{0.97f, 0.98f, 0.99f};
constexpr float kPlateOpacity = 0.62f;

void blend(Picture& picture, int x, int y, const Ink& ink, float alpha) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return;
  std::uint8_t* p = &picture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                                      static_cast<std::size_t>(x))];
  const float parts[3] = {ink.r, ink.g, ink.b};
  for (int k = 0; k < 3; ++k)
    p[k] = static_cast<std::uint8_t>(std::lround((1 - alpha) * float(p[k]) + alpha * 255 * parts[k]));
}

/// A rectangle with rounded corners, lightened, so that text can be read on anything.
void drawPlate(Picture& picture, int left, int top, int width, int height, int radius) {
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float dx = float(std::max({radius - x, x - (width - 1 - radius), 0}));
      const float dy = float(std::max({radius - y, y - (height - 1 - radius), 0}));
      const float inside = std::clamp(float(radius) - std::hypot(dx, dy) + 0.5f, 0.0f, 1.0f);
      blend(picture, left + x, top + y, kPlate, kPlateOpacity * inside);
    }
}

/// Code points of UTF-8 text.
std::u32string decoded(std::string_view text) {
  std::u32string points;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t size = std::max<std::size_t>(utf8Length(text, at), 1);
    const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[at + k]); };
    char32_t point = size == 1 ? byte(0) : byte(0) & (0x7Fu >> size);
    for (std::size_t k = 1; k < size; ++k) point = (point << 6) | (byte(k) & 0x3Fu);
    points.push_back(point);
    at += size;
  }
  return points;
}

}  // namespace

struct Overlay::Font {
  explicit Font(const std::filesystem::path& file) {
    if (FT_Init_FreeType(&library) != 0) throw ioError("FreeType cannot be initialised");
    if (FT_New_Face(library, file.c_str(), 0, &face) != 0) {
      FT_Done_FreeType(library);
      Error e = ioError("the font cannot be read");
      throw e.at({.file = file.string()});
    }
  }
  ~Font() {
    FT_Done_Face(face);
    FT_Done_FreeType(library);
  }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  void setSize(int pixels) { FT_Set_Pixel_Sizes(face, 0, static_cast<FT_UInt>(pixels)); }

  int widthOf(const std::string& text) {
    long width = 0;
    for (const char32_t c : decoded(text))
      if (FT_Load_Char(face, c, FT_LOAD_DEFAULT) == 0) width += face->glyph->advance.x;
    return static_cast<int>(width >> 6);
  }

  /// `baseline` is the y of the line that the letters stand on.
  void draw(Picture& picture, const std::string& text, int x, int baseline, const Ink& ink) {
    long pen = long{x} << 6;
    for (const char32_t c : decoded(text)) {
      if (FT_Load_Char(face, c, FT_LOAD_RENDER) != 0) continue;
      const FT_GlyphSlot glyph = face->glyph;
      const FT_Bitmap& bitmap = glyph->bitmap;
      for (unsigned row = 0; row < bitmap.rows; ++row)
        for (unsigned column = 0; column < bitmap.width; ++column)
          blend(picture, static_cast<int>(pen >> 6) + glyph->bitmap_left + static_cast<int>(column),
                baseline - glyph->bitmap_top + static_cast<int>(row), ink,
                float(bitmap.buffer[row * static_cast<unsigned>(bitmap.pitch) + column]) / 255);
      pen += glyph->advance.x;
    }
  }

  FT_Library library = nullptr;
  FT_Face face = nullptr;
};

Overlay::Overlay(const std::filesystem::path& font) : font_(std::make_unique<Font>(font)) {}
Overlay::~Overlay() = default;

void Overlay::drawCaption(Picture& picture, const std::string& title, double time, std::int64_t particles) {
  const int size = std::max(8, picture.height / 36);
  const int margin = size, line = size * 3 / 2;
  const std::string facts = fmt::format("t = {:.3f} s    {} particles", time, groupedText(particles));
  font_->setSize(size);
  int width = font_->widthOf(facts);
  if (!title.empty()) width = std::max(width, font_->widthOf(title));
  const int lines = title.empty() ? 1 : 2;
  drawPlate(picture, margin / 2, margin / 2, width + margin, lines * line + margin / 2, size / 2);
  int baseline = margin / 2 + line;
  if (!title.empty()) {
    font_->draw(picture, title, margin, baseline, kText);
    baseline += line;
  }
  font_->draw(picture, facts, margin, baseline, kFaintText);
}

void Overlay::drawColorBar(Picture& picture, const ColorBar& bar) {
  constexpr int kTicks = 5;
  const int size = std::max(8, picture.height / 42);
  const int barWidth = size, barHeight = picture.height * 2 / 5;
  font_->setSize(size);
  const std::vector<double> ticks = roundTicks(bar.low, bar.high, kTicks);
  std::vector<std::string> labels;
  int labelWidth = 0;
  for (const double tick : ticks) {
    labels.push_back(fmt::format("{:.6g}", tick));
    labelWidth = std::max(labelWidth, font_->widthOf(labels.back()));
  }
  const std::string caption = bar.unit.empty() ? bar.quantity : bar.quantity + " [" + bar.unit + "]";
  const int width = std::max(barWidth + size / 2 + labelWidth, font_->widthOf(caption));
  const int left = picture.width - width - 2 * size, top = (picture.height - barHeight) / 2;
  drawPlate(picture, left - size, top - 5 * size / 2, width + 2 * size, barHeight + 4 * size, size / 2);
  font_->draw(picture, caption, left, top - size, kText);
  for (int y = 0; y < barHeight; ++y) {
    const Vec3f c = colorAt(bar.map, 1 - (float(y) + 0.5f) / float(barHeight));
    for (int x = 0; x < barWidth; ++x) blend(picture, left + x, top + y, {c.x, c.y, c.z}, 1);
  }
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double share = (ticks[i] - bar.low) / (double(bar.high) - bar.low);
    const int y = top + static_cast<int>(std::lround((1 - share) * (barHeight - 1)));
    for (int x = barWidth; x < barWidth + size / 3; ++x) blend(picture, left + x, y, kText, 1);
    font_->draw(picture, labels[i], left + barWidth + size / 2, y + size * 3 / 8, kText);
  }
}

std::vector<double> roundTicks(double low, double high, int wanted) {
  const double rough = (high - low) / std::max(wanted - 1, 1);
  if (!(rough > 0) || !std::isfinite(rough)) return {low};
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= 0.999 * rough) step = factor * power;
  std::vector<double> ticks;
  constexpr double kSlack = 1e-6;  // of a step, for ends that are round but for their last bits
  for (double k = std::ceil(low / step - kSlack); k * step <= high + kSlack * step; ++k)
    ticks.push_back(k * step + 0.0);
  return ticks;
}

std::filesystem::path fontFile() {
  // Installed beside this library: <prefix>/lib/weir/plugins/… and <prefix>/share/weir/fonts/….
  constexpr const char* kName = "DejaVuSans.ttf";
  std::vector<std::filesystem::path> candidates;
  Dl_info self{};
  if (dladdr(reinterpret_cast<const void*>(&fontFile), &self) != 0) {
    const auto folder = std::filesystem::absolute(self.dli_fname).parent_path();
    candidates.push_back(folder / "../../../share/weir/fonts" / kName);
    candidates.push_back(folder / "../share/weir/fonts" / kName);  // of a test program
  }
  candidates.push_back(std::filesystem::path("/usr/share/fonts/truetype/dejavu") / kName);
  for (const auto& file : candidates) {
    std::error_code error;
    if (std::filesystem::exists(file, error)) return file;
  }
  throw ioError("the font " + std::string(kName) + " is not installed",
                "share/weir/fonts/" + std::string(kName),
                "install the package fonts-dejavu-core, or set render.overlay and render.color.bar to false");
}

}  // namespace weir::rendering
