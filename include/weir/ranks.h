// The role of nodes and modules that run where several ranks share the particles, and what ranks tell each
// other.
#pragma once

#include "framework/communication/on_ranks.h"
