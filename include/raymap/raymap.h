#pragma once

// All of raymap but raymap/vulkan.h, which needs Vulkan's headers, and raymap/c.h, the interface for C.

#include <raymap/animation.h>
#include <raymap/atomic_file.h>
#include <raymap/device_info.h>
#include <raymap/devices.h>
#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/field.h>
#include <raymap/generate.h>
#include <raymap/grid.h>
#include <raymap/io.h>
#include <raymap/isosurface.h>
#include <raymap/local_thickness.h>
#include <raymap/machine.h>
#include <raymap/mesh.h>
#include <raymap/mesh_view.h>
#include <raymap/names.h>
#include <raymap/options.h>
#include <raymap/page.h>
#include <raymap/picture.h>
#include <raymap/query.h>
#include <raymap/records.h>
#include <raymap/region.h>
#include <raymap/render.h>
#include <raymap/repair.h>
#include <raymap/sample.h>
#include <raymap/sample_points.h>
#include <raymap/simplify.h>
#include <raymap/sparse_field.h>
#include <raymap/surface.h>
#include <raymap/thickness.h>
#include <raymap/threads.h>
#include <raymap/verdict.h>
#include <raymap/version.h>
#include <raymap/warning.h>
