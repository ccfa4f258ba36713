// Messages of a run.
#pragma once

#include "framework/base/log.h"
