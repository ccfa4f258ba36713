// What a scene file was before it was saved again, and what its run looked like. Both lie in hidden places
// beside it: the versions in the folder ".NAME.versions", the picture as ".NAME.jpg".
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/studio/server/served_folder.h"

namespace weir::studio {

struct Version {
  std::int64_t number = 0;   ///< grows with each; the first is 1
  std::int64_t written = 0;  ///< s since 1970, when the scene was saved so
  bool hasPicture = false;
};

/// The oldest go beyond that many.
inline constexpr std::size_t kMaxVersions = 30;
/// Bytes.
inline constexpr std::uintmax_t kMaxPicture = 256 << 10;

// `path` is that of the scene below the folder.

/// The newest first.
std::vector<Version> versionsOf(const ServedFolder& folder, const std::string& path);
/// Keeps what the file holds, with its picture, before `next` is written over it; nothing where there is no
/// file, or one that holds the same. Throws an io Error if it cannot be kept.
void keepVersion(const ServedFolder& folder, const std::string& path, std::string_view next);
/// The text of a version. Throws a usage Error if there is none of that number.
std::string readVersion(const ServedFolder& folder, const std::string& path, std::int64_t number);

/// When the picture of the present scene was made, s since 1970; 0 if there is none.
std::int64_t pictureTime(const ServedFolder& folder, const std::string& path);
/// The JPEG of a version, or with 0 that of the present scene. Throws an io Error if there is none.
std::string readPicture(const ServedFolder& folder, const std::string& path, std::int64_t number);
/// Moves an uploaded file to where the scene's picture lies. Throws a usage Error if it is no JPEG, or larger
/// than kMaxPicture, or if there is neither such a scene nor a draft of it.
void takePicture(const ServedFolder& folder, const std::filesystem::path& part, const std::string& path);
/// Where there is no such scene, so that the picture was of a draft.
void removePictureOfDraft(const ServedFolder& folder, const std::string& path);

}  // namespace weir::studio
