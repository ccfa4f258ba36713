// Triangle meshes, also those that change with time.
#pragma once

#include "framework/geometry/dynamic_mesh.h"
#include "framework/geometry/dynamic_mesh_copy.h"
#include "framework/geometry/triangle_mesh.h"
