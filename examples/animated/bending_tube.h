#pragma once

#include <raymap/animation.h>

/// A tube on a chain of joints that bends to and fro in four seconds: a skinned mesh without a file.
raymap::AnimatedMesh bendingTube();
