#pragma once

#include <raymap/animation.h>
#include <raymap/grid.h>
#include <raymap/render.h>

/// Returns the time of the animation that a frame shows: once around in all frames.
double secondsOf(int frame, int frames, const raymap::AnimatedMesh& mesh);

/// Returns the bounds of the mesh in the whole animation: one grid and one camera serve all frames.
raymap::Box reach(const raymap::AnimatedMesh& mesh, int frames);
raymap::Grid gridOver(const raymap::AnimatedMesh& mesh, const raymap::Box& box, int resolution);
