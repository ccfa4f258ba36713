// Errors of users, checks for programmers.
#pragma once

#include "framework/base/check.h"
#include "framework/base/error.h"
