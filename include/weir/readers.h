// Readers of meshes and of particles, for formats of your own.
#pragma once

#include "nodes/mesh_file/mesh_reader.h"
#include "nodes/particle_file/particle_reader.h"
#include "nodes/particle_file/recording.h"
