// Whether a library can be loaded at all. The constructors of its static objects run while it is loaded,
// before anyone can ask what it is; an exception there ends the program, as C++ has it. So it is loaded in a
// copy of this process first.
#pragma once

#include <filesystem>

#include "framework/base/api.h"

namespace WEIR_API weir {

/// Loads the library in a copy of this process (framework/base/forked_work.h). Throws an io Error that names
/// file and reason if its static objects throw, crash, end the program or do not come to an end. A file that
/// cannot be loaded for another reason passes: the constructor of Plugin says why. To be called before a CUDA
/// device is opened, whose driver does not work in copies of a process.
void probePlugin(const std::filesystem::path& file);

}  // namespace weir
