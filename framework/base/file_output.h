// Writing files so that a reader finds either the old or the whole new content, never a part.
#pragma once

#include <filesystem>
#include <string_view>

namespace weir {

/// Throws an io Error if a file cannot be written at this path: it is a folder, the folder above is missing,
/// or nothing can be made in it. Leaves nothing behind.
void checkWritable(const std::filesystem::path& path);

/// Writes beside the path first, then renames. Throws an io Error; what stood at the path is then as before.
void writeFileAtomically(const std::filesystem::path& path, std::string_view text);

}  // namespace weir
