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
 * Options are set by name: docs/options.md lists all, with their ranges and defaults. A call uses those of
 * its structs in C++, which it names. Reports are JSON with the keys of docs/report.md; raymap_json_number
 * reads one number of it.
 *
 * Structs whose first member is `size` hold arrays of the caller, and grow in later versions. The caller sets
 * it to the size of the struct, and all members that it does not need to 0: RAYMAP_INIT does both. Such a 0
 * means the default. The library reads `size` bytes only, so a program goes on working with a newer
 * library. An older library accepts a newer struct as long as the members that it does not know are 0.
 * A size that cannot be right, such as 0, is RAYMAP_ERROR_USAGE.
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
 *   raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
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

/* Finds a number in JSON by its keys with dots between them: "after.signed_volume", "holes.0.length". A
 * switch is 0 or 1, null is NaN. Fails with RAYMAP_ERROR_USAGE if there is none. */
RAYMAP_API raymap_result raymap_json_number(const char* json, const char* keys, double* number);

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

/* Options of all calls, by name. One handle may serve many calls. */
typedef struct raymap_options raymap_options;

/* Returns options with their defaults. */
RAYMAP_API raymap_options* raymap_options_create(void);
RAYMAP_API void raymap_options_free(raymap_options* options);

/* Set an option, in all structs that have one of this name. A switch is 0 or 1. Positions, boxes and planes
 * are several numbers. Fail with RAYMAP_ERROR_USAGE if there is no such option, or the value makes no sense
 * for it. */
RAYMAP_API raymap_result raymap_options_set_text(raymap_options* options, const char* option,
                                                 const char* value);
RAYMAP_API raymap_result raymap_options_set_number(raymap_options* options, const char* option, double value);
RAYMAP_API raymap_result raymap_options_set_numbers(raymap_options* options, const char* option,
                                                    const double* values, size_t count);
/* Sets the options of a JSON object: {"resolution": 64, "sign": "exact", "bounds": [[0, 0, 0], [1, 1, 1]]}.
 */
RAYMAP_API raymap_result raymap_options_set_json(raymap_options* options, const char* json);

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

/* Lays a grid of cubic cells over the mesh. Options: GridOptions; they may be NULL for the defaults. */
RAYMAP_API raymap_result raymap_fit_grid(const raymap_mesh* mesh, const raymap_options* options,
                                         raymap_grid* grid);

/* ---- Fields ---- */

/* A sampled signed distance field, negative inside, and what its making cost. It is dense, with one value per
 * sample of its grid, or a narrow band: leaves then hold the values of 8 x 8 x 8 samples each, near the
 * surface alone. Tiles are cubes of samples without leaves that all lie inside. Samples in neither lie
 * outside. */
typedef struct raymap_field raymap_field;

/* Returns an empty field, for raymap_generator_run to fill. */
RAYMAP_API raymap_field* raymap_field_create(void);
RAYMAP_API void raymap_field_free(raymap_field* field);

/* Makes a field. Options: FieldOptions and MachineOptions; they may be NULL for the defaults. */
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

/* Copies the grid of a field. Leaves and tiles may reach beyond its last samples. */
RAYMAP_API raymap_result raymap_field_grid(const raymap_field* field, raymap_grid* grid);
/* Returns the distance to which the field is clamped, on the narrower side; 0 if it is not, and for NULL. */
RAYMAP_API double raymap_field_clamp_distance(const raymap_field* field);

/* Returns the field's own distances, negative inside: one per sample, or 512 per leaf, x fastest. Samples of
 * a leaf beyond the grid are far outside. NULL if the field is empty or NULL. The field owns this array and
 * those below: they are valid until the field is filled again or freed. */
RAYMAP_API const float* raymap_field_distance(const raymap_field* field);
/* Returns the field's own indices of the closest triangles, in the same way; NULL also if they were not asked
 * for. UINT32_MAX beyond a band, and where surface that closes a hole is closer. */
RAYMAP_API const uint32_t* raymap_field_triangle(const raymap_field* field);
/* Returns the field's own winding numbers, in the same way: +1 inside a closed surface that faces outwards.
 */
RAYMAP_API const float* raymap_field_winding(const raymap_field* field);
/* Returns the field's own confidences in the sign, in the same way: 0 to 1. */
RAYMAP_API const float* raymap_field_confidence(const raymap_field* field);

/* Returns whether the field is a narrow band; false for NULL. */
RAYMAP_API bool raymap_field_is_narrow(const raymap_field* field);
/* Returns the number of leaves; 0 for a dense field and for NULL. */
RAYMAP_API size_t raymap_field_leaf_count(const raymap_field* field);
/* Returns the first sample of each leaf, (i, j, k), along a Morton curve. NULL if there is none. */
RAYMAP_API const int32_t* raymap_field_leaves(const raymap_field* field);
/* Returns the number of tiles; 0 for a dense field and for NULL. */
RAYMAP_API size_t raymap_field_tile_count(const raymap_field* field);
/* Returns of each tile the first sample, (i, j, k), and the number of samples along its side; NULL if there
 * is none. */
RAYMAP_API const int32_t* raymap_field_tiles(const raymap_field* field);

/* Returns the samples of a dense field near its surface, as a narrow band. Fails with RAYMAP_ERROR_USAGE for
 * a band that is wider than the field's own, and for arrays that the field lacks. Options: BandOptions,
 * "threads" and "memory_limit"; they may be NULL. */
RAYMAP_API raymap_field* raymap_field_to_narrow(const raymap_field* field, const raymap_options* options);
/* Returns the dense field of a narrow band. Samples in no leaf are clamped; they have the triangle
 * UINT32_MAX, and NaN for winding number and confidence. Options: "threads" and "memory_limit"; they may be
 * NULL. */
RAYMAP_API raymap_field* raymap_field_to_dense(const raymap_field* field, const raymap_options* options);

/* Returns what making the field cost and found, as JSON (docs/report.md, Stats), of a narrow band
 * also with "outside" and "inside", the distances at which it is clamped (null if infinite), and "active",
 * the number of samples that are not. Its "bytes" are what it holds. A field from a file has cost nothing:
 * all its numbers are 0. The caller frees the text with raymap_text_free. */
RAYMAP_API char* raymap_field_json(const raymap_field* field);

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

/* Returns the surface at the distance "iso" as a new closed mesh. Options: also "threads" and the callbacks;
 * they may be NULL. */
RAYMAP_API raymap_mesh* raymap_isosurface(const raymap_field* field, const raymap_options* options);

/* Reads .nrrd, .npz, .npy, .vti, .vdb or .nvdb as a dense field. Only the warning callback of the options is
 * used, if not NULL. It is called if the file has arrays that a field has not. Not in builds without files.
 */
RAYMAP_API raymap_field* raymap_field_load(const char* path, const raymap_options* options);
/* Writes one array as .nrrd, .npz, .npy, .vti, .vdb or .nvdb by extension: "distance" (or NULL), "winding",
 * "confidence" or "triangle". A narrow band is written with all its arrays, as .vdb or .nvdb; `array` is NULL
 * or "distance" then. The file appears whole or not at all. Not in builds without files. */
RAYMAP_API raymap_result raymap_field_write(const raymap_field* field, const char* path, const char* array);

/* Files of a field and how they are written, as raymap::FieldFiles; NULL = not wanted. Initialise with
 * RAYMAP_INIT. */
typedef struct raymap_field_files {
  size_t size;            /* sizeof(raymap_field_files) */
  const char* distance;   /* Distances, with the other arrays of the options in all but a .npy and a .nrrd. */
  const char* triangle;   /* Closest triangles, which are then computed. */
  const char* winding;    /* Winding numbers, which are then computed. */
  const char* confidence; /* Confidence in the sign, which is then computed. */
  bool half;              /* Whether numbers take 16 bits, in files that can store them. */
  bool full_inside;       /* Whether only distances outside are clamped to "band", in a .vdb or .nvdb. */
  const char* grid_name;  /* Name of the distance's grid in a .vdb or .nvdb. */
} raymap_field_files;

/* Makes a field and writes its files, without a handle of it. A field that memory does not hold is made in
 * pieces: as a narrow band in a .vdb or .nvdb with a "band", else in slabs of planes in a .npy, .nrrd or
 * .vti. raymap/generate_file.h says when. A call that failed on slabs leaves what it wrote, and the next one
 * with the same arguments goes on from there. `report` receives the report as JSON (docs/report.md,
 * FileReport), which the caller frees with raymap_text_free; NULL = not wanted. Options: FieldOptions and
 * MachineOptions; they may be NULL. Not in builds without files. */
RAYMAP_API raymap_result raymap_generate_file(const raymap_mesh* mesh, const raymap_grid* grid,
                                              const raymap_field_files* files, const raymap_options* options,
                                              char** report);

/* ---- Queries at any points ---- */

/* A mesh prepared once for queries at any points. It keeps a copy of the mesh. Several threads may query it
 * at the same time. */
typedef struct raymap_surface raymap_surface;

/* Prepares a mesh. Options: SurfaceOptions, "threads", "memory_limit" and the progress callback; they may be
 * NULL. */
RAYMAP_API raymap_surface* raymap_surface_create(const raymap_mesh* mesh, const raymap_options* options);
RAYMAP_API void raymap_surface_free(raymap_surface* surface);
/* Returns the bytes that the surface holds; 0 for NULL. */
RAYMAP_API size_t raymap_surface_bytes(const raymap_surface* surface);
/* Returns what preparing the mesh cost, and what was found out about it, as JSON (docs/report.md, Stats). The
 * caller frees it with raymap_text_free. */
RAYMAP_API char* raymap_surface_json(const raymap_surface* surface);

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

/* Fills the arrays. `points` are x, y, z of each. Points farther than "max_distance" get this distance with
 * their sign, NaN instead of positions, and the triangle UINT32_MAX. Options: also "threads" and the progress
 * callback; they may be NULL. After a failure the arrays are unchanged. */
RAYMAP_API raymap_result raymap_surface_query(const raymap_surface* surface, const double* points,
                                              size_t count, const raymap_options* options,
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
 * lies on. Parts thicker than "max_thickness" are taken as infinitely thick. Options: also "threads" and the
 * progress callback; they may be NULL. Fails with RAYMAP_ERROR_USAGE for a face that does not exist and a
 * surface without a sign. After a failure the arrays are unchanged. */
RAYMAP_API raymap_result raymap_surface_thickness(const raymap_surface* surface, const double* points,
                                                  const uint32_t* triangles, size_t count,
                                                  const raymap_options* options,
                                                  const raymap_thickness_arrays* arrays);

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
 * distances, as for training DeepSDF; raymap/sample_points.h says how. Options: SamplePointsOptions but
 * "count", "threads" and the progress callback; they may be NULL. After a failure the arrays are unchanged.
 */
RAYMAP_API raymap_result raymap_sample_points(const raymap_surface* surface, size_t count,
                                              const raymap_options* options,
                                              const raymap_point_sample_arrays* arrays);

/* ---- Distances between surfaces ---- */

/* A point of each of two surfaces, as raymap::SurfacePair. */
typedef struct raymap_surface_pair {
  double distance;         /* Distance of the two points. */
  double bound;            /* Upper bound on the measured distance. */
  double point[3];         /* Point of the one surface; NaN if they are too far apart. */
  double other_point[3];   /* Point of the other. */
  uint32_t triangle;       /* Triangle that holds `point`; UINT32_MAX if there is none. */
  uint32_t other_triangle; /* Triangle that holds `other_point`. */
} raymap_surface_pair;

/* Finds the points of two surfaces that are least apart: 0 where faces cross. `pose` takes the other's
 * coordinates to those of `surface`, as that of raymap_scene_add_surface; NULL = the same coordinates.
 * Options: only "max_distance" and the progress callback are used; they may be NULL. */
RAYMAP_API raymap_result raymap_surface_distance(const raymap_surface* surface, const raymap_surface* other,
                                                 const double pose[16], const raymap_options* options,
                                                 raymap_surface_pair* found);
/* Finds the point of `surface`, or with `both_ways` of either, that is farthest from the other one: the
 * Hausdorff distance. `bound` exceeds it by at most the tolerance; 0 = 1e-4 of the diagonal. Options: only
 * "threads" and the progress callback are used; they may be NULL. */
RAYMAP_API raymap_result raymap_surface_hausdorff(const raymap_surface* surface, const raymap_surface* other,
                                                  const double pose[16], double tolerance, bool both_ways,
                                                  const raymap_options* options, raymap_surface_pair* found);

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

/* Makes a narrow band on a lattice of up to 2^24 samples a side. A sample's values are those of
 * raymap_surface_query at its position, rounded to float. Options: BandOptions, "threads", "memory_limit" and
 * the callbacks; they may be NULL. */
RAYMAP_API raymap_field* raymap_surface_generate_band(const raymap_surface* surface, const raymap_grid* grid,
                                                      const raymap_options* options);

/* ---- Scenes ---- */

/* Bodies with poses, and the signed distance of points of the world to their union. Bodies are numbered
 * in the order in which they were added; removing one moves those after it down by one. raymap/scene.h says
 * what distances, closest points and gradients are. Several threads may query a scene at the same time. */
typedef struct raymap_scene raymap_scene;

/* Returns a scene without bodies. */
RAYMAP_API raymap_scene* raymap_scene_create(void);
RAYMAP_API void raymap_scene_free(raymap_scene* scene);
/* Adds a surface or a field after all other bodies. The scene refers to it: the caller frees
 * it after the scene, or once it is removed. The name must not be taken. A pose is a rotation, a scale
 * and a translation, 4 rows of 4 numbers that take the body's coordinates to those of the world, (x, y, z, 1)
 * being a column; NULL = the same coordinates. Fails with RAYMAP_ERROR_USAGE if it is no scaled rigid motion,
 * within 1e-5.
 */
RAYMAP_API raymap_result raymap_scene_add_surface(raymap_scene* scene, const char* name,
                                                  const raymap_surface* surface, const double pose[16]);
RAYMAP_API raymap_result raymap_scene_add_field(raymap_scene* scene, const char* name,
                                                const raymap_field* field, const double pose[16]);
/* Removes a body. Fails with RAYMAP_ERROR_USAGE if there is none of this name. */
RAYMAP_API raymap_result raymap_scene_remove(raymap_scene* scene, const char* name);
/* Sets a body's pose, which costs nothing. Fails with RAYMAP_ERROR_USAGE if there is none of this name, or
 * the pose is no scaled rigid motion. */
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
  double* distances;  /* Distances to all bodies: as many per point as bodies. All are then queried. */
  uint32_t* triangle; /* Triangle of that body that holds the closest point; UINT32_MAX if it is a field. */
  const uint32_t* without; /* Numbers of bodies that are left out; their `distances` are NaN. */
  size_t without_count;    /* Number of these. */
} raymap_scene_arrays;

/* Fills the arrays. `points` are x, y, z of each, `count` of them. The configurations may be NULL for the
 * scene's own poses. Points as far as "max_distance" or farther get this distance, with their sign, and NaN
 * and UINT32_MAX for what depends on the closest point; outside, no body. Options: also "threads" and the
 * progress callback; they may be NULL. After a failure the arrays are unchanged. */
RAYMAP_API raymap_result raymap_scene_query(const raymap_scene* scene, const double* points, size_t count,
                                            const raymap_configurations* configurations,
                                            const raymap_options* options, const raymap_scene_arrays* arrays);

/* Makes the field of the union of a scene: the distances of raymap_scene_query at the samples. Options: only
 * "band", "threads", "memory_limit" and the callbacks are used; they may be NULL. */
RAYMAP_API raymap_field* raymap_scene_generate(const raymap_scene* scene, const raymap_grid* grid,
                                               const raymap_options* options);
/* Makes a narrow band of it, on a lattice of up to 2^24 samples a side. Options: only "outside", "inside",
 * "threads", "memory_limit" and the callbacks are used; they may be NULL. */
RAYMAP_API raymap_field* raymap_scene_generate_band(const raymap_scene* scene, const raymap_grid* grid,
                                                    const raymap_options* options);

/* Finds the least distance of the two bodies of each pair, of one configuration after the other: `found` has
 * room for all. `pairs` are two numbers of bodies each, `count` of them; the bodies are surfaces. The points
 * are in the world. The configurations may be NULL for the scene's own poses. Options: only "max_distance",
 * "threads" and the progress callback are used; they may be NULL. */
RAYMAP_API raymap_result raymap_scene_distances(const raymap_scene* scene, const uint32_t* pairs,
                                                size_t count, const raymap_configurations* configurations,
                                                const raymap_options* options, raymap_surface_pair* found);

/* ---- Inspection ---- */

/* Returns the size, topology and defects of a mesh, the faces that cross and a verdict, as JSON: what `raymap
 * info --json` prints (docs/report.md) without the unit. Adds its sentences: "kind_text" says what the mesh
 * is and what else is wrong with it, "defects_text" counts its defects, and "thickness_text" says what a
 * repair keeps of its thinnest part. Lists end after a thousand values. The caller frees it with
 * raymap_text_free. Options: "threads", "memory_limit" and the progress callback; they may be NULL. */
RAYMAP_API char* raymap_inspect(const raymap_mesh* mesh, const raymap_options* options);

/* ---- Repair and simplification ---- */

/* Lays a grid that holds the result of a repair. Options: GridOptions but "bounds", "shape" and "thickness",
 * and RepairOptions; they may be NULL for the defaults. */
RAYMAP_API raymap_result raymap_fit_repair_grid(const raymap_mesh* mesh, const raymap_options* options,
                                                raymap_grid* grid);

/* Makes a watertight solid of any mesh, on a grid that holds it. Keeps the faces of a mesh with nothing
 * wrong. `report` receives the report as JSON (docs/report.md, RepairReport), which the caller frees with
 * raymap_text_free; NULL = not wanted. Options: RepairOptions, FieldOptions and MachineOptions; they may be
 * NULL. Fails with RAYMAP_ERROR_USAGE for options of a field that make no sense for a solid: no sign, "band",
 * "invert", "thickness" and further arrays. */
RAYMAP_API raymap_mesh* raymap_repair(const raymap_mesh* mesh, const raymap_grid* grid,
                                      const raymap_options* options, char** report);

/* Returns a watertight mesh with fewer faces, close to the given one. Warns if it has more triangles than
 * were asked for. `report` receives the report as JSON (docs/report.md, SimplifyReport), as raymap_repair
 * does. Options: SimplifyOptions, "threads" and the callbacks; they may be NULL. Fails with
 * RAYMAP_ERROR_INPUT if the mesh is not a closed, oriented manifold. */
RAYMAP_API raymap_mesh* raymap_simplify(const raymap_mesh* mesh, const raymap_options* options,
                                        char** report);

/* ---- Pictures ---- */

/* An 8-bit sRGB picture. The functions here fail with RAYMAP_ERROR_UNSUPPORTED in builds without pictures
 * (RAYMAP_RENDER=OFF). */
typedef struct raymap_picture raymap_picture;

/* Draws the surface of a field. Options: RenderOptions, "threads", "device" and the callbacks; they may be
 * NULL. */
RAYMAP_API raymap_picture* raymap_render_field(const raymap_field* field, const raymap_options* options);
/* Draws a mesh with its defects in colour, which raymap/render.h lists. Options: "width", "height",
 * "direction", "up", "field_of_view", and as above. */
RAYMAP_API raymap_picture* raymap_render_defects(const raymap_mesh* mesh, const raymap_options* options);
/* Draws a slice of a field across axis 0, 1 or 2 at sample `index`; -1 = the middle one. Options: "array" and
 * "width"; they may be NULL. */
RAYMAP_API raymap_picture* raymap_render_slice(const raymap_field* field, int32_t axis, int32_t index,
                                               const raymap_options* options);
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

/* Writes a page that shows a field in a browser with WebGL 2: one HTML file, which needs no network. It lists
 * the defects of `mesh`, and compares with `other` on the grid of the field; either may be NULL. The page of
 * a narrow band shows distances only; raymap/page.h says which. The file appears whole or not at all.
 * Options: PageOptions, RenderOptions but "slice_plane", and MachineOptions; they may be NULL. */
RAYMAP_API raymap_result raymap_write_page(const raymap_field* field, const char* path,
                                           const raymap_mesh* mesh, const raymap_field* other,
                                           const raymap_options* options);

/* ---- Devices ---- */

/* Returns all devices of this machine as a JSON list (docs/report.md, DeviceInfo), the CPU first. Asks every
 * Vulkan driver, which can take a second. The caller frees it with raymap_text_free. */
RAYMAP_API char* raymap_devices_json(void);
/* Compares every stage and whole fields on a GPU with the CPU, and keeps the result in the user's cache
 * folder (RAYMAP_CACHE). Returns RAYMAP_ERROR_UNSUPPORTED if it fails; the message gives the first
 * difference. */
RAYMAP_API raymap_result raymap_devices_test(const char* id);

/* NOLINTEND(readability-identifier-naming) */

#ifdef __cplusplus
}
#endif

#endif
