// What the program prints on standard output, and the three streams that it expects to find open.
#pragma once

#include <string_view>

namespace weir::app {

/// Opens /dev/null in place of those that whoever started the program has closed, as schedulers and daemons
/// do: the next files to be opened would take their place, and messages would go into them.
void openStandardStreams();

/// Throws an io Error if it cannot be written.
void print(std::string_view text);

/// Brings what was printed to where it goes; throws an io Error if it cannot be written.
void finishPrinting();

}  // namespace weir::app
