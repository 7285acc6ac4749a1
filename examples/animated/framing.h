#pragma once

#include <raymap/animation.h>
#include <raymap/grid.h>
#include <raymap/render.h>

/// When a frame shows the animation: once around in all frames.
double secondsOf(int frame, int frames, const raymap::AnimatedMesh& mesh);

/// What the mesh reaches in the whole animation: one grid and one camera serve all frames.
raymap::Box reach(const raymap::AnimatedMesh& mesh, int frames);
raymap::Grid gridOver(const raymap::AnimatedMesh& mesh, const raymap::Box& box, int resolution);
