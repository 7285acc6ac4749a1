#ifndef RAYMAP_C_H
#define RAYMAP_C_H

/*
 * raymap for C and for other languages: load or wrap a mesh, make its signed distance field, sample and write
 * it. All of it works from C11 on.
 *
 * Handles are opaque pointers. A function that returns a handle gives it to the caller, who frees it with the
 * `_free` function of its type; that takes NULL too. Every other function that is given NULL for a required
 * handle or array fails with RAYMAP_ERROR_USAGE and does nothing else.
 *
 * Functions that can fail return a raymap_result, or NULL instead of a pointer. No C++ exception leaves them.
 * `raymap_last_error` and `raymap_last_error_message` say what went wrong, for each thread separately.
 *
 * A handle may be read by several threads at once, but changed by one only. All lengths, positions and
 * distances are in the mesh's units; bytes, seconds and counts are said where they occur. Text is UTF-8.
 */

#include <raymap/export.h>
#include <raymap/version.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Names are as usual in C. NOLINTBEGIN(readability-identifier-naming) */

/* ---- Errors ---- */

/* The values are those of raymap::ErrorCode. */
typedef enum raymap_result {
  RAYMAP_OK = 0,
  RAYMAP_ERROR_BUG = 1,         /* Something unexpected: please report the message. */
  RAYMAP_ERROR_USAGE = 2,       /* An option or argument makes no sense. */
  RAYMAP_ERROR_INPUT = 3,       /* A file or array was read, but its content is not valid. */
  RAYMAP_ERROR_FILE = 4,        /* A file cannot be opened, read or written. */
  RAYMAP_ERROR_MEMORY = 5,      /* The work needs more memory than allowed. */
  RAYMAP_ERROR_CANCELLED = 6,   /* The progress callback asked to stop. */
  RAYMAP_ERROR_UNSUPPORTED = 7, /* Valid, but beyond what this build or this machine can do. */
  RAYMAP_ERROR_DEVICE_LOST = 8  /* The GPU stopped answering while it worked. */
} raymap_result;

/* Returns the result of the last call of this thread that failed; RAYMAP_OK if none did. */
RAYMAP_API raymap_result raymap_last_error(void);

/* Returns what went wrong in that call and what to do about it; "" if none failed. Valid until the next call
 * of this thread that fails. At most 2047 bytes. */
RAYMAP_API const char* raymap_last_error_message(void);

/* Returns the version of the linked library, for example "0.1.0". Valid for ever. */
RAYMAP_API const char* raymap_version(void);

/* ---- Threads ---- */

/* Sets how many CPU threads all calls of this process use whose options leave the number at 0; 0 = all. For
 * one process of many. Fails with RAYMAP_ERROR_USAGE if it is negative. */
RAYMAP_API raymap_result raymap_set_default_threads(int32_t threads);

/* Finds that number: the one set last, else the environment variable RAYMAP_THREADS, else 0. Fails with
 * RAYMAP_ERROR_USAGE if the variable holds something else than a number. */
RAYMAP_API raymap_result raymap_default_threads(int32_t* threads);

/* ---- Options ---- */

/* How to make a field. One handle may serve many calls. */
typedef struct raymap_options raymap_options;

/* Returns options with their defaults: exact distance, harmonic sign, device "auto". */
RAYMAP_API raymap_options* raymap_options_create(void);
RAYMAP_API void raymap_options_free(raymap_options* options);

/* Sets an option whose value is a name:
 *   "distance"     "exact" (default), "neighbours", "cell", "raster"
 *   "sign"         "harmonic" (default), "paths", "evolution", "rays", "ray", "none"
 *   "sampling"     "raymap" (default), "paper": how "paths" and "evolution" sample curves
 *   "orientation"  "auto" (default), "keep", "repair"
 *   "device"       "auto" (default), "cpu", "vulkan", "vulkan:0", ...; see raymap_devices_list */
RAYMAP_API raymap_result raymap_options_set_text(raymap_options* options, const char* option,
                                                 const char* value);

/* Sets an option whose value is a number; switches are 0 or 1. Defaults in parentheses:
 *   "passes" (5)        passes of "paths", steps of "evolution"; a whole number
 *   "threshold" (0.5)   a sample is inside if |winding number| exceeds this
 *   "band" (0)          distances are clamped to this many samples; 0 = not clamped
 *   "thickness" (0)     thickness of a wall around the surface instead of a sign; 0 = none
 *   "threads" (0)       number of CPU threads; 0 = raymap_default_threads
 *   "memory_limit" (0)  most bytes that may be held; 0 = what is available
 *   "invert", "close_holes", "triangle_ids", "winding", "confidence" (0)
 *                       switches, as in raymap::Options */
RAYMAP_API raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value);

/* Sets the offset points of "paths" and "evolution", used in turn: x, y, z of each, in samples. They are
 * copied. A count of 0 brings back those of "sampling". */
RAYMAP_API raymap_result raymap_options_set_offsets(raymap_options* options, const int32_t* offsets,
                                                    size_t count);

/* Reports the name of the current stage and the share of it that is done, 0 to 1. Returns true to go on,
 * false to cancel: the call then fails with RAYMAP_ERROR_CANCELLED. Any thread may call it, one at a time. */
typedef bool (*raymap_progress_callback)(const char* stage, double done, void* user);

/* Receives one sentence about something odd that does not stop the call. */
typedef void (*raymap_warning_callback)(const char* message, void* user);

/* Sets the callbacks; NULL = none. `user` is passed on to them as it is. */
RAYMAP_API raymap_result raymap_options_set_progress(raymap_options* options,
                                                     raymap_progress_callback callback, void* user);
RAYMAP_API raymap_result raymap_options_set_warning(raymap_options* options, raymap_warning_callback callback,
                                                    void* user);

/* ---- Meshes ---- */

/* A triangle mesh. */
typedef struct raymap_mesh raymap_mesh;

/* A mesh in the caller's memory. Position of vertex v: `origin` plus three numbers at `vertices` + v *
 * `vertex_stride` bytes. Triangle t: three vertex numbers at `triangles` + t * `triangle_stride` bytes,
 * counter-clockwise seen from outside. Initialise with {0}. */
typedef struct raymap_mesh_arrays {
  const void* vertices;
  size_t vertex_count;
  size_t vertex_stride; /* Bytes from one vertex to the next; 0 = tightly packed. */
  const void* triangles;
  size_t triangle_count;
  size_t triangle_stride;   /* Bytes from one triangle to the next; 0 = tightly packed. */
  bool has_double_vertices; /* Whether vertices are double instead of float. */
  bool has_64_bit_indices;  /* Whether vertex numbers are uint64_t instead of uint32_t. */
  double origin[3];         /* Added to every position, in double precision. */
} raymap_mesh_arrays;

/* Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE. Of the options only the warning callback counts; they
 * may be NULL. Not in builds without files (RAYMAP_IO=OFF). */
RAYMAP_API raymap_mesh* raymap_mesh_load(const char* path, const raymap_options* options);

/* Wraps arrays without a copy. They must stay valid and unchanged until the mesh is freed. Checks nothing
 * yet: the functions that use the mesh do. */
RAYMAP_API raymap_mesh* raymap_mesh_from_arrays(const raymap_mesh_arrays* arrays);
RAYMAP_API void raymap_mesh_free(raymap_mesh* mesh);

/* Returns the number of vertices; 0 for NULL. */
RAYMAP_API size_t raymap_mesh_vertex_count(const raymap_mesh* mesh);
/* Returns the number of triangles; 0 for NULL. */
RAYMAP_API size_t raymap_mesh_triangle_count(const raymap_mesh* mesh);

/* Copies all positions: x, y, z of each vertex, 3 * raymap_mesh_vertex_count numbers. */
RAYMAP_API raymap_result raymap_mesh_copy_positions(const raymap_mesh* mesh, double* positions);
/* Copies all triangles: 3 * raymap_mesh_triangle_count vertex numbers. Fails with RAYMAP_ERROR_INPUT if one
 * is out of range. */
RAYMAP_API raymap_result raymap_mesh_copy_triangles(const raymap_mesh* mesh, uint32_t* indices);

/* Finds the bounds of the vertices that triangles use. Fails with RAYMAP_ERROR_INPUT if the mesh has no
 * triangle, an index out of range or a vertex that is not finite. */
RAYMAP_API raymap_result raymap_mesh_bounds(const raymap_mesh* mesh, double low[3], double high[3]);

/* Writes .ply (binary), .obj, .stl (binary), .glb or .3mf (in millimetres) by extension. The file appears
 * whole or not at all. Of the options only the warning callback counts; they may be NULL. It is called if the
 * single precision of an STL moves vertices noticeably. Not in builds without files. */
RAYMAP_API raymap_result raymap_mesh_write(const raymap_mesh* mesh, const char* path,
                                           const raymap_options* options);

/* ---- Grids ---- */

/* A lattice of samples. Arrays over it are x fastest: sample (i, j, k) has index (k * ny + j) * nx + i. */
typedef struct raymap_grid {
  int32_t dims[3];  /* Number of samples (nx, ny, nz). */
  double origin[3]; /* Position of sample (0, 0, 0). */
  double spacing;   /* Distance between neighbouring samples. */
} raymap_grid;

/* How to lay a grid over a mesh. */
typedef struct raymap_grid_options {
  int32_t resolution; /* Samples along the longest side of the box; ignored with `voxel_size`. */
  double voxel_size;  /* Spacing; 0 = from the resolution. */
  double padding;     /* Padding of the bounds on every side, as a share of their longest side. */
  double thickness;   /* The option "thickness" of the field: half of it pads the bounds besides. */
  bool has_box;       /* Whether to cover the box below instead of the padded bounds. */
  double box_low[3];
  double box_high[3];
} raymap_grid_options;

/* Returns the defaults: resolution 128, padding 0.1, thickness 0, no box. */
RAYMAP_API raymap_grid_options raymap_grid_options_default(void);

/* Lays a grid of cubic cells over the mesh. `options` may be NULL for the defaults. */
RAYMAP_API raymap_result raymap_fit_grid(const raymap_mesh* mesh, const raymap_grid_options* options,
                                         raymap_grid* grid);

/* ---- Fields ---- */

/* A sampled signed distance field, negative inside, and what its making cost. */
typedef struct raymap_field raymap_field;

/* Returns an empty field, for raymap_generator_run to fill. */
RAYMAP_API raymap_field* raymap_field_create(void);
RAYMAP_API void raymap_field_free(raymap_field* field);

/* Makes a field. `options` may be NULL for the defaults. */
RAYMAP_API raymap_field* raymap_generate(const raymap_mesh* mesh, const raymap_grid* grid,
                                         const raymap_options* options);

/* Makes fields and keeps its memory and its device between calls, for meshes that change every frame. Used by
 * one thread at a time. */
typedef struct raymap_generator raymap_generator;
RAYMAP_API raymap_generator* raymap_generator_create(void);
RAYMAP_API void raymap_generator_free(raymap_generator* generator);
/* Fills a field, reusing its memory. `options` may be NULL. A failure leaves the field empty. */
RAYMAP_API raymap_result raymap_generator_run(raymap_generator* generator, const raymap_mesh* mesh,
                                              const raymap_grid* grid, const raymap_options* options,
                                              raymap_field* field);

/* Copies the grid of a field. */
RAYMAP_API raymap_result raymap_field_grid(const raymap_field* field, raymap_grid* grid);
/* Returns the distance to which the field is clamped; 0 if it is not clamped, and for NULL. */
RAYMAP_API double raymap_field_band(const raymap_field* field);

/* Returns the field's own distances, one per sample, negative inside. NULL if the field is empty or NULL. The
 * field owns the array: it is valid until the field is filled again or freed. */
RAYMAP_API const float* raymap_field_distance(const raymap_field* field);
/* Returns the field's own indices of the closest triangles, in the same way; NULL also if they were not asked
 * for. UINT32_MAX beyond a band, and where surface that closes a hole is closer. */
RAYMAP_API const uint32_t* raymap_field_triangle(const raymap_field* field);
/* Returns the field's own winding numbers, in the same way: +1 inside a closed surface that faces outwards.
 */
RAYMAP_API const float* raymap_field_winding(const raymap_field* field);
/* Returns the field's own confidences in the sign, in the same way: 0 to 1. */
RAYMAP_API const float* raymap_field_confidence(const raymap_field* field);

/* Costs of making a field, and findings about the mesh; all 0 for a field that was read from a file. */
typedef struct raymap_stats {
  double milliseconds;     /* Time from triangles in memory to the finished field. */
  uint64_t bytes;          /* Most bytes that the generator and the field held together. */
  double doubtful_share;   /* Share of samples whose six rays disagree. */
  uint64_t turned_faces;   /* Number of faces that were reversed. */
  uint64_t left_out_faces; /* Number of faces that the sign left out: the other sides of double-sided ones. */
  int no_orientation_fits; /* 1 if the faces were examined, but no choice has a misfit of at most 0.5. */
  double misfit_given;     /* Disagreement of the crossings of the given mesh, 0 to 1. */
  double misfit;           /* The same with those faces reversed and left out. */
  uint64_t patch_triangles; /* Number of triangles of the surface that closes holes. */
  double patch_area;        /* Its area. */
} raymap_stats;
RAYMAP_API raymap_result raymap_field_stats(const raymap_field* field, raymap_stats* stats);

/* Returns the device that made the field: "cpu", "vulkan:0", ...; "" if none did. The field owns the text. */
RAYMAP_API const char* raymap_field_device(const raymap_field* field);

/* Results of points outside the box of the outermost samples. */
typedef enum raymap_outside {
  RAYMAP_OUTSIDE_BOUND = 0, /* A lower bound on the signed distance, also where the box cuts the mesh: it is
                               below 0 where the mesh may reach. A gradient that leads away from the box. */
  RAYMAP_OUTSIDE_NAN = 1    /* NaN. */
} raymap_outside;

/* Samples a field between its samples, in parallel. `points` are x, y, z of each. `distances` takes `count`
 * numbers, `gradients` 3 * `count`; each may be NULL if it is not wanted. Trilinear inside. raymap/sample.h
 * says exactly what the results are. */
RAYMAP_API raymap_result raymap_field_sample(const raymap_field* field, const double* points, size_t count,
                                             raymap_outside outside, float* distances, float* gradients);

/* Returns the surface at a distance as a new closed mesh. Of the options only the number of threads and the
 * callbacks count; they may be NULL. */
RAYMAP_API raymap_mesh* raymap_isosurface(const raymap_field* field, double iso,
                                          const raymap_options* options);

/* Reads .nrrd, .npz, .npy, .vti or .vdb. Not in builds without files. */
RAYMAP_API raymap_field* raymap_field_load(const char* path);
/* Writes one array as .nrrd, .npz, .npy, .vti or .vdb by extension: "distance" (or NULL), "winding",
 * "confidence" or "triangle". The file appears whole or not at all. Not in builds without files. */
RAYMAP_API raymap_result raymap_field_write(const raymap_field* field, const char* path, const char* array);

/* ---- Queries at any points ---- */

/* A mesh prepared once for queries at any points. It keeps a copy of the mesh. Several threads may query it
 * at the same time. */
typedef struct raymap_surface raymap_surface;

/* Prepares a mesh. Of the options, "orientation", "threshold", "threads", "memory_limit" and the progress
 * callback count, and "sign": "harmonic", or "none" for distances that are never negative. They may be NULL.
 */
RAYMAP_API raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options);
RAYMAP_API void raymap_surface_free(raymap_surface* surface);
/* Returns the bytes that the surface holds; 0 for NULL. */
RAYMAP_API size_t raymap_surface_bytes(const raymap_surface* surface);
/* Copies what preparing the mesh cost, and what was found out about it. */
RAYMAP_API raymap_result raymap_surface_stats(const raymap_surface* surface, raymap_stats* stats);

/* The caller's arrays for the results of a query, one value per point; NULL = not wanted. Initialise with
 * {0}. A point that is not finite gets NaN, and the triangle UINT32_MAX. */
typedef struct raymap_query_arrays {
  double* distance;    /* In the mesh's units, negative inside. */
  double* closest;     /* Closest point of the surface: x, y, z. */
  uint32_t* triangle;  /* Index of a triangle that holds it. */
  double* barycentric; /* Weights of that triangle's three corners at it; their sum is 1. */
  double* direction;   /* Unit vector from the point to the closest one: x, y, z; 0 on the surface. */
  float* winding;      /* Winding number, +1 inside a closed surface that faces outwards. Needs a sign. */
  float* confidence;   /* Confidence in the sign, 0 to 1. Needs a sign. */
} raymap_query_arrays;

/* Fills the arrays. `points` are x, y, z of each. Points farther than `limit` get this distance with
 * their sign, NaN instead of positions, and the triangle UINT32_MAX; 0 = no limit. Of the options, only
 * "threads" and the progress callback count; they may be NULL. After a failure the arrays are unchanged. */
RAYMAP_API raymap_result raymap_surface_query(const raymap_surface* surface, const double* points,
                                              size_t count, double limit, const raymap_options* options,
                                              const raymap_query_arrays* arrays);

/* How to choose points. Begin with {sizeof(raymap_sample_points_options)}: all other members 0 is the
 * default. */
typedef struct raymap_sample_points_options {
  size_t size;          /* sizeof(raymap_sample_points_options) */
  bool normalize;       /* Whether the bounding sphere becomes the unit sphere about 0. */
  bool has_shares;      /* Whether the two shares count; else they are 0 and 0.94. */
  double surface_share; /* Share of the points that are on the surface, 0 to 1. */
  double near_share;    /* Share of the points that are near the surface, 0 to 1. */
  const double* sigmas; /* Standard deviations of the offsets of these, as shares of the bounding sphere's
                           radius; each gets as many points. NULL = 0.0025 and 0.00025. */
  size_t sigma_count;   /* Number of deviations. */
  uint64_t seed;        /* Another seed gives other points. */
} raymap_sample_points_options;

/* The caller's arrays for points with distances; NULL = not wanted. Initialise with
 * {.size = sizeof(raymap_point_sample_arrays)}. */
typedef struct raymap_point_sample_arrays {
  size_t size;      /* sizeof(raymap_point_sample_arrays) */
  double* points;   /* (position in the mesh - centre) * scale: x, y, z of each point. */
  double* distance; /* In the units of the points, negative inside. */
  double* gradient; /* Unit vector that points outwards: x, y, z of each point. */
  double* centre;   /* Point of the mesh that lies at 0 in `points`: x, y, z. */
  double* scale;    /* Length in `points` of one unit of the mesh: one number. */
} raymap_point_sample_arrays;

/* Chooses `count` points on a surface, near it and in its bounding sphere, in this order, and measures their
 * distances, as for training DeepSDF; raymap/sample_points.h says how. `how` may be NULL for the defaults. Of
 * the options, only "threads" and the progress callback count; they may be NULL. After a failure the arrays
 * are unchanged. */
RAYMAP_API raymap_result raymap_sample_points(const raymap_surface* surface, size_t count,
                                              const raymap_sample_points_options* how,
                                              const raymap_options* options,
                                              const raymap_point_sample_arrays* arrays);

/* ---- Devices ---- */

/* All devices of this machine. */
typedef struct raymap_devices raymap_devices;

/* Description of a device. The list owns the texts. */
typedef struct raymap_device {
  const char* id;   /* Value for the option "device". */
  const char* name; /* Name of the processor or GPU. */
  const char* type; /* "discrete", "integrated", "virtual", "other", "software" or "cpu". */
  const char* driver;
  const char* problem; /* Reason why it cannot be used; "" if it can. */
  uint64_t memory;     /* Bytes of its largest heap; for the CPU, bytes available now. */
  bool is_automatic;   /* Whether the device "auto" is this one. It tests a GPU first. */
  const char* test;    /* Last test of a GPU: "untested", "running", "passed", "failed" or "unfinished". */
  const char* test_problem; /* First difference, or the check in which it ended; "" if it passed. */
} raymap_device;

/* Asks every Vulkan driver, which can take a second. The CPU comes first. */
RAYMAP_API raymap_devices* raymap_devices_list(void);
RAYMAP_API void raymap_devices_free(raymap_devices* devices);
/* Returns the number of devices; 0 for NULL. */
RAYMAP_API size_t raymap_devices_count(const raymap_devices* devices);
/* Fills in what is known about device `index`. */
RAYMAP_API raymap_result raymap_devices_get(const raymap_devices* devices, size_t index,
                                            raymap_device* device);
/* Compares every stage and whole fields on a GPU with the CPU, and keeps the result in the user's cache
 * folder (RAYMAP_CACHE). Returns RAYMAP_ERROR_UNSUPPORTED if it fails; the message gives the first
 * difference. */
RAYMAP_API raymap_result raymap_devices_test(const char* id);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
