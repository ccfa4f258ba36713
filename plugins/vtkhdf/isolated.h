// Work in a process of its own.
//
// The HDF5 library crashes on some damaged files, whatever its caller checks. What it does to files that Weir
// did not write is therefore done in a child process, and a crash there is an error here.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace weir::hdf5 {

/// Runs `work` in a copy of this process, whose only thread is the one that runs it, and returns the bytes
/// that it returns. Throws the Error that `work` throws; an io Error without a place if the copy cannot be
/// made, crashes, throws anything else, or has used up `cpuSeconds` of processor time.
std::string runIsolated(const std::function<std::string()>& work, int cpuSeconds);

/// Of processor time: far more than the slowest machine needs to read a file of this size.
int cpuSecondsFor(const std::filesystem::path& file);

}  // namespace weir::hdf5
