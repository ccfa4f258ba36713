#include "framework/graph/plugin.h"

#include <cxxabi.h>
#include <dirent.h>
#include <dlfcn.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>

#include "framework/base/text.h"
#include "framework/graph/plugin_header.h"

namespace weir {

namespace fs = std::filesystem;

namespace {

constexpr const char* kHeaderSymbol = "weirPluginHeader";
constexpr const char* kRegisterSymbol = "weirRegisterPlugin";
constexpr const char* kMagic = "WEIRPLG";

Error pluginError(const fs::path& file, const std::string& message, const std::string& allowed = {},
                  const std::string& hint = {}) {
  Error error = ioError(message, allowed, hint);
  return error.at({.file = file.string()});
}

constexpr std::string_view kUndefined = "undefined symbol: ";

/// What the loader says of the last failure, with the name of a missing symbol as it stands in sources.
std::string lastLoaderError() {
  const char* raw = dlerror();
  std::string text = raw != nullptr ? raw : "unknown error";
  if (const auto at = text.find(kUndefined); at != std::string::npos) {
    const std::size_t begin = at + kUndefined.size(), end = text.find_first_of(" \t", begin);
    const std::string symbol = text.substr(begin, end == std::string::npos ? end : end - begin);
    int status = 0;
    const std::unique_ptr<char, void (*)(void*)> name(
        abi::__cxa_demangle(symbol.c_str(), nullptr, nullptr, &status), std::free);
    if (name != nullptr) text.replace(begin, symbol.size(), name.get());
  }
  return printable(text, 500);
}

/// The text in a field that need not end with a zero.
template <std::size_t N>
std::string fieldText(const char (&field)[N]) {
  return printable({field, strnlen(field, N)}, N);
}

}  // namespace

struct Plugin::Library {
  explicit Library(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error))
      throw pluginError(
          file, "the plugin cannot be loaded: there is no such file", {},
          file.is_relative() ? "the current folder is " + fs::current_path(error).string() : "");
    if (fs::is_directory(file, error))
      throw pluginError(file, "the plugin cannot be loaded: it is a folder", "a shared library (*.so)");
    // Absolute, because the loader looks for bare names elsewhere.
    const fs::path absolute = fs::absolute(file);
    errno = 0;
    handle = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
      // The loader has an errno of its own: its text tells of calls of the system that found no memory, and
      // not of malloc(), which sets the C library's errno.
      const bool noMemory = errno == ENOMEM;
      const std::string reason = lastLoaderError();
      if (noMemory || reason.find(std::strerror(ENOMEM)) != std::string::npos) throw std::bad_alloc();
      const bool missing = reason.find(kUndefined) != std::string::npos;
      throw pluginError(
          file, "the plugin cannot be loaded: " + reason, "a shared library for this machine",
          missing
              ? "it may be built for another version of Weir, or with CUDA for a Weir without: build it again"
              : "");
    }
  }
  ~Library() { dlclose(handle); }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void* symbol(const fs::path& file, const char* name) const {
    void* found = dlsym(handle, name);
    if (found == nullptr)
      throw pluginError(file, std::string("the library is not a Weir plugin: it has no symbol ") + name,
                        "a library that ends with WEIR_PLUGIN");
    return found;
  }

  void* handle = nullptr;
};

namespace {

/// Copies the header out, field by field as far as the versions agree on what stands where.
PluginHeader checkedHeader(const fs::path& file, const void* symbol) {
  PluginHeader header{};
  std::memcpy(header.magic, symbol, sizeof header.magic);
  if (std::memcmp(header.magic, kMagic, std::strlen(kMagic) + 1) != 0)
    throw pluginError(file, std::string("the library is not a Weir plugin: ") + kHeaderSymbol +
                                " does not begin with " + kMagic);
  constexpr std::size_t kFixed = offsetof(PluginHeader, interfaceIdentity);
  std::memcpy(&header, symbol, kFixed);
  if (header.interfaceVersion != kPluginInterface)
    throw pluginError(
        file, "the plugin is for version " + std::to_string(header.interfaceVersion) + " of the interface",
        "version " + std::to_string(kPluginInterface), "build it again with this version of Weir");
  if (header.headerSize != sizeof(PluginHeader))
    throw pluginError(file, "the plugin's header has " + std::to_string(header.headerSize) + " bytes",
                      std::to_string(sizeof(PluginHeader)) + " bytes",
                      "build it again with this version of Weir");
  std::memcpy(&header, symbol, sizeof header);
  if (fieldText(header.interfaceIdentity) != kInterfaceIdentity)
    throw pluginError(file, "the plugin was built for Weir " + fieldText(header.interfaceIdentity),
                      "Weir " + std::string(kInterfaceIdentity), "build it again with this version of Weir");
  if (fieldText(header.build) != kPluginBuild.text)
    throw pluginError(file, "the plugin's build is '" + fieldText(header.build) + "'",
                      "'" + std::string(kPluginBuild.text) + "'",
                      "build it with the compiler and options that built this Weir");
  return header;
}

}  // namespace

Plugin::Plugin(const fs::path& file, Registry& registry)
    : library_(std::make_shared<Library>(file)), file_(file) {
  const PluginHeader header = checkedHeader(file, library_->symbol(file, kHeaderSymbol));
  const auto registerTypes = reinterpret_cast<void (*)(Registry&)>(library_->symbol(file, kRegisterSymbol));
  name_ = fieldText(header.name);
  doc_ = fieldText(header.doc);
  hasCudaKernels_ = header.hasCudaKernels != 0;

  Registry extended = registry;
  extended.keepLoaded(library_);
  extended.setSource("plugin " + name_);
  std::string reason;
  bool hasMemory = true;
  try {
    registerTypes(extended);
    extended.setSource(registry.source());
    std::swap(registry, extended);
    return;
  } catch (const std::bad_alloc&) {
    hasMemory = false;
  } catch (const Error& e) {
    reason = e.message();
  } catch (const std::exception& e) {
    reason = printable(e.what(), 500);
  } catch (...) {
    reason = "unknown exception";
  }
  if (!hasMemory) throw std::bad_alloc();
  // Thrown here, where the plugin's own exception is gone: its code goes with the library.
  throw pluginError(file, "the plugin '" + name_ + "' cannot register: " + reason);
}

Plugin::~Plugin() = default;
Plugin::Plugin(Plugin&&) noexcept = default;
Plugin& Plugin::operator=(Plugin&&) noexcept = default;

// By calls of the system, because std::filesystem::directory_iterator ends the program where memory runs out.
std::vector<fs::path> pluginFiles(const fs::path& folder) {
  std::vector<fs::path> files;
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(::opendir(folder.c_str()), ::closedir);
  if (entries == nullptr && errno == ENOMEM) throw std::bad_alloc();
  if (entries == nullptr) return files;
  while (const dirent* entry = ::readdir(entries.get())) {
    const fs::path file = folder / entry->d_name;
    std::error_code error;
    if (file.extension() == ".so" && !fs::is_directory(file, error)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace weir
