// Text for messages.
#pragma once

#include "framework/base/text.h"
