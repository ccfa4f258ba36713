// Writing files so that a reader finds either the old or the whole new content, never a part.
#pragma once

#include <filesystem>
#include <string_view>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Throws an io Error if a file cannot be written at this path: it is a folder, the folder above is missing,
/// or nothing can be made in it. Leaves nothing behind.
void checkWritable(const std::filesystem::path& path);

/// Brings the names in a file's folder to the disk: a file that was made or renamed may else be gone after a
/// power cut, however well its content was synced. Throws an io Error.
void syncFolderOf(const std::filesystem::path& file);

/// Writes beside the path first, then renames, and brings both to the disk. Throws an io Error; what stood at
/// the path is then as before.
void writeFileAtomically(const std::filesystem::path& path, std::string_view text);

/// The same for a file that is there: what a symbolic link leads to is replaced, with the permissions that it
/// has. Throws an io Error for a read-only file, although one that stands in a writable folder could be
/// replaced.
void replaceFileAtomically(const std::filesystem::path& path, std::string_view text);
/// Throws as replaceFileAtomically would, and changes nothing.
void checkReplaceable(const std::filesystem::path& path);

}  // namespace weir
