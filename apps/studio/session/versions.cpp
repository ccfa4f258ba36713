#include "apps/studio/session/versions.h"

#include <sys/stat.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <system_error>

#include "framework/base/error.h"
#include "framework/base/file_output.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

/// Whether there is something of this kind itself: a link might lead anywhere.
bool isReal(const fs::path& path, fs::file_type type) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() == type;
}

/// Throws a usage Error for the folder itself, whose neighbours are not served.
fs::path sceneFile(const ServedFolder& folder, const std::string& path) {
  fs::path file = folder.resolve(path);
  if (file == folder.root()) throw usageError("a scene needs a name", "a path below the served folder");
  return file;
}

fs::path hiddenBeside(const fs::path& file, const char* ending) {
  return file.parent_path() / ("." + file.filename().string() + ending);
}

fs::path versionsFolder(const fs::path& file) {
  return hiddenBeside(file, ".versions");
}

fs::path versionFile(const fs::path& folder, std::int64_t number, const char* ending = ".json") {
  return folder / (std::to_string(number) + ending);
}

std::int64_t writtenAt(const fs::path& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) == 0 ? static_cast<std::int64_t>(found.st_mtim.tv_sec) : 0;
}

/// Of "12.json" 12; nothing of other names.
std::optional<std::int64_t> numberOf(const fs::path& file) {
  const std::string stem = file.stem().string();
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
  const bool isOne = error == std::errc() && end == stem.data() + stem.size() && number > 0;
  return isOne && file.extension() == ".json" ? std::optional(number) : std::nullopt;
}

/// A copy that is as old as what it was made of.
void copyWithTime(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, error);
  if (error) throw ioError("the version " + inQuotes(to.string()) + " cannot be written: " + error.message());
  const auto time = fs::last_write_time(from, error);
  if (!error) fs::last_write_time(to, time, error);
}

bool isJpeg(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff") && bytes.ends_with("\xff\xd9");
}

}  // namespace

std::vector<Version> versionsOf(const ServedFolder& folder, const std::string& path) {
  const fs::path kept = versionsFolder(sceneFile(folder, path));
  std::vector<Version> versions;
  if (!isReal(kept, fs::file_type::directory)) return versions;
  std::error_code error;
  for (fs::directory_iterator i(kept, error), end; !error && i != end; i.increment(error))
    if (const auto number = numberOf(i->path()); number && isReal(i->path(), fs::file_type::regular))
      versions.push_back({*number, writtenAt(i->path()),
                          isReal(versionFile(kept, *number, ".jpg"), fs::file_type::regular)});
  std::sort(versions.begin(), versions.end(),
            [](const Version& a, const Version& b) { return a.number > b.number; });
  return versions;
}

void keepVersion(const ServedFolder& folder, const std::string& path, std::string_view next) {
  const fs::path file = sceneFile(folder, path);
  std::error_code error;
  if (!fs::is_regular_file(file, error) || readRegularFile(file, path) == next) return;
  const fs::path kept = versionsFolder(file);
  if (!isReal(kept, fs::file_type::directory)) fs::create_directory(kept, error);
  if (!isReal(kept, fs::file_type::directory))
    throw ioError("the folder " + inQuotes(kept.string()) + " cannot be made");
  std::vector<Version> versions = versionsOf(folder, path);
  const std::int64_t number = versions.empty() ? 1 : versions.front().number + 1;
  copyWithTime(file, versionFile(kept, number));
  const fs::path picture = hiddenBeside(file, ".jpg");
  if (isReal(picture, fs::file_type::regular)) copyWithTime(picture, versionFile(kept, number, ".jpg"));
  for (std::size_t i = kMaxVersions - 1; i < versions.size(); ++i)
    for (const char* ending : {".json", ".jpg"})
      fs::remove(versionFile(kept, versions[i].number, ending), error);
}

std::string readVersion(const ServedFolder& folder, const std::string& path, std::int64_t number) {
  const fs::path kept = versionsFolder(sceneFile(folder, path));
  const fs::path file = versionFile(kept, number);
  if (!isReal(kept, fs::file_type::directory) || !isReal(file, fs::file_type::regular))
    throw usageError("there is no version " + std::to_string(number) + " of " + inQuotes(path));
  return readRegularFile(file, path);
}

std::int64_t pictureTime(const ServedFolder& folder, const std::string& path) {
  const fs::path picture = hiddenBeside(sceneFile(folder, path), ".jpg");
  return isReal(picture, fs::file_type::regular) ? writtenAt(picture) : 0;
}

std::string readPicture(const ServedFolder& folder, const std::string& path, std::int64_t number) {
  const fs::path file = sceneFile(folder, path), kept = versionsFolder(file);
  const bool isThere = number == 0 || isReal(kept, fs::file_type::directory);
  const fs::path picture = number == 0 ? hiddenBeside(file, ".jpg") : versionFile(kept, number, ".jpg");
  if (!isThere || !isReal(picture, fs::file_type::regular))
    throw ioError("there is no picture of " + inQuotes(path));
  return readRegularFile(picture, path);
}

void takePicture(const ServedFolder& folder, const fs::path& part, const std::string& path) {
  const fs::path file = sceneFile(folder, path);
  std::error_code error;
  if (!fs::is_regular_file(file, error) && !isReal(hiddenBeside(file, ".draft"), fs::file_type::regular))
    throw usageError("there is no scene " + inQuotes(path));
  if (fs::file_size(part, error) > kMaxPicture || error || !isJpeg(readRegularFile(part, path)))
    throw usageError("this is no picture of a scene",
                     "a JPEG of at most " + std::to_string(kMaxPicture) + " bytes");
  const fs::path picture = hiddenBeside(file, ".jpg");
  fs::rename(part, picture, error);
  if (error) throw ioError("the picture of " + inQuotes(path) + " cannot be written: " + error.message());
}

void removePictureOfDraft(const ServedFolder& folder, const std::string& path) {
  const fs::path file = sceneFile(folder, path);
  std::error_code ignored;
  if (!fs::exists(file, ignored)) fs::remove(hiddenBeside(file, ".jpg"), ignored);
}

}  // namespace weir::studio
