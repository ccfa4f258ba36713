// What the studio answers over HTTP: its page, what there is to begin with, and the files of the served
// folder.
#include <charconv>
#include <filesystem>
#include <map>
#include <string>

#include "apps/studio/session/studio.h"
#include "apps/studio/session/templates.h"
#include "apps/studio/session/versions.h"
#include "framework/base/text.h"

namespace weir::studio {

namespace fs = std::filesystem;

namespace {

constexpr unsigned kNotFound = 404, kMethodNotAllowed = 405;
constexpr const char* kJson = "application/json";
constexpr std::string_view kFile = "/api/file/", kPicture = "/api/picture/";

std::string typeOf(const fs::path& file) {
  static const std::map<std::string, std::string, std::less<>> kTypes{
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", kJson},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".mp4", "video/mp4"},
      {".woff2", "font/woff2"}};
  const auto type = kTypes.find(file.extension().string());
  return type != kTypes.end() ? type->second : "application/octet-stream";
}

/// The type of a file that anybody may have put into the served folder. What a browser might run has none.
std::string inertTypeOf(const fs::path& file) {
  const std::string type = typeOf(file);
  const bool inert = type == kJson || type == "image/png" || type == "image/jpeg" || type == "video/mp4";
  return inert ? type : "application/octet-stream";
}

/// Throws a usage Error for all but digits.
std::int64_t numberOf(const std::string& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size())
    throw usageError(inQuotes(text) + " is no version", "a whole number");
  return number;
}

}  // namespace

HttpReply Studio::request(const HttpRequest& request) {
  constexpr std::string_view kThumbnail = "/api/thumbnail/";
  if (request.path == "/api/types") return {.type = kJson, .body = options_.types};
  if (request.path == "/api/templates")
    return {.type = kJson, .body = writeJsonLine(templatesIn(options_.templates))};
  if (request.path.starts_with(kThumbnail)) return thumbnail(request.path.substr(kThumbnail.size()));
  if (request.path.starts_with(kPicture)) return picture(request);
  if (request.path.starts_with("/api/")) return files(request);
  if (request.method != "GET") return {.status = kMethodNotAllowed, .body = "only GET"};
  return page(request.path == "/" ? "/index.html" : request.path);
}

HttpReply Studio::page(const std::string& path) const {
  std::error_code error;
  if (!fs::is_directory(options_.page, error))
    return {.status = kNotFound,
            .body = "this Weir was built without the studio's page: install npm, and build again"};
  const ServedFolder page(options_.page);
  const std::string below = path.substr(1);
  if (!fs::is_regular_file(page.resolve(below), error)) return {.status = kNotFound, .body = "not found"};
  return {.type = typeOf(below), .body = page.read(below)};
}

HttpReply Studio::thumbnail(const std::string& name) const {
  std::error_code error;
  if (!fs::is_directory(options_.templates, error)) return {.status = kNotFound, .body = "not found"};
  const fs::path file = thumbnailFile(options_.templates, name);
  if (!fs::is_regular_file(file, error)) return {.status = kNotFound, .body = "not found"};
  return {.type = typeOf(file), .body = readRegularFile(file, name)};
}

HttpReply Studio::picture(const HttpRequest& request) {
  const std::string path = request.path.substr(kPicture.size());
  if (request.method == "PUT") {
    takePicture(folder_, request.upload, path);
    return {.body = "written"};
  }
  if (request.method != "GET") return {.status = kMethodNotAllowed, .body = "only GET and PUT"};
  const auto version = request.query.find("version");
  const std::int64_t number = version != request.query.end() ? numberOf(version->second) : 0;
  try {
    return {.type = "image/jpeg", .body = readPicture(folder_, path, number), .isForeign = true};
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::kIo) throw;
    return {.status = kNotFound, .body = "not found"};
  }
}

HttpReply Studio::listing(const std::vector<ServedFile>& files) const {
  Value list = Value::array();
  for (const ServedFile& file : files) {
    Value v = Value::object();
    v["path"] = file.path;
    v["folder"] = file.isFolder;
    v["bytes"] = file.bytes;
    v["modified"] = file.modified;
    if (!file.isFolder && file.path.ends_with(".json"))
      if (const std::int64_t made = pictureTime(folder_, file.path)) v["picture"] = made;
    list.push(std::move(v));
  }
  return {.type = kJson, .body = writeJsonLine(list)};
}

fs::path Studio::uploadPlace(const HttpRequest& request) {
  if (request.path.starts_with(kPicture)) return folder_.partOf(request.path.substr(kPicture.size()));
  if (!request.path.starts_with(kFile))
    throw usageError("nothing can be written at " + inQuotes(request.path),
                     "an address that begins with " + std::string(kFile));
  const std::string path = request.path.substr(kFile.size());
  if (request.query.contains("new")) requireNew(path);
  return folder_.partOf(path);
}

HttpReply Studio::files(const HttpRequest& request) {
  constexpr std::string_view kList = "/api/files";
  if (request.path == kList) {
    const auto folder = request.query.find("folder");
    return listing(folder_.list(folder != request.query.end() ? folder->second : ""));
  }
  if (!request.path.starts_with(kFile)) return {.status = kNotFound, .body = "not found"};
  const std::string path = request.path.substr(kFile.size());
  if (request.method == "PUT") {
    if (request.query.contains("new")) requireNew(path);
    folder_.take(request.upload, path);
    return {.body = "written"};
  }
  if (request.method != "GET") return {.status = kMethodNotAllowed, .body = "only GET and PUT"};
  return {.type = inertTypeOf(path), .body = folder_.read(path), .isForeign = true};
}

}  // namespace weir::studio
