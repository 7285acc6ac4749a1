#ifdef __cplusplus
#pragma once
#endif

// The index by which shaders find the leaves of a narrow band: 32-bit words. A header, the nodes of a tree
// (field/leaf_tree.h), and the cubes without leaves (field/empty_space.h), four to a word.

#include "base/shader_types.h"

RAYMAP_SHARED_BEGIN(raymap)

// A leaf has 2^kLeafBits samples along a side, and a node as many slots.
RAYMAP_CONSTANT int kLeafBits = 3;
// Coordinates have 31 bits; bounds the search in words that `packLeafIndex` did not make.
RAYMAP_CONSTANT int kMostRootBits = 30;
// Content of a slot without leaves: its samples are all outside, or all inside. Others hold the number of a
// node or leaf.
RAYMAP_CONSTANT int kAllOutside = -1;
RAYMAP_CONSTANT int kAllInside = -2;

// Words of the header.
RAYMAP_CONSTANT int kIndexRootBits = 0;  // The root's slots have 2^this samples along a side.
RAYMAP_CONSTANT int kIndexOutside = 1;   // Distance of samples in no leaf, as a float.
RAYMAP_CONSTANT int kIndexInside = 2;
RAYMAP_CONSTANT int kIndexCubeBits = 3;  // A cube has 2^this samples along its side.
RAYMAP_CONSTANT int kIndexCubeDims = 4;  // Number of cubes along x, y and z.
RAYMAP_CONSTANT int kIndexCubes = 7;     // Place of the word with the first cube.
RAYMAP_CONSTANT int kLeafIndexHeader = 8;

RAYMAP_SHARED_END
