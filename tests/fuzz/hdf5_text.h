// HDF5 files from a text that says what is in them. Bytes of HDF5 files are for the HDF5 library to read,
// which runs in a copy of the process because it crashes on damaged ones. What is tried here is our own part:
// files that are sound HDF5 and hold anything at all, other than they should. One item a line:
//
//   group PATH
//   attr PATH NAME TYPE VALUE…          of a group or data set that is there; TYPE "text" has one word
//   data PATH TYPE ROWS[xCOLUMNS…] VALUE…
//   text PATH WORD…                     a data set of one string
//
// TYPE is float, double, int8, uint8, int, uint or int64. Values are repeated to the end; without any,
// nothing is stored and HDF5 reads zeros, however large the data set is. What cannot be made is left out.
#pragma once

#include <filesystem>
#include <string_view>

namespace weir::fuzz {

void writeHdf5(std::string_view text, const std::filesystem::path& file);

}  // namespace weir::fuzz
