// Files that appear under their names only when they are whole.
#pragma once

#include "framework/base/file_output.h"
