#include "plugins/rendering/output/jpeg.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <numbers>
#include <string_view>
#include <vector>

#include "framework/base/check.h"

namespace weir::rendering {

namespace {

constexpr int kSide = 8, kCells = kSide * kSide;
using Block = std::array<float, kCells>;

// The tables of T.81, annex K, row by row.
constexpr std::array<std::uint8_t, kCells> kLightSteps{
    16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,   // rows 1, 2
    14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,   // rows 3, 4
    18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,   // rows 5, 6
    49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};  // rows 7, 8
constexpr std::array<std::uint8_t, kCells> kColorSteps{
    17, 18, 24, 47, 99, 99, 99, 99, 18, 21, 26, 66, 99, 99, 99, 99,   // rows 1, 2
    24, 26, 56, 99, 99, 99, 99, 99, 47, 66, 99, 99, 99, 99, 99, 99,   // rows 3, 4
    99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99,   // rows 5, 6
    99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99, 99};  // rows 7, 8

/// How many codes there are of each length from 1 to 16 bits, and what they stand for, shortest first.
struct CodeTable {
  std::array<std::uint8_t, 16> counts;
  std::vector<std::uint8_t> symbols;
};

/// Symbols x·16 + y with y from `first` to 10, for x from `from` to `to`.
void addRows(std::vector<std::uint8_t>& symbols, int from, int to, int first) {
  constexpr int kRow = 16, kMostBits = 10;
  for (int x = from; x <= to; ++x)
    for (int y = first; y <= kMostBits; ++y) symbols.push_back(static_cast<std::uint8_t>(kRow * x + y));
}

CodeTable lightLevels() {
  return {{0, 1, 5, 1, 1, 1, 1, 1, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
}
CodeTable colorLevels() {
  return {{0, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}};
}
CodeTable lightWaves() {
  CodeTable table{{0, 2, 1, 3, 3, 2, 4, 3, 5, 5, 4, 4, 0, 0, 1, 125},
                  {0x01, 0x02, 0x03, 0x00, 0x04, 0x11, 0x05, 0x12, 0x21, 0x31, 0x41, 0x06, 0x13,
                   0x51, 0x61, 0x07, 0x22, 0x71, 0x14, 0x32, 0x81, 0x91, 0xa1, 0x08, 0x23, 0x42,
                   0xb1, 0xc1, 0x15, 0x52, 0xd1, 0xf0, 0x24, 0x33, 0x62, 0x72, 0x82, 0x09, 0x0a}};
  addRows(table.symbols, 1, 1, 6);
  addRows(table.symbols, 2, 2, 5);
  addRows(table.symbols, 3, 3, 4);
  addRows(table.symbols, 4, 8, 3);
  addRows(table.symbols, 9, 13, 2);
  addRows(table.symbols, 14, 15, 1);
  return table;
}
CodeTable colorWaves() {
  CodeTable table{{0, 2, 1, 2, 4, 4, 3, 4, 7, 5, 4, 4, 0, 1, 2, 119},
                  {0x00, 0x01, 0x02, 0x03, 0x11, 0x04, 0x05, 0x21, 0x31, 0x06, 0x12, 0x41, 0x51, 0x07, 0x61,
                   0x71, 0x13, 0x22, 0x32, 0x81, 0x08, 0x14, 0x42, 0x91, 0xa1, 0xb1, 0xc1, 0x09, 0x23, 0x33,
                   0x52, 0xf0, 0x15, 0x62, 0x72, 0xd1, 0x0a, 0x16, 0x24, 0x34, 0xe1, 0x25, 0xf1}};
  addRows(table.symbols, 1, 1, 7);
  addRows(table.symbols, 2, 2, 6);
  addRows(table.symbols, 3, 3, 5);
  addRows(table.symbols, 4, 7, 3);
  addRows(table.symbols, 8, 15, 2);
  return table;
}

struct Code {
  std::uint16_t bits = 0;
  std::uint8_t length = 0;
};

/// The code of each symbol: consecutive numbers, one bit longer where the table says so.
std::array<Code, 256> codesOf(const CodeTable& table) {
  std::array<Code, 256> codes{};
  std::uint16_t next = 0;
  std::size_t symbol = 0;
  for (std::size_t length = 1; length <= table.counts.size(); ++length, next <<= 1)
    for (int i = 0; i < table.counts[length - 1]; ++i)
      codes[table.symbols[symbol++]] = {next++, static_cast<std::uint8_t>(length)};
  WEIR_CHECK(symbol == table.symbols.size());
  return codes;
}

/// Where the cells stand in a row of growing frequencies: diagonals, up and down in turns.
std::array<std::size_t, kCells> zigzag() {
  std::array<std::size_t, kCells> order{};
  std::size_t i = 0;
  for (int sum = 0; sum <= 2 * (kSide - 1); ++sum)
    for (int step = 0; step <= sum; ++step) {
      const int y = sum % 2 == 0 ? sum - step : step, x = sum - y;
      if (x < kSide && y < kSide) order[i++] = static_cast<std::size_t>(kSide * y + x);
    }
  return order;
}

/// Cosines of the transform: row u holds c(u)/2·cos((2x + 1)uπ/16).
Block cosines() {
  Block table;
  for (int u = 0; u < kSide; ++u)
    for (int x = 0; x < kSide; ++x)
      table[static_cast<std::size_t>(kSide * u + x)] = static_cast<float>(
          (u == 0 ? std::numbers::sqrt2 / 4 : 0.5) * std::cos((2 * x + 1) * u * std::numbers::pi / 16));
  return table;
}

class BitWriter {
 public:
  explicit BitWriter(std::string& to) : to_(to) {}

  void put(std::uint32_t bits, int count) {
    constexpr int kByte = 8;
    held_ = held_ << count | (bits & ((1u << count) - 1));
    count_ += count;
    for (; count_ >= kByte; count_ -= kByte) {
      const auto byte = static_cast<char>(held_ >> (count_ - kByte) & 0xff);
      to_ += byte;
      if (byte == '\xff') to_ += '\0';  // else it would begin a marker
    }
  }
  void finish() { put(0x7f, 7); }

 private:
  std::string& to_;
  std::uint64_t held_ = 0;
  int count_ = 0;  // bits of held_ that are not written yet
};

/// One component: how its blocks become bits.
class Channel {
 public:
  Channel(const std::array<std::uint8_t, kCells>& steps, const CodeTable& levels, const CodeTable& waves)
      : levels_(codesOf(levels)), waves_(codesOf(waves)) {
    for (std::size_t i = 0; i < kCells; ++i) factors_[i] = 1.0f / static_cast<float>(steps[order_[i]]);
  }

  void write(const Block& block, int& level, BitWriter& out) const {
    constexpr int kSkipOnce = 16, kSkipSixteen = 0xf0, kEnd = 0;
    const Block waves = transformed(block);
    const auto numberAt = [&](std::size_t i) {
      return static_cast<int>(std::lrintf(waves[order_[i]] * factors_[i]));
    };
    const int first = numberAt(0);
    number(first - level, 0, levels_, out);
    level = first;
    int zeros = 0;
    for (std::size_t i = 1; i < kCells; ++i) {
      const int value = numberAt(i);
      if (value == 0) {
        ++zeros;
        continue;
      }
      for (; zeros >= kSkipOnce; zeros -= kSkipOnce) put(waves_[kSkipSixteen], out);
      number(value, zeros, waves_, out);
      zeros = 0;
    }
    if (zeros > 0) put(waves_[kEnd], out);
  }

 private:
  static void put(const Code& code, BitWriter& out) { out.put(code.bits, code.length); }

  /// A code for the zeros before it and the length of the number, then the number.
  static void number(int value, int zeros, const std::array<Code, 256>& codes, BitWriter& out) {
    constexpr int kRow = 16;
    int length = 0;
    for (int rest = std::abs(value); rest > 0; rest >>= 1) ++length;
    put(codes[static_cast<std::size_t>(kRow * zeros + length)], out);
    if (length > 0) out.put(static_cast<std::uint32_t>(value > 0 ? value : value - 1), length);
  }

  Block transformed(const Block& block) const {
    Block half{}, whole{};
    for (std::size_t y = 0; y < kSide; ++y)
      for (std::size_t x = 0; x < kSide; ++x)
        for (std::size_t u = 0; u < kSide; ++u)
          half[kSide * y + u] += block[kSide * y + x] * cosines_[kSide * u + x];
    for (std::size_t v = 0; v < kSide; ++v)
      for (std::size_t y = 0; y < kSide; ++y)
        for (std::size_t u = 0; u < kSide; ++u)
          whole[kSide * v + u] += half[kSide * y + u] * cosines_[kSide * v + y];
    return whole;
  }

  std::array<std::size_t, kCells> order_ = zigzag();
  Block cosines_ = cosines(), factors_{};
  std::array<Code, 256> levels_, waves_;
};

std::array<std::uint8_t, kCells> scaled(std::array<std::uint8_t, kCells> steps, int quality) {
  const int percent = quality < 50 ? 5000 / quality : 200 - 2 * quality;
  for (std::uint8_t& step : steps)
    step = static_cast<std::uint8_t>(std::clamp((step * percent + 50) / 100, 1, 255));
  return steps;
}

class HeaderWriter {
 public:
  explicit HeaderWriter(std::string& to) : to_(to) {}

  void marker(int code) { bytes({0xff, code}); }
  /// A marker, the length of what follows, and that.
  void segment(int code, const std::string& content) {
    marker(code);
    const int length = static_cast<int>(content.size()) + 2;
    bytes({length >> 8, length & 0xff});
    to_ += content;
  }

 private:
  void bytes(std::initializer_list<int> values) {
    for (const int value : values) to_ += static_cast<char>(value);
  }

  std::string& to_;
};

std::string bytesOf(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

std::string stepsSegment(int id, const std::array<std::uint8_t, kCells>& steps) {
  std::string text = bytesOf({id});
  for (const std::size_t i : zigzag()) text += static_cast<char>(steps[i]);
  return text;
}

std::string codesSegment(int id, const CodeTable& table) {
  std::string text = bytesOf({id});
  text.append(table.counts.begin(), table.counts.end());
  return text.append(table.symbols.begin(), table.symbols.end());
}

/// A picture as brightness and two colours, of 16×16 pixels: four blocks of light, one of each colour.
struct Tile {
  static constexpr int kTileSide = 2 * kSide;
  std::array<Block, 4> light;
  Block blue, red;

  /// Pixels beyond the picture are those at its rim.
  void read(const Picture& picture, int left, int top) {
    constexpr float kQuarter = 0.25f, kMiddle = 128;
    blue.fill(0), red.fill(0);
    for (int y = 0; y < kTileSide; ++y) {
      const std::size_t row = static_cast<std::size_t>(std::min(top + y, picture.height - 1)) *
                              static_cast<std::size_t>(picture.width);
      for (int x = 0; x < kTileSide; ++x) {
        const std::size_t at = 3 * (row + static_cast<std::size_t>(std::min(left + x, picture.width - 1)));
        const auto r = static_cast<float>(picture.rgb[at]), g = static_cast<float>(picture.rgb[at + 1]),
                   b = static_cast<float>(picture.rgb[at + 2]);
        // JFIF 1.02: the weights of ITU-R BT.601.
        light[static_cast<std::size_t>(y / kSide * 2 + x / kSide)]
             [static_cast<std::size_t>(y % kSide * kSide + x % kSide)] =
                 0.299f * r + 0.587f * g + 0.114f * b - kMiddle;
        const auto half = static_cast<std::size_t>(y / 2 * kSide + x / 2);
        blue[half] += kQuarter * (-0.168736f * r - 0.331264f * g + 0.5f * b);
        red[half] += kQuarter * (0.5f * r - 0.418688f * g - 0.081312f * b);
      }
    }
  }
};

}  // namespace

std::string encodeJpeg(const Picture& picture, int quality) {
  constexpr int kMostPixels = 65535, kMostQuality = 100;
  WEIR_CHECK(picture.isWhole());
  WEIR_CHECK(std::max(picture.width, picture.height) <= kMostPixels);
  WEIR_CHECK(quality >= 1);
  WEIR_CHECK(quality <= kMostQuality);
  const auto lightSteps = scaled(kLightSteps, quality), colorSteps = scaled(kColorSteps, quality);
  std::string file;
  HeaderWriter header(file);
  header.marker(0xd8);                                                                    // start of image
  header.segment(0xe0, std::string("JFIF\0", 5) + bytesOf({1, 2, 0, 0, 1, 0, 1, 0, 0}));  // square pixels
  header.segment(0xdb, stepsSegment(0, lightSteps));
  header.segment(0xdb, stepsSegment(1, colorSteps));
  header.segment(0xc0, bytesOf({8, picture.height >> 8, picture.height & 0xff, picture.width >> 8,
                                picture.width & 0xff, 3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1}));
  header.segment(0xc4, codesSegment(0x00, lightLevels()));
  header.segment(0xc4, codesSegment(0x10, lightWaves()));
  header.segment(0xc4, codesSegment(0x01, colorLevels()));
  header.segment(0xc4, codesSegment(0x11, colorWaves()));
  header.segment(0xda, bytesOf({3, 1, 0x00, 2, 0x11, 3, 0x11, 0, 63, 0}));

  const Channel light(lightSteps, lightLevels(), lightWaves());
  const Channel color(colorSteps, colorLevels(), colorWaves());
  BitWriter bits(file);
  Tile tile;
  int lightLevel = 0, blueLevel = 0, redLevel = 0;
  for (int top = 0; top < picture.height; top += Tile::kTileSide)
    for (int left = 0; left < picture.width; left += Tile::kTileSide) {
      tile.read(picture, left, top);
      for (const Block& block : tile.light) light.write(block, lightLevel, bits);
      color.write(tile.blue, blueLevel, bits);
      color.write(tile.red, redLevel, bits);
    }
  bits.finish();
  header.marker(0xd9);  // end of image
  return file;
}

}  // namespace weir::rendering
