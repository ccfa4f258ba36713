// Writes PLY files in all three encodings, number by number, for tests of the reader.
#pragma once

#include <bit>
#include <cstdint>
#include <sstream>
#include <string>
#include <type_traits>

namespace weir::test {

inline constexpr const char* kPlyFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

class PlyMaker {
 public:
  /// One of kPlyFormats, then the lines of the header between "format" and "end_header".
  PlyMaker(const std::string& format, const std::string& header) : format_(format) {
    text_ = "ply\nformat " + format + " 1.0\n" + header + "end_header\n";
  }

  template <class T>
  PlyMaker& add(T value) {
    if (format_ == "ascii") {
      std::ostringstream out;
      out.precision(17);
      out << +value << ' ';
      text_ += out.str();
      return *this;
    }
    // From the value's bits by shifts, so that it does not depend on the order of bytes of this machine.
    using Bits = std::conditional_t<
        sizeof(T) == 8, std::uint64_t,
        std::conditional_t<sizeof(T) == 4, std::uint32_t,
                           std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;
    const auto bits = std::bit_cast<Bits>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      const std::size_t byte = format_ == "binary_little_endian" ? i : sizeof(T) - 1 - i;
      text_ += static_cast<char>(bits >> (8 * byte) & 0xff);
    }
    return *this;
  }
  /// The end of a row: a line feed in ASCII, nothing in binary files.
  PlyMaker& endRow() {
    if (format_ == "ascii") text_.back() = '\n';
    return *this;
  }

  const std::string& text() const { return text_; }

 private:
  std::string format_, text_;
};

/// Two particles with velocities, among properties, lists and elements that are none of the reader's
/// business.
inline std::string samplePly(const std::string& format) {
  PlyMaker ply(
      format,
      "comment made for a test\n"
      "element camera 1\nproperty list uchar short matrix\nproperty int flags\n"
      "obj_info of no interest\n"
      "element vertex 2\n"
      "property uchar red\nproperty double y\nproperty float x\nproperty list ushort double weights\n"
      "property float z\nproperty double vx\nproperty float vy\nproperty float vz\n"
      "property int8 sign\nproperty uint32 id\n"
      "element face 1\nproperty list uchar int vertex_indices\n");
  ply.add(std::uint8_t{3})
      .add(std::int16_t{-1})
      .add(std::int16_t{2})
      .add(std::int16_t{300})
      .add(-70000)
      .endRow();
  for (const int k : {0, 1}) {
    ply.add(std::uint8_t{255}).add(0.1 + k).add(1.5f + float(k));
    ply.add(std::uint16_t(k * 300));
    for (int i = 0; i < 300 * k; ++i) ply.add(double(i));
    ply.add(-2.25f).add(4e-3).add(5.0f).add(6.0f - float(k)).add(std::int8_t{-1}).add(4000000000u).endRow();
  }
  ply.add(std::uint8_t{3}).add(0).add(1).add(0).endRow();
  return ply.text();
}

}  // namespace weir::test
