#pragma once

/// Marks what a shared libraymap exports. Programs that use raymap define nothing.
///
/// raymap's own build defines `RAYMAP_BUILDING_LIBRARY` and hides all other symbols
/// (-fvisibility=hidden), static and shared, so that both are made of the same objects.
#if defined(RAYMAP_BUILDING_LIBRARY) && defined(__GNUC__)
#define RAYMAP_API __attribute__((visibility("default")))
#else
#define RAYMAP_API
#endif

/// Marks types that are thrown: the library and a program that catches them must agree on one typeinfo, also
/// where the program hides its own symbols.
#if defined(__GNUC__)
#define RAYMAP_API_EXCEPTION __attribute__((visibility("default")))
#else
#define RAYMAP_API_EXCEPTION
#endif
