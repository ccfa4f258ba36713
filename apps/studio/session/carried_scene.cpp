#include "apps/studio/session/carried_scene.h"

#include <cstdint>
#include <fstream>
#include <string>

#include "framework/base/error.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace {

constexpr std::string_view kId = "weir-scene-json1";

/// An integer, the most significant byte first.
std::string bigEndian(std::uint64_t v, int bytes) {
  std::string text;
  for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(v >> (8 * i) & 0xff);
  return text;
}

/// A box of type "uuid" (ISO/IEC 14496-12).
std::string boxOf(const std::string& content) {
  constexpr std::size_t kHead = 8;  // its size and its type
  return bigEndian(kHead + content.size(), 4) + "uuid" + content;
}

/// An element Void (RFC 8794), whose size has eight bytes, of which the first is 1.
std::string voidOf(const std::string& content) {
  return "\xec\x01" + bigEndian(content.size(), 7) + content;
}

/// A comment (GIF89a) and the trailer; it takes the place of the file's.
std::string commentOf(const std::string& content) {
  constexpr std::size_t kMost = 255;
  std::string blocks = "!\xfe";
  for (std::size_t at = 0; at < content.size(); at += kMost) {
    const std::string block = content.substr(at, kMost);
    blocks += bigEndian(block.size(), 1) + block;
  }
  return blocks + '\0' + ';';
}

}  // namespace

void carryScene(const std::filesystem::path& video, std::string_view scene) {
  const std::string content = std::string(kId).append(scene), kind = video.extension().string();
  const bool isGif = kind == ".gif";
  std::fstream file(video, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(isGif ? -1 : 0, std::ios::end);
  if (isGif)
    file << commentOf(content);
  else if (kind == ".mp4" || kind == ".mov")
    file << boxOf(content);
  else if (kind == ".mkv" || kind == ".webm")
    file << voidOf(content);
  file.flush();
  if (!file) throw ioError("the scene cannot be written into " + inQuotes(video.string()));
}

}  // namespace weir::studio
