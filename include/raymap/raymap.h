#pragma once

#include <raymap/animation.h>
#include <raymap/diagnostics.h>
#include <raymap/error.h>
#include <raymap/field.h>
#include <raymap/generate.h>
#include <raymap/grid.h>
#include <raymap/io.h>
#include <raymap/isosurface.h>
#include <raymap/mesh.h>
#include <raymap/render.h>
#include <raymap/repair.h>
