#ifndef RAYMAP_C_H
#define RAYMAP_C_H

/*
 * raymap for C and for other languages: load or wrap a mesh, make its signed distance field, sample and write
 * it, query, inspect, repair and draw the mesh. All of it works from C11 on.
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
 *
 * Structs whose first member is `size` grow in later versions. The caller sets it to the size of the struct,
 * and all members that it does not need to 0: RAYMAP_INIT does both. Such a 0 means the default. The library
 * reads and writes `size` bytes only, so a program goes on working with a newer library. An older library
 * accepts a newer struct as long as the members that it does not know are 0. A size that cannot be right,
 * such as 0, is RAYMAP_ERROR_USAGE.
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

/* Returns a struct with its `size` set and all other members 0:
 *   raymap_stats stats = RAYMAP_INIT(raymap_stats);
 * In other languages, fill the struct with 0, then set `size`. */
#ifdef __cplusplus
#define RAYMAP_INIT(type)            \
  ([] {                              \
    type raymap_made{};              \
    raymap_made.size = sizeof(type); \
    return raymap_made;              \
  }())
#else
#define RAYMAP_INIT(type) ((type){.size = sizeof(type)})
#endif

/* ---- Errors ---- */

/* Kind of the error. The numbers never change; those of raymap::ErrorCode may. */
typedef enum raymap_result {
  RAYMAP_OK = 0,
  RAYMAP_ERROR_BUG = 1,           /* Something unexpected: please report the message. */
  RAYMAP_ERROR_USAGE = 2,         /* An option or argument makes no sense. */
  RAYMAP_ERROR_INPUT = 3,         /* A file or array was read, but its content is not valid. */
  RAYMAP_ERROR_FILE = 4,          /* A file cannot be opened, read or written. */
  RAYMAP_ERROR_MEMORY = 5,        /* The work needs more memory than allowed. */
  RAYMAP_ERROR_CANCELLED = 6,     /* The progress callback asked to stop. */
  RAYMAP_ERROR_UNSUPPORTED = 7,   /* Valid, but beyond what this build or this machine can do. */
  RAYMAP_ERROR_DEVICE_LOST = 8,   /* The GPU stopped answering while it worked. */
  RAYMAP_ERROR_DEVICE_MEMORY = 10 /* The GPU has no memory left, whatever is allowed. */
} raymap_result;

/* Returns the result of the last call of this thread that failed; RAYMAP_OK if none did. */
RAYMAP_API raymap_result raymap_last_error(void);

/* Returns what went wrong in that call and what to do about it; "" if none failed. Valid until the next call
 * of this thread that fails. At most 2047 bytes. */
RAYMAP_API const char* raymap_last_error_message(void);

/* Returns the version of the linked library, for example "0.1.0". Valid for ever. */
RAYMAP_API const char* raymap_version(void);

/* Frees a text that a function gave to the caller; takes NULL too. */
RAYMAP_API void raymap_text_free(char* text);

/* ---- Threads ---- */

/* Sets how many CPU threads all calls of this process use whose options leave the number at 0; 0 = all. For
 * one process of many. Fails with RAYMAP_ERROR_USAGE if it is negative. */
RAYMAP_API raymap_result raymap_set_default_threads(int32_t threads);

/* Finds that number: the one set last, else the environment variable RAYMAP_THREADS, else 0. Fails with
 * RAYMAP_ERROR_USAGE if the variable holds something else than a number. */
RAYMAP_API raymap_result raymap_default_threads(int32_t* threads);

/* ---- Memory ---- */

/* Bounds what this process may hold, as raymap::limitMemory does; 0 = no bound. A strict bound also makes
 * every allocation beyond it fail, those of the program's own code too. */
RAYMAP_API raymap_result raymap_limit_memory(uint64_t bytes, int32_t is_strict);

/* Returns the number of bytes that this process can still get, as raymap::memoryLeft does. */
RAYMAP_API uint64_t raymap_memory_left(void);

/* ---- Options ---- */

/* How to make a field. One handle may serve many calls. */
typedef struct raymap_options raymap_options;

/* Returns options with their defaults: exact distance, harmonic sign, device "auto". */
RAYMAP_API raymap_options* raymap_options_create(void);
RAYMAP_API void raymap_options_free(raymap_options* options);

/* Sets an option whose value is a name:
 *   "distance"     "exact" (default), "neighbours", "cell", "raster"
 *   "sign"         "harmonic" (default), "exact", "paths", "evolution", "rays", "ray", "none"
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
 *   "memory_limit" (0)  most bytes that the call and its result may hold; 0 = raymap_memory_left
 *   "compact" (0)       whether a surface takes less memory and more time, as in raymap::SurfaceOptions
 *   "invert", "close_holes", "triangle", "winding", "confidence", "allow_empty" (0)
 *                       switches, as in raymap::FieldOptions */
RAYMAP_API raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value);

/* Sets the offset points of "paths" and "evolution", used in turn: x, y, z of each, in samples. They are
 * copied. A count of 0 brings back those of "sampling". */
RAYMAP_API raymap_result raymap_options_set_offsets(raymap_options* options, const int32_t* offsets,
                                                    size_t count);

/* Reports the name of the current stage and the share of it that is done, 0 to 1. Returns true to go on,
 * false to cancel: the call then fails with RAYMAP_ERROR_CANCELLED. Any thread may call it, one at a time. */
typedef bool (*raymap_progress_callback)(const char* stage, double done, void* user);

/* Receives what is odd but does not stop the call: the code of the warning, for example "rounding"
 * (docs/report.md lists them), and one sentence. Both are valid during the call only. */
typedef void (*raymap_warning_callback)(const char* code, const char* message, void* user);

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
 * counter-clockwise seen from outside. Initialise with RAYMAP_INIT. */
typedef struct raymap_mesh_arrays {
  size_t size; /* sizeof(raymap_mesh_arrays) */
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

/* Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE. Options: only "allow_empty" and the warning callback
 * are used; they may be NULL. Not in builds without files (RAYMAP_IO=OFF). */
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
RAYMAP_API raymap_result raymap_mesh_bounds(const raymap_mesh* mesh, double min[3], double max[3]);

/* Writes .ply (binary), .obj, .stl (binary), .glb or .3mf (in millimetres) by extension. The file appears
 * whole or not at all. Only the warning callback of the options is used; they may be NULL. It is called if
 * the single precision of an STL moves vertices noticeably. Not in builds without files. */
RAYMAP_API raymap_result raymap_mesh_write(const raymap_mesh* mesh, const char* path,
                                           const raymap_options* options);

/* ---- Grids ---- */

/* A lattice of samples. Arrays over it are x fastest: sample (i, j, k) has index (k * ny + j) * nx + i. */
typedef struct raymap_grid {
  int32_t dims[3];  /* Number of samples (nx, ny, nz). */
  double origin[3]; /* Position of sample (0, 0, 0). */
  double spacing;   /* Distance between neighbouring samples. */
} raymap_grid;

/* How to lay a grid over a mesh. Initialise with RAYMAP_INIT. */
typedef struct raymap_grid_options {
  size_t size;        /* sizeof(raymap_grid_options) */
  int32_t resolution; /* Samples along the longest side of the box; ignored with `voxel_size` or `dims`.
                         0 = 128, or 256 for a repair. */
  int32_t dims[3];    /* Number of samples (nx, ny, nz), for fields of one shape; 0, 0, 0 = the box decides.
                         Cells about the centre of the box are as small as hold it. With `voxel_size` they
                         have that size, and may cut the box. Ignored for a repair. */
  bool has_padding;   /* Whether `padding` is used; else it is 0.1. */
  bool has_box;       /* Whether to cover the box below instead of the padded bounds. */
  double voxel_size;  /* Spacing; 0 = from `dims` or the resolution. */
  double padding;     /* Padding of the bounds on every side, as a share of their longest side. */
  double thickness;   /* The option "thickness" of the field: half of it pads the bounds besides. */
  double box_min[3];
  double box_max[3];
  bool align; /* Whether sample (0, 0, 0) lies on multiples of 8 spacings, as OpenVDB's leaves do. Samples of
                 all such grids of one spacing then coincide. Not with `dims`. Ignored for a repair. */
} raymap_grid_options;

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
RAYMAP_API double raymap_field_clamp_distance(const raymap_field* field);

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

/* Costs of making a field, and findings about the mesh. For a field that was read from a file all are 0,
 * and the orientation fits. */
typedef struct raymap_stats {
  size_t size;              /* sizeof(raymap_stats); RAYMAP_INIT sets it. */
  double milliseconds;      /* Time from triangles in memory to the finished field. */
  uint64_t bytes;           /* Most bytes that the generator and the field held together. */
  double doubtful_share;    /* Share of samples whose six rays disagree. */
  uint64_t turned_faces;    /* Number of faces that were reversed. */
  uint64_t left_out_faces;  /* Number of faces that the sign left out: repeated ones, or other sides. */
  bool orientation_fits;    /* False if the faces were examined, but no choice has a misfit of at most 0.5. */
  double misfit_given;      /* Disagreement of the crossings of the given mesh, 0 to 1. */
  double misfit;            /* The same with those faces reversed and left out. */
  uint64_t patch_triangles; /* Number of triangles of the surface that closes holes. */
  double patch_area;        /* Its area. */
  uint64_t inverted_parts;  /* Number of parts that were reversed: inside out, and they cross others. */
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
 * says exactly what the results are. Fails with RAYMAP_ERROR_USAGE for another value of `outside`. */
RAYMAP_API raymap_result raymap_field_sample(const raymap_field* field, const double* points, size_t count,
                                             raymap_outside outside, float* distances, float* gradients);

/* Returns the surface at a distance as a new closed mesh. Options: only the number of threads and the
 * callbacks are used; they may be NULL. */
RAYMAP_API raymap_mesh* raymap_isosurface(const raymap_field* field, double iso,
                                          const raymap_options* options);

/* Reads .nrrd, .npz, .npy, .vti, .vdb or .nvdb. Only the warning callback of the options is used, if not
 * NULL. It is called if the file has arrays that a field has not. Not in builds without files. */
RAYMAP_API raymap_field* raymap_field_load(const char* path, const raymap_options* options);
/* Writes one array as .nrrd, .npz, .npy, .vti, .vdb or .nvdb by extension: "distance" (or NULL), "winding",
 * "confidence" or "triangle". The file appears whole or not at all. Not in builds without files. */
RAYMAP_API raymap_result raymap_field_write(const raymap_field* field, const char* path, const char* array);

/* ---- Queries at any points ---- */

/* A mesh prepared once for queries at any points. It keeps a copy of the mesh. Several threads may query it
 * at the same time. */
typedef struct raymap_surface raymap_surface;

/* Prepares a mesh. Options: only "orientation", "threshold", "compact", "threads", "memory_limit" and the
 * progress callback are used, and "sign": "harmonic", or "none" for distances that are never negative. They
 * may be NULL. */
RAYMAP_API raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options);
RAYMAP_API void raymap_surface_free(raymap_surface* surface);
/* Returns the bytes that the surface holds; 0 for NULL. */
RAYMAP_API size_t raymap_surface_bytes(const raymap_surface* surface);
/* Copies what preparing the mesh cost, and what was found out about it. */
RAYMAP_API raymap_result raymap_surface_stats(const raymap_surface* surface, raymap_stats* stats);

/* The caller's arrays for the results of a query, one value per point; NULL = not wanted. Initialise with
 * RAYMAP_INIT. A point that is not finite gets NaN, and the triangle UINT32_MAX. */
typedef struct raymap_query_arrays {
  size_t size;         /* sizeof(raymap_query_arrays) */
  double* distance;    /* In the mesh's units, negative inside. */
  double* closest;     /* Closest point of the surface: x, y, z. */
  uint32_t* triangle;  /* Index of a triangle that holds it. */
  double* barycentric; /* Weights of that triangle's three corners at it; their sum is 1. */
  double* direction;   /* Unit vector from the point to the closest one: x, y, z; 0 on the surface. */
  float* winding;      /* Winding number, +1 inside a closed surface that faces outwards. Needs a sign. */
  float* confidence;   /* Confidence in the sign, 0 to 1. Needs a sign. */
} raymap_query_arrays;

/* Fills the arrays. `points` are x, y, z of each. Points farther than `max_distance` get this distance with
 * their sign, NaN instead of positions, and the triangle UINT32_MAX; 0 = all points. Options: only "threads"
 * and the progress callback are used; they may be NULL. After a failure the arrays are unchanged.
 */
RAYMAP_API raymap_result raymap_surface_query(const raymap_surface* surface, const double* points,
                                              size_t count, double max_distance,
                                              const raymap_options* options,
                                              const raymap_query_arrays* arrays);

/* Kinds of part that a point of a mesh's surface bounds. The values are those of raymap::Part. */
typedef enum raymap_part {
  RAYMAP_PART_WALL = 0,   /* Side of a plate, a rod or any body: another side lies opposite. */
  RAYMAP_PART_EDGE = 1,   /* Side of a wedge or a spike, which runs out to an edge or a tip. */
  RAYMAP_PART_CORNER = 2, /* Surface beside a blunt edge or corner, and narrow faces. */
  RAYMAP_PART_SOLID = 3,  /* Surface of a solid whose other side is farther than the largest thickness. */
  RAYMAP_PART_SHEET = 4,  /* Face that bounds nothing: it is outside on both sides. */
  RAYMAP_PART_BURIED = 5  /* Face that is inside on both sides. */
} raymap_part;

/* The caller's arrays for the thickness at points, one value per point; NULL = not wanted. Initialise with
 * RAYMAP_INIT. */
typedef struct raymap_thickness_arrays {
  size_t size;     /* sizeof(raymap_thickness_arrays) */
  float* diameter; /* Diameter of the ball inside that touches the point and the side opposite. 0 for a sheet;
                      infinite where no side lies opposite. */
  int32_t* part;   /* A value of raymap_part. */
  float* inward;   /* Unit vector into the solid: x, y, z; 0 for sheets, buried and narrow faces. */
} raymap_thickness_arrays;

/* Measures the thickness at points of faces: `points` are x, y, z of each, `triangles` the face that each
 * lies on. Parts thicker than `max_thickness` count as infinitely thick; 0 = none. The smaller, the faster.
 * Options: only "threads" and the progress callback are used; they may be NULL. Fails with
 * RAYMAP_ERROR_USAGE for a face that does not exist and a surface without a sign. After a failure the arrays
 * are unchanged. */
RAYMAP_API raymap_result raymap_surface_thickness(const raymap_surface* surface, const double* points,
                                                  const uint32_t* triangles, size_t count,
                                                  double max_thickness, const raymap_options* options,
                                                  const raymap_thickness_arrays* arrays);

/* How to choose points. Initialise with RAYMAP_INIT, which is the default. */
typedef struct raymap_sample_points_options {
  size_t size;          /* sizeof(raymap_sample_points_options) */
  bool normalize;       /* Whether the bounding sphere becomes the unit sphere about 0. */
  bool has_shares;      /* Whether the two shares are used; else they are 0 and 0.94. */
  double surface_share; /* Share of the points that are on the surface, 0 to 1. */
  double near_share;    /* Share of the points that are near the surface, 0 to 1. */
  const double* sigmas; /* Standard deviations of the offsets of these, as shares of the bounding sphere's
                           radius; each gets as many points. NULL = 0.0025 and 0.00025. */
  size_t sigma_count;   /* Number of deviations. */
  uint64_t seed;        /* Another seed gives other points. */
} raymap_sample_points_options;

/* The caller's arrays for points with distances; NULL = not wanted. Initialise with
 * RAYMAP_INIT. */
typedef struct raymap_point_sample_arrays {
  size_t size;      /* sizeof(raymap_point_sample_arrays) */
  double* points;   /* (position in the mesh - centre) * scale: x, y, z of each point. */
  double* distance; /* In the units of the points, negative inside. */
  double* gradient; /* Unit vector that points outwards: x, y, z of each point. */
  double* centre;   /* Point of the mesh that lies at 0 in `points`: x, y, z. */
  double* scale;    /* Length in `points` of one unit of the mesh: one number. */
} raymap_point_sample_arrays;

/* Chooses `count` points on a surface, near it and in its bounding sphere, in this order, and measures their
 * distances, as for training DeepSDF; raymap/sample_points.h says how. `how` may be NULL for the defaults.
 * Options: only "threads" and the progress callback are used; they may be NULL. After a failure the arrays
 * are unchanged. */
RAYMAP_API raymap_result raymap_sample_points(const raymap_surface* surface, size_t count,
                                              const raymap_sample_points_options* how,
                                              const raymap_options* options,
                                              const raymap_point_sample_arrays* arrays);

/* ---- Regions and narrow bands ---- */

/* Makes the field of a box of samples of a lattice of up to 2^24 samples a side: `extent` samples along each
 * axis, from sample `low` on. A sample's values are those of raymap_surface_query at its position on the
 * lattice, rounded to float, however the lattice is cut. The grid of the field has the position of `low` as
 * its origin. Options: only "band", "triangle", "winding", "confidence", "threads", "memory_limit" and the
 * callbacks are used; they may be NULL. */
RAYMAP_API raymap_field* raymap_surface_generate_region(const raymap_surface* surface,
                                                        const raymap_grid* lattice, const int32_t low[3],
                                                        const int32_t extent[3],
                                                        const raymap_options* options);
/* Finds the distance that all samples of a region have in its field if they lie beyond "band" on one side,
 * negative inside. NaN: some samples may lie in the band or on the other side, or there is no band. That
 * takes a few queries at most. Other options are not used; they may be NULL. */
RAYMAP_API raymap_result raymap_surface_far_distance(const raymap_surface* surface,
                                                     const raymap_grid* lattice, const int32_t low[3],
                                                     const int32_t extent[3], const raymap_options* options,
                                                     double* distance);
/* Finds the most bytes that the surface and a region of this extent hold together while it is made. Options:
 * only "triangle", "winding", "confidence" and "threads" are used; they may be NULL. */
RAYMAP_API raymap_result raymap_surface_region_bytes(const raymap_surface* surface, const int32_t extent[3],
                                                     const raymap_options* options, size_t* bytes);

/* A signed distance field near a surface alone: a narrow band. Leaves hold the values of 8 x 8 x 8 samples
 * each. Tiles are cubes of samples without leaves that all lie inside. Samples in neither lie outside. */
typedef struct raymap_sparse_field raymap_sparse_field;

/* How wide a narrow band is. Initialise with RAYMAP_INIT. */
typedef struct raymap_band_options {
  size_t size;    /* sizeof(raymap_band_options) */
  double outside; /* Width outside of the surface, in samples; 0 = the option "band", or 3 if that is 0. */
  double inside;  /* The same inside; 0 = as outside; INFINITY = the whole interior. */
} raymap_band_options;

/* Makes a narrow band on a lattice of up to 2^24 samples a side. A sample's values are those of
 * raymap_surface_query at its position, rounded to float. `band` may be NULL for the defaults. Options: only
 * "band", "triangle", "winding", "confidence", "threads", "memory_limit" and the callbacks are used;
 * they may be NULL. */
RAYMAP_API raymap_sparse_field* raymap_surface_generate_band(const raymap_surface* surface,
                                                             const raymap_grid* grid,
                                                             const raymap_band_options* band,
                                                             const raymap_options* options);
/* Returns the samples of a field near its surface. Fails with RAYMAP_ERROR_USAGE for a band that is wider
 * than the field's own, and for arrays that the field lacks. Options: only "band", "triangle", "winding",
 * "confidence", "threads" and "memory_limit" are used. `band` and the options may be NULL. */
RAYMAP_API raymap_sparse_field* raymap_field_to_sparse(const raymap_field* field,
                                                       const raymap_band_options* band,
                                                       const raymap_options* options);
/* Returns the field of all samples. Samples in no leaf are clamped; they have the triangle UINT32_MAX, and
 * NaN for winding number and confidence. Options: only "threads" and "memory_limit" are used; they may be
 * NULL. */
RAYMAP_API raymap_field* raymap_sparse_field_to_dense(const raymap_sparse_field* field,
                                                      const raymap_options* options);
RAYMAP_API void raymap_sparse_field_free(raymap_sparse_field* field);

/* The main numbers of a narrow band. */
typedef struct raymap_sparse_numbers {
  size_t size;     /* sizeof(raymap_sparse_numbers); RAYMAP_INIT sets it. */
  uint64_t leaves; /* Number of leaves. */
  uint64_t tiles;  /* Number of tiles. */
  uint64_t active; /* Number of samples whose distance is not clamped. */
  uint64_t bytes;  /* Bytes that the field holds. */
  double outside;  /* Distance at which distances outside are clamped, in the mesh's units. */
  double inside;   /* The same inside, above 0; infinite for the whole interior. */
} raymap_sparse_numbers;
RAYMAP_API raymap_result raymap_sparse_field_numbers(const raymap_sparse_field* field,
                                                     raymap_sparse_numbers* numbers);
/* Copies the lattice of a narrow band. Leaves and tiles may reach beyond its last samples. */
RAYMAP_API raymap_result raymap_sparse_field_grid(const raymap_sparse_field* field, raymap_grid* grid);

/* Returns the field's own leaves: the first sample of each, (i, j, k), along a Morton curve. NULL if there is
 * none, and for NULL. The field owns this array and those below: they are valid until it is freed. */
RAYMAP_API const int32_t* raymap_sparse_field_leaves(const raymap_sparse_field* field);
/* Returns the field's own tiles: of each the first sample, (i, j, k), and the number of samples along its
 * side. NULL if there is none, and for NULL. */
RAYMAP_API const int32_t* raymap_sparse_field_tiles(const raymap_sparse_field* field);
/* Returns the field's own distances, 512 values per leaf, x fastest, negative inside. Samples beyond the
 * lattice are far outside. NULL if there is no leaf, and for NULL. */
RAYMAP_API const float* raymap_sparse_field_distance(const raymap_sparse_field* field);
/* Returns the field's own indices of the closest triangles, in the same way; NULL also if they were not asked
 * for. UINT32_MAX where the distance is clamped. */
RAYMAP_API const uint32_t* raymap_sparse_field_triangle(const raymap_sparse_field* field);
/* Returns the field's own winding numbers, in the same way. */
RAYMAP_API const float* raymap_sparse_field_winding(const raymap_sparse_field* field);
/* Returns the field's own confidences in the sign, in the same way: 0 to 1. */
RAYMAP_API const float* raymap_sparse_field_confidence(const raymap_sparse_field* field);

/* Samples a narrow band as raymap_field_sample does the field of all samples, bit for bit. */
RAYMAP_API raymap_result raymap_sparse_field_sample(const raymap_sparse_field* field, const double* points,
                                                    size_t count, raymap_outside outside, float* distances,
                                                    float* gradients);
/* Returns the surface at a distance, as raymap_isosurface does of the field of all samples, bit for bit. Time
 * and memory grow with the surface. */
RAYMAP_API raymap_mesh* raymap_sparse_field_isosurface(const raymap_sparse_field* field, double iso,
                                                       const raymap_options* options);
/* Writes a narrow band with all its arrays as .vdb or .nvdb, whole or not at all. raymap_field_load
 * reads it as a field of all samples. Not in builds without files. */
RAYMAP_API raymap_result raymap_sparse_field_write(const raymap_sparse_field* field, const char* path);

/* ---- Scenes ---- */

/* Bodies with rigid poses, and the signed distance of points of the world to their union. Bodies are numbered
 * in the order in which they were added; removing one moves those after it down by one. raymap/scene.h says
 * what distances, closest points and gradients are. Several threads may query a scene at the same time. */
typedef struct raymap_scene raymap_scene;

/* Returns a scene without bodies. */
RAYMAP_API raymap_scene* raymap_scene_create(void);
RAYMAP_API void raymap_scene_free(raymap_scene* scene);
/* Adds a surface, a field or a narrow band after all other bodies. The scene refers to it: the caller frees
 * it after the scene, or once it is removed. The name must not be taken. A pose is a rotation and a
 * translation, 4 rows of 4 numbers that take the body's coordinates to those of the world, (x, y, z, 1) being
 * a column; NULL = the same coordinates. Fails with RAYMAP_ERROR_USAGE if it is no rigid motion, within 1e-5.
 */
RAYMAP_API raymap_result raymap_scene_add_surface(raymap_scene* scene, const char* name,
                                                  const raymap_surface* surface, const double pose[16]);
RAYMAP_API raymap_result raymap_scene_add_field(raymap_scene* scene, const char* name,
                                                const raymap_field* field, const double pose[16]);
RAYMAP_API raymap_result raymap_scene_add_sparse_field(raymap_scene* scene, const char* name,
                                                       const raymap_sparse_field* field,
                                                       const double pose[16]);
/* Removes a body. Fails with RAYMAP_ERROR_USAGE if there is none of this name. */
RAYMAP_API raymap_result raymap_scene_remove(raymap_scene* scene, const char* name);
/* Sets a body's pose, which costs nothing. Fails with RAYMAP_ERROR_USAGE if there is none of this name, or
 * the pose is no rigid motion. */
RAYMAP_API raymap_result raymap_scene_set_pose(raymap_scene* scene, const char* name, const double pose[16]);
/* Returns the number of bodies; 0 for NULL. */
RAYMAP_API size_t raymap_scene_size(const raymap_scene* scene);
/* Finds the number of a body. Fails with RAYMAP_ERROR_USAGE if there is none of this name. */
RAYMAP_API raymap_result raymap_scene_number(const raymap_scene* scene, const char* name, uint32_t* number);

/* Poses of all bodies in many configurations, such as those of a robot along a trajectory. Initialise with
 * RAYMAP_INIT. */
typedef struct raymap_configurations {
  size_t size;         /* sizeof(raymap_configurations) */
  bool has_own_points; /* Whether the points are those of one configuration after the other, as many in each;
                          else all configurations get the same points. */
  const double* poses; /* Poses of the bodies, in their order, of one configuration after the other. */
  size_t count;        /* Number of configurations. */
} raymap_configurations;

/* Arguments of a query of a scene: the caller's arrays for the results; NULL = not wanted. One value per
 * point, of one configuration after the other. Initialise with RAYMAP_INIT. A point that is not finite gets
 * NaN and the body UINT32_MAX. So does one at which a field has NaN. Without bodies, distances are infinite.
 */
typedef struct raymap_scene_arrays {
  size_t size;      /* sizeof(raymap_scene_arrays) */
  double* distance; /* Signed distance of the union: the least of the distances to the bodies. */
  uint32_t* body;   /* Number of the body that has it; of several, the lowest. */
  double* closest;  /* Closest point of that body, in the world: x, y, z. */
  double* gradient; /* Unit vector that leads away from the solid, in the world: x, y, z; 0 on the surface. */
  double* distances;   /* Distances to all bodies: as many per point as bodies. All are then queried. */
  uint32_t* triangle;  /* Triangle of that body that holds the closest point; UINT32_MAX if it is a field. */
  double max_distance; /* Points as far or farther get this distance, with their sign, and NaN and UINT32_MAX
                          for what depends on the closest point; outside, no body. 0 = no limit. */
  const uint32_t* without; /* Numbers of bodies that are left out; their `distances` are NaN. */
  size_t without_count;    /* Number of these. */
} raymap_scene_arrays;

/* Fills the arrays. `points` are x, y, z of each, `count` of them. The configurations may be NULL for the
 * scene's own poses. Options: only "threads" and the progress callback are used; they may be NULL.
 * After a failure the arrays are unchanged. */
RAYMAP_API raymap_result raymap_scene_query(const raymap_scene* scene, const double* points, size_t count,
                                            const raymap_configurations* configurations,
                                            const raymap_options* options, const raymap_scene_arrays* arrays);

/* ---- Inspection ---- */

/* Size, topology and defects of a mesh, the faces that cross, and a verdict. */
typedef struct raymap_inspection raymap_inspection;

/* Inspects a mesh. Only the progress callback of the options is used; they may be NULL. */
RAYMAP_API raymap_inspection* raymap_inspect(const raymap_mesh* mesh, const raymap_options* options);
RAYMAP_API void raymap_inspection_free(raymap_inspection* inspection);

/* The main numbers of an inspection. raymap/diagnostics.h and raymap/verdict.h say exactly what they count.
 */
typedef struct raymap_findings {
  size_t size;              /* sizeof(raymap_findings); RAYMAP_INIT sets it. */
  const char* kind;         /* Kind of the mesh: "clean_solid", "open_solid", "sheet", ... Valid for ever. */
  const char* remedy;       /* Way to a clean solid: "none", "repair" or "thicken". Valid for ever. */
  uint64_t vertices;        /* Number of vertices as stored. */
  uint64_t welded_vertices; /* Number of distinct positions. */
  uint64_t triangles;
  uint64_t components;         /* Number of parts connected through shared vertices. */
  uint64_t open_components;    /* Number of those with boundary edges. */
  uint64_t inward_components;  /* Number of closed ones with a negative volume. */
  uint64_t sheets;             /* Number of open ones that are mostly hole. */
  uint64_t holes;              /* Number of boundary loops. */
  uint64_t boundary_edges;     /* Number of edges with one face. */
  uint64_t non_manifold_edges; /* Number of edges with more than two faces. */
  uint64_t flipped_edges;      /* Number of edges that two faces use in the same direction. */
  uint64_t flipped_faces;      /* Least number of faces to reverse so that neighbours agree. */
  uint64_t degenerate_faces;   /* Number of faces without an area, or nearly so. */
  uint64_t duplicate_faces;    /* Number of further faces on the same three corners. */
  uint64_t double_sided_faces; /* Number of faces that lie back to back. */
  uint64_t crossing_pairs;     /* Number of pairs of faces that cross. */
  uint64_t crossing_faces;     /* Number of faces in them. */
  bool crossings_complete;     /* False if the search stopped early: there are at least so many pairs. */
  bool watertight;             /* Whether every edge has exactly two faces. */
  bool consistently_oriented;  /* Whether neighbours agree across every edge with two faces. */
  bool balanced;               /* Whether every edge is used equally often both ways. */
  double signed_volume;        /* Positive if faces point outwards. */
  double area;
  double min[3]; /* Bounds of the vertices that faces use. */
  double max[3];
  double
      thinnest; /* Thickness of the thinnest part; NaN if none is thinner than a 25th of the longest side. */
  double voxel_size;       /* Largest distance between samples that keeps that part; NaN if there is none. */
  const char* arrangement; /* How closed parts lie to each other: "unknown", "separate", "nested",
                              "misnested", "touching" or "overlapping". Valid for ever. */
  uint64_t coplanar_pairs; /* Number of pairs of faces that overlap in one plane. */
} raymap_findings;
RAYMAP_API raymap_result raymap_inspection_findings(const raymap_inspection* inspection,
                                                    raymap_findings* findings);

/* Returns all that was found as JSON: the text of `raymap info --json` (docs/report.md) without the unit.
 * Lists end after a thousand values. The caller frees the text with raymap_text_free. Not in builds without
 * files. */
RAYMAP_API char* raymap_inspection_json(const raymap_inspection* inspection);

/* ---- Repair ---- */

/* How to change a mesh beside closing it. Initialise with RAYMAP_INIT. raymap/repair.h says more. */
typedef struct raymap_repair_options {
  size_t size;               /* sizeof(raymap_repair_options) */
  bool close_holes_in_steps; /* Whether holes close in steps of a sample, instead of by a surface that
                              distances count. */
  bool keep_cavities;        /* Whether sealed cavities stay; else they are filled, with all parts in them. */
  bool remesh;               /* Whether to make all faces even if some could be kept. */
  bool is_brief;         /* Whether to measure nothing: the report then neither compares the meshes nor tells
                            what is wrong with them. Takes less time. */
  bool has_drop_smaller; /* Whether `drop_smaller` is used; else it is a thousandth of the largest part. */
  bool has_tolerance;    /* Whether `tolerance` is used; else it is a tenth of the spacing. */
  int32_t drain_holes;   /* Number of drain holes of each hollow; 0 = 1. */
  double offset;         /* Distance to move the surface outwards; negative: inwards. */
  double shell;          /* Thickness of the walls of a hollow solid; 0 = not hollow. */
  double min_thickness;  /* Least thickness of walls, fins and sheets, at least two samples; 0 = 1.75 samples,
                            the least that no samples miss. */
  double drain_hole;     /* Diameter of the drain holes; 0 = none. */
  double drop_smaller;   /* Volume, in the mesh's units cubed, below which parts are dropped. */
  double tolerance;      /* Largest deviation from the isosurface, or from faces that could be kept, to have
                            fewer faces; 0 = all faces. */
  double down[3];        /* Direction of the drain holes, of any length; 0 = (0, 0, -1). */
  bool loses_thin_parts; /* Whether a `min_thickness` of 0 is none: what samples miss is lost. */
  uint64_t triangles;    /* Most triangles of the result, with the least tolerance that reaches it; 0 = no
                            limit. Limited by `tolerance`. */
  bool has_base;         /* Whether `base` is used; else there is none. */
  double base;           /* Height against `down` of a flat base that walls join the rim of the mesh to. */
} raymap_repair_options;

/* Lays a grid that holds the result of a repair. Both options may be NULL for the defaults; a box, `dims`
 * and the thickness of the field are not used. */
RAYMAP_API raymap_result raymap_fit_repair_grid(const raymap_mesh* mesh, const raymap_grid_options* options,
                                                const raymap_repair_options* repair, raymap_grid* grid);

/* A repaired mesh and a report on it. */
typedef struct raymap_repaired raymap_repaired;

/* Makes a watertight solid of any mesh, on a grid that holds it. Keeps the faces of a mesh with nothing
 * wrong. Both options may be NULL for the defaults. Fails with RAYMAP_ERROR_USAGE for options of a field that
 * make no sense for a solid: no sign, "band", "invert", "thickness", "close_holes" and further arrays. */
RAYMAP_API raymap_repaired* raymap_repair(const raymap_mesh* mesh, const raymap_grid* grid,
                                          const raymap_repair_options* repair, const raymap_options* options);
RAYMAP_API void raymap_repaired_free(raymap_repaired* repaired);

/* Returns the repaired mesh, valid until `repaired` is freed, which owns it; NULL for NULL. */
RAYMAP_API const raymap_mesh* raymap_repaired_mesh(const raymap_repaired* repaired);

/* The main numbers of a repair. raymap/repair.h says exactly what they are. */
typedef struct raymap_repair_numbers {
  size_t size;             /* sizeof(raymap_repair_numbers); RAYMAP_INIT sets it. */
  uint64_t solids;         /* Number of parts of the result. */
  uint64_t cavities;       /* Number of its sealed cavities. */
  uint64_t hollows;        /* Number of hollows that the shell left. */
  uint64_t filled_hollows; /* Number of hollows that a drain hole does not fit into; they are solid. */
  uint64_t drain_holes;    /* Number of drain holes. */
  uint64_t dropped;        /* Number of parts that were too small. */
  uint64_t filled;         /* Number of sealed cavities that were filled. */
  uint64_t closed_holes;   /* Number of holes that were closed beside faces that were kept. */
  bool kept; /* Whether the mesh's own faces were kept, because nothing was wrong with it, or only holes. */
  bool parts_overlap; /* Whether parts overlap, touch or nest wrongly, and all else is right. */
  bool watertight;    /* Whether every edge of the result has two faces. False if nothing was measured. */
  bool consistently_oriented; /* Whether they agree. False if nothing was measured. */
  double volume;              /* Volume of the result. The rest is 0 if nothing was measured. */
  double result_from_mesh;    /* Largest distance from points of the result to the given surface. */
  double mesh_from_result;    /* Largest distance from points of the given surface to the result. */
  double lost_share;          /* Share of the mesh's area more than a sample outside the result. */
  double buried_share;        /* Share of the mesh's area more than a sample inside the result. */
} raymap_repair_numbers;
RAYMAP_API raymap_result raymap_repaired_numbers(const raymap_repaired* repaired,
                                                 raymap_repair_numbers* numbers);

/* Returns the whole report as JSON, with the keys of docs/report.md. Lists end after a thousand
 * values. The caller frees the text with raymap_text_free. Not in builds without files. */
RAYMAP_API char* raymap_repaired_json(const raymap_repaired* repaired);

/* ---- Simplification ---- */

/* How to simplify a mesh. Initialise with RAYMAP_INIT. */
typedef struct raymap_simplify_options {
  size_t size;        /* sizeof(raymap_simplify_options) */
  double tolerance;   /* Largest distance of points of either mesh to the other. 0 keeps the mesh; with
                         `triangles`, it is no limit. */
  double step;        /* Distance between these points; 0 = ten times the tolerance, or with `triangles` a
                         quarter of the mean edge of so many, at least the mesh's own. It is enlarged
                         until all points are at most about a million, and 32 for each face. */
  uint64_t triangles; /* Most triangles of the result, with the least tolerance that was found to reach it;
                         0 = no limit. */
} raymap_simplify_options;

/* How well a mesh was simplified. */
typedef struct raymap_simplified {
  size_t size;      /* sizeof(raymap_simplified); RAYMAP_INIT sets it. */
  double deviation; /* Largest distance measured from points of either mesh to the other. */
  uint64_t undone;  /* Number of faces at which a check failed, so that edge collapses were undone. */
  double tolerance; /* Tolerance that was in force; 0 = the mesh was kept. */
} raymap_simplified;

/* Returns a watertight mesh with fewer faces, close to the given one. Warns if it has more triangles than
 * were asked for. `simplified` may be NULL. Options: only "threads" and the callbacks are used; they may be
 * NULL. Fails with RAYMAP_ERROR_INPUT if the mesh is not a closed, oriented manifold. */
RAYMAP_API raymap_mesh* raymap_simplify(const raymap_mesh* mesh, const raymap_simplify_options* how,
                                        const raymap_options* options, raymap_simplified* simplified);

/* ---- Pictures ---- */

/* An 8-bit sRGB picture. The functions here fail with RAYMAP_ERROR_UNSUPPORTED in builds without pictures
 * (RAYMAP_RENDER=OFF). */
typedef struct raymap_picture raymap_picture;

/* How to look at a field or a mesh. Initialise with RAYMAP_INIT. */
typedef struct raymap_view {
  size_t size;          /* sizeof(raymap_view) */
  int32_t width;        /* In pixels; 0 = 1024. */
  int32_t height;       /* In pixels; 0 = 768. */
  bool cut;             /* Whether to remove the half of a field that is nearer to the camera. */
  bool has_frame;       /* Whether the camera frames the box below instead of the shape. */
  double direction[3];  /* Direction from the camera to the centre of the shape; 0 = (-0.6, -0.45, -1). */
  double up[3];         /* Direction up in the picture; 0 = (0, 1, 0). */
  double field_of_view; /* Angle from the bottom to the top of the picture, in degrees; 0 = 30. */
  double shell;         /* Thickness of the outer wall of a hollow shape; 0 = not hollow. */
  double frame_min[3];
  double frame_max[3];
  bool has_eye;          /* Whether the camera stands at `eye`, not where the shape fills the picture. */
  double eye[3];         /* Place of the camera, in the mesh's units. */
  double iso;            /* Distance at which the surface lies, in the mesh's units. */
  double cut_plane[4];   /* Plane of the cut, instead of the middle one: all points p with
                          * dot(normal, p) = offset, as normal and offset. What lies on the side of the
                          * normal is removed. Normal 0 = none. */
  double slice_plane[4]; /* Plane on which distances are drawn, with their lines; normal 0 = none. */
} raymap_view;

/* Draws the surface of a field at the distance `iso`. Options: only "threads", "device" and the callbacks
 * are used. `view` and `options` may be NULL for the defaults. */
RAYMAP_API raymap_picture* raymap_render_field(const raymap_field* field, const raymap_view* view,
                                               const raymap_options* options);
/* Draws the same of a narrow band. */
RAYMAP_API raymap_picture* raymap_render_sparse_field(const raymap_sparse_field* field,
                                                      const raymap_view* view, const raymap_options* options);
/* Draws a mesh with its defects in colour, which raymap/render.h lists. Only these members of the view are
 * used: the size, `direction`, `up` and `field_of_view`. Options as above. */
RAYMAP_API raymap_picture* raymap_render_defects(const raymap_mesh* mesh, const raymap_view* view,
                                                 const raymap_options* options);
/* Draws a slice of an array of a field across axis 0, 1 or 2 at sample `index`; -1 = the middle one. The
 * array is "distance" (or NULL), "winding", "confidence" or "triangle"; the width is in pixels, 0 = 1024. */
RAYMAP_API raymap_picture* raymap_render_slice(const raymap_field* field, int32_t axis, int32_t index,
                                               int32_t width, const char* array);
/* Draws the same of a narrow band. */
RAYMAP_API raymap_picture* raymap_render_sparse_slice(const raymap_sparse_field* field, int32_t axis,
                                                      int32_t index, int32_t width, const char* array);
RAYMAP_API void raymap_picture_free(raymap_picture* picture);

/* Returns the width in pixels; 0 for NULL. */
RAYMAP_API int32_t raymap_picture_width(const raymap_picture* picture);
/* Returns the height in pixels; 0 for NULL. */
RAYMAP_API int32_t raymap_picture_height(const raymap_picture* picture);
/* Returns the picture's own pixels: red, green and blue of each, one byte a colour, rows from the top,
 * without gaps. Valid until the picture is freed; NULL for NULL. */
RAYMAP_API const uint8_t* raymap_picture_rgb(const raymap_picture* picture);
/* Writes a picture as PNG. The file appears whole or not at all. */
RAYMAP_API raymap_result raymap_picture_write_png(const raymap_picture* picture, const char* path);

/* Contents of a page besides a field. Initialise with RAYMAP_INIT. */
typedef struct raymap_page_options {
  size_t size;       /* sizeof(raymap_page_options) */
  const char* title; /* Heading; NULL = the name of the file. */
  const char* array; /* Array in whose colours it begins: "distance" (or NULL), "winding", "confidence". */
  const raymap_mesh* mesh;   /* Mesh whose defects it lists; NULL = none. */
  const raymap_field* other; /* Field to compare with, sampled on the grid of the first; NULL = none. */
  const char* other_title;   /* Name of that field; NULL = "Other field". */
  int64_t max_size; /* Most samples along a side; 0 = 256. A larger field is shown on a coarser grid. */
  const raymap_sparse_field* other_sparse; /* Narrow band to compare with instead of `other`; NULL = none. */
} raymap_page_options;

/* Writes a page that shows a field in a browser with WebGL 2: one HTML file, which needs no network. It
 * begins with the view, without its slice. The file appears whole or not at all. `view`, `page` and `options`
 * may be NULL. */
RAYMAP_API raymap_result raymap_write_page(const raymap_field* field, const char* path,
                                           const raymap_view* view, const raymap_page_options* page,
                                           const raymap_options* options);
/* Writes a page of a narrow band, which shows distances only. raymap/page.h says which. */
RAYMAP_API raymap_result raymap_write_sparse_page(const raymap_sparse_field* field, const char* path,
                                                  const raymap_view* view, const raymap_page_options* page,
                                                  const raymap_options* options);

/* ---- Devices ---- */

/* All devices of this machine. */
typedef struct raymap_devices raymap_devices;

/* Description of a device. The list owns the texts. */
typedef struct raymap_device {
  size_t size;      /* sizeof(raymap_device); RAYMAP_INIT sets it. */
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
