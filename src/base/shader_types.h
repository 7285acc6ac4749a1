// Macros for headers that are both C++ and GLSL. `<stem>_shared.h` holds what both backends must agree on,
// `<stem>_push.h` the parameters of kernels in scalar layout. scripts/check_constants.py finds other copies.

#ifdef __cplusplus

#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#define RAYMAP_SHARED_BEGIN(space) namespace space {
#define RAYMAP_SHARED_END }
/// Address of a buffer that GLSL sees as `type`; see vulkan/device/kernel.glsl.
#define RAYMAP_ADDRESS(type) uint64_t
#define RAYMAP_CONSTANT inline constexpr
#define RAYMAP_FUNCTION inline
/// Number that the CPU knows more precisely.
#define RAYMAP_REAL double
/// GLSL adds no bytes at a struct's end, so neither may C++.
#define RAYMAP_CHECK_SIZE(type, bytes) static_assert(sizeof(type) == (bytes))

namespace raymap {
using uint = uint32_t;
using glm::uvec3, glm::vec3;
}  // namespace raymap

#else

#define RAYMAP_SHARED_BEGIN(space)
#define RAYMAP_SHARED_END
#define RAYMAP_ADDRESS(type) type
#define RAYMAP_CONSTANT const
#define RAYMAP_FUNCTION
#define RAYMAP_REAL float
#define RAYMAP_CHECK_SIZE(type, bytes)

#endif
