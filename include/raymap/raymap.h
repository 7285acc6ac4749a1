#pragma once

// All of raymap but raymap/vulkan.h, which needs Vulkan's headers, and raymap/c.h, the interface for C.

#include <raymap/animation.h>
#include <raymap/atomic_file.h>
#include <raymap/devices.h>
#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/field.h>
#include <raymap/generate.h>
#include <raymap/grid.h>
#include <raymap/io.h>
#include <raymap/isosurface.h>
#include <raymap/mesh.h>
#include <raymap/mesh_view.h>
#include <raymap/names.h>
#include <raymap/render.h>
#include <raymap/repair.h>
#include <raymap/sample.h>
#include <raymap/simplify.h>
#include <raymap/surface.h>
#include <raymap/thickness.h>
#include <raymap/verdict.h>
#include <raymap/version.h>
