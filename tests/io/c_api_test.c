/* Uses raymap/c.h from C11: every function, its results and its errors. Takes a folder to write to. */

#include <raymap/c.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Active in every build, unlike assert. */
#define CHECK(condition)                                                                         \
  do {                                                                                           \
    if (!(condition)) {                                                                          \
      fprintf(stderr, "%s:%d: failed: %s (last error %d: %s)\n", __FILE__, __LINE__, #condition, \
              (int)raymap_last_error(), raymap_last_error_message());                            \
      exit(1);                                                                                   \
    }                                                                                            \
  } while (0)

#define CHECK_FAILS(call, code, text)                           \
  do {                                                          \
    (void)(call);                                               \
    CHECK(raymap_last_error() == (code));                       \
    CHECK(strstr(raymap_last_error_message(), (text)) != NULL); \
  } while (0)

static const float kVertices[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
static const uint32_t kTriangles[4][3] = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};

static raymap_mesh* make_tetrahedron(void) {
  raymap_mesh_arrays arrays = {0};
  arrays.vertices = kVertices;
  arrays.vertex_count = 4;
  arrays.triangles = kTriangles;
  arrays.triangle_count = 4;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  CHECK(mesh != NULL);
  return mesh;
}

static raymap_grid fit(const raymap_mesh* mesh) {
  raymap_grid_options options = raymap_grid_options_default();
  raymap_grid grid;
  double padded;
  CHECK(options.resolution == 128 && options.thickness == 0.0);
  options.thickness = 1.0;
  CHECK(raymap_fit_grid(mesh, &options, &grid) == RAYMAP_OK);
  padded = grid.spacing * (double)grid.dims[0];
  options.thickness = 0.0;
  CHECK(raymap_fit_grid(mesh, &options, &grid) == RAYMAP_OK);
  CHECK(fabs(padded - grid.spacing * (double)grid.dims[0] - 1.0) < 1e-9);
  options.resolution = 21;
  CHECK(raymap_fit_grid(mesh, &options, &grid) == RAYMAP_OK);
  CHECK(grid.dims[0] == 21 && grid.spacing > 0.0);
  return grid;
}

static size_t sample_count(const raymap_grid* grid) {
  return (size_t)grid->dims[0] * (size_t)grid->dims[1] * (size_t)grid->dims[2];
}

/* The sample in the middle. */
static size_t middle_of(const raymap_grid* grid) {
  const size_t nx = (size_t)grid->dims[0], ny = (size_t)grid->dims[1], nz = (size_t)grid->dims[2];
  return (nz / 2 * ny + ny / 2) * nx + nx / 2;
}

static raymap_options* on_cpu(void) {
  raymap_options* options = raymap_options_create();
  CHECK(options != NULL);
  CHECK(raymap_options_set_text(options, "device", "cpu") == RAYMAP_OK);
  return options;
}

static void test_meshes(void) {
  raymap_mesh* mesh = make_tetrahedron();
  double positions[12], low[3], high[3];
  uint32_t indices[12];
  CHECK(raymap_mesh_vertex_count(mesh) == 4 && raymap_mesh_triangle_count(mesh) == 4);
  CHECK(raymap_mesh_copy_positions(mesh, positions) == RAYMAP_OK);
  CHECK(positions[3] == 1.0 && positions[4] == -1.0);
  CHECK(raymap_mesh_copy_triangles(mesh, indices) == RAYMAP_OK);
  CHECK(memcmp(indices, kTriangles, sizeof indices) == 0);
  CHECK(raymap_mesh_bounds(mesh, low, high) == RAYMAP_OK);
  CHECK(low[0] == -1.0 && high[2] == 1.0);
  raymap_mesh_free(mesh);
}

/* Doubles with a gap, 64-bit indices and an origin. */
static void test_other_arrays(void) {
  double vertices[4][4];
  uint64_t triangles[4][3];
  double low[3], high[3];
  raymap_mesh_arrays arrays = {0};
  for (int v = 0; v < 4; ++v)
    for (int a = 0; a < 3; ++a) {
      vertices[v][a] = (double)kVertices[v][a];
      triangles[v][a] = kTriangles[v][a];
    }
  arrays.vertices = vertices;
  arrays.vertex_count = 4;
  arrays.vertex_stride = sizeof vertices[0];
  arrays.has_double_vertices = true;
  arrays.triangles = triangles;
  arrays.triangle_count = 4;
  arrays.has_64_bit_indices = true;
  arrays.origin[1] = 100.0;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  CHECK(raymap_mesh_bounds(mesh, low, high) == RAYMAP_OK);
  CHECK(low[1] == 99.0 && high[1] == 101.0);
  triangles[2][1] = UINT64_C(5000000000);
  CHECK_FAILS(raymap_mesh_bounds(mesh, low, high), RAYMAP_ERROR_INPUT, "triangle 2 uses vertex 5000000000");
  raymap_mesh_free(mesh);
}

static void test_field(void) {
  raymap_mesh* mesh = make_tetrahedron();
  const raymap_grid grid = fit(mesh);
  raymap_options* options = on_cpu();
  CHECK(raymap_options_set_number(options, "winding", 1) == RAYMAP_OK);
  CHECK(raymap_options_set_number(options, "triangle_ids", 1) == RAYMAP_OK);
  raymap_field* field = raymap_generate(mesh, &grid, options);
  CHECK(field != NULL);

  raymap_grid same;
  CHECK(raymap_field_grid(field, &same) == RAYMAP_OK);
  CHECK(memcmp(same.dims, grid.dims, sizeof grid.dims) == 0 && same.spacing == grid.spacing);
  const float* distance = raymap_field_distance(field);
  CHECK(distance != NULL && distance[middle_of(&grid)] < 0.0f && distance[0] > 0.0f);
  CHECK(fabs(raymap_field_winding(field)[middle_of(&grid)] - 1.0f) < 1e-5);
  CHECK(raymap_field_triangle(field)[0] < 4);
  CHECK(raymap_field_confidence(field) == NULL);
  CHECK(raymap_field_band(field) == 0.0);
  CHECK(strcmp(raymap_field_device(field), "cpu") == 0);
  raymap_stats stats;
  CHECK(raymap_field_stats(field, &stats) == RAYMAP_OK);
  CHECK(stats.bytes > sample_count(&grid) * sizeof(float) && stats.milliseconds > 0.0);
  CHECK(stats.doubtful_share == 0.0 && stats.turned_faces == 0);

  /* Positions and the numbers of a sample agree. */
  const double points[2][3] = {{grid.origin[0], grid.origin[1], grid.origin[2]}, {0, 0, 0}};
  float distances[2], gradients[2][3];
  CHECK(raymap_field_sample(field, &points[0][0], 2, RAYMAP_OUTSIDE_BOUND, distances, &gradients[0][0]) ==
        RAYMAP_OK);
  CHECK(fabsf(distances[0] - distance[0]) < 1e-5f && distances[1] < 0.0f);
  CHECK(gradients[0][0] < 0.0f);
  CHECK(raymap_field_sample(field, &points[0][0], 2, RAYMAP_OUTSIDE_NAN, NULL, NULL) == RAYMAP_OK);
  CHECK(raymap_field_sample(field, NULL, 0, RAYMAP_OUTSIDE_BOUND, NULL, NULL) == RAYMAP_OK);
  const double beyond[3] = {0, 0, 100}; /* The tetrahedron reaches to 1. */
  CHECK(raymap_field_sample(field, beyond, 1, RAYMAP_OUTSIDE_BOUND, distances, NULL) == RAYMAP_OK);
  CHECK(distances[0] >= 99.0f && distances[0] < 100.0f);
  CHECK(raymap_field_sample(field, beyond, 1, RAYMAP_OUTSIDE_NAN, distances, &gradients[0][0]) == RAYMAP_OK);
  CHECK(isnan(distances[0]) && isnan(gradients[0][2]));

  /* The same through a generator, into a field that is reused. */
  raymap_generator* generator = raymap_generator_create();
  raymap_field* other = raymap_field_create();
  CHECK(raymap_field_distance(other) == NULL);
  for (int run = 0; run < 2; ++run)
    CHECK(raymap_generator_run(generator, mesh, &grid, options, other) == RAYMAP_OK);
  CHECK(memcmp(raymap_field_distance(other), distance, sample_count(&grid) * sizeof(float)) == 0);

  raymap_mesh* surface = raymap_isosurface(field, 0.0, NULL);
  CHECK(raymap_mesh_triangle_count(surface) > 100);
  CHECK_FAILS(raymap_isosurface(field, -50.0, options), RAYMAP_ERROR_USAGE, "no surface at -50");

  raymap_mesh_free(surface);
  raymap_field_free(other);
  raymap_generator_free(generator);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* The tetrahedron's faces lie in planes such as x + y + z = -1, so the origin is 1 / sqrt(3) inside. */
/* The surface is that of the tetrahedron. */
static void check_sample_points(const raymap_surface* surface) {
  enum { COUNT = 200 };
  static double points[COUNT][3], distance[COUNT], gradient[COUNT][3], queried[COUNT];
  const double sigma = 0.1;
  double centre[3] = {9, 9, 9}, scale = 0, first;
  raymap_sample_points_options how = {.size = sizeof(how)};
  how.has_shares = true;
  how.surface_share = 0.25;
  how.near_share = 0.5;
  how.sigmas = &sigma;
  how.sigma_count = 1;
  raymap_point_sample_arrays arrays = {sizeof(arrays), &points[0][0], distance, &gradient[0][0], centre, &scale};
  CHECK(raymap_sample_points(surface, COUNT, &how, NULL, &arrays) == RAYMAP_OK);
  CHECK(scale == 1.0 && centre[0] == 0.0 && centre[2] == 0.0);
  raymap_query_arrays asked = {0};
  asked.distance = queried;
  CHECK(raymap_surface_query(surface, &points[0][0], COUNT, 0.0, NULL, &asked) == RAYMAP_OK);
  for (int i = 0; i < COUNT; ++i) {
    CHECK(i < COUNT / 4 ? distance[i] == 0.0 && fabs(queried[i]) < 1e-6 : distance[i] == queried[i]);
    const double* g = gradient[i];
    CHECK(fabs(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] - 1.0) < 1e-9);
  }
  first = points[0][0];
  how.seed = 1;
  how.normalize = true;
  arrays.distance = arrays.gradient = arrays.centre = NULL;
  CHECK(raymap_sample_points(surface, COUNT, &how, NULL, &arrays) == RAYMAP_OK);
  CHECK(scale != 1.0 && points[0][0] != first);
  how.near_share = 2.0;
  CHECK_FAILS(raymap_sample_points(surface, COUNT, &how, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "near must be a share from 0 to 1, not 2");
  arrays.distance = distance;
  CHECK(raymap_sample_points(surface, 50, NULL, NULL, &arrays) == RAYMAP_OK);
  for (int i = 0; i < 47; ++i) CHECK(fabs(distance[i]) < 0.0025 * 6 * sqrt(3.0)); /* The default is near. */
  how.size = 3;
  CHECK_FAILS(raymap_sample_points(surface, 1, &how, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "raymap_sample_points_options: the size is 3; set it to");
  arrays.size = 0;
  CHECK_FAILS(raymap_sample_points(surface, 1, NULL, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "raymap_point_sample_arrays: the size is 0; set it to");
}

static void test_surface(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_options* options = raymap_options_create();
  raymap_surface* surface = raymap_surface_create(mesh, options);
  raymap_mesh_free(mesh);
  CHECK(surface != NULL && raymap_surface_bytes(surface) > 1000);
  raymap_stats stats;
  CHECK(raymap_surface_stats(surface, &stats) == RAYMAP_OK);
  CHECK(stats.turned_faces == 0 && stats.milliseconds > 0.0);

  const double points[4][3] = {{0, 0, 0}, {2, 2, 2}, {NAN, 0, 0}, {0, 0, 20}};
  double distance[4], closest[4][3], barycentric[4][3], direction[4][3];
  uint32_t triangle[4];
  float winding[4], confidence[4];
  raymap_query_arrays arrays = {0};
  arrays.distance = distance;
  arrays.closest = &closest[0][0];
  arrays.triangle = triangle;
  arrays.barycentric = &barycentric[0][0];
  arrays.direction = &direction[0][0];
  arrays.winding = winding;
  arrays.confidence = confidence;
  CHECK(raymap_surface_query(surface, &points[0][0], 4, 10.0, options, &arrays) == RAYMAP_OK);
  CHECK(fabs(distance[0] + sqrt(1.0 / 3.0)) < 1e-6 && fabs(distance[1] - sqrt(3.0)) < 1e-6);
  CHECK(isnan(distance[2]) && distance[3] == 10.0);
  for (int a = 0; a < 3; ++a) {
    CHECK(fabs(closest[1][a] - 1.0) < 1e-6 && fabs(direction[1][a] + sqrt(1.0 / 3.0)) < 1e-6);
    CHECK(isnan(closest[2][a]) && isnan(closest[3][a]));
  }
  CHECK(triangle[0] < 4 && triangle[1] < 3 && triangle[2] == UINT32_MAX && triangle[3] == UINT32_MAX);
  CHECK(fabs(barycentric[0][0] - 1.0 / 3.0) < 1e-6);
  CHECK(fabs(barycentric[1][0] + barycentric[1][1] + barycentric[1][2] - 1.0) < 1e-12);
  CHECK(winding[0] == 1.0f && winding[1] == 0.0f && confidence[0] > 0.9f);
  CHECK(raymap_surface_query(surface, &points[3][0], 1, 0.0, NULL, &arrays) == RAYMAP_OK);
  CHECK(distance[0] > 18.0);
  CHECK(raymap_surface_query(surface, NULL, 0, 0.0, NULL, &arrays) == RAYMAP_OK);
  CHECK_FAILS(raymap_surface_query(surface, &points[0][0], 1, -1.0, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "the largest distance must be positive");
  check_sample_points(surface);
  raymap_surface_free(surface);

  mesh = make_tetrahedron();
  CHECK(raymap_options_set_text(options, "sign", "none") == RAYMAP_OK);
  surface = raymap_surface_create(mesh, options);
  CHECK_FAILS(raymap_surface_query(surface, &points[0][0], 1, 0.0, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "made without a sign");
  arrays.winding = arrays.confidence = NULL;
  CHECK(raymap_surface_query(surface, &points[0][0], 1, 0.0, NULL, &arrays) == RAYMAP_OK &&
        distance[0] > 0.5);
  raymap_surface_free(surface);
  CHECK(raymap_options_set_text(options, "sign", "rays") == RAYMAP_OK);
  CHECK_FAILS(raymap_surface_create(mesh, options), RAYMAP_ERROR_USAGE, "cannot use the sign 'rays'");
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_threads(void) {
  int32_t threads = -1;
  CHECK(raymap_default_threads(&threads) == RAYMAP_OK && threads == 0);
  CHECK(raymap_set_default_threads(3) == RAYMAP_OK);
  CHECK(raymap_default_threads(&threads) == RAYMAP_OK && threads == 3);
  CHECK(raymap_set_default_threads(-1) == RAYMAP_ERROR_USAGE);
  CHECK(raymap_default_threads(&threads) == RAYMAP_OK && threads == 3);
  CHECK(raymap_default_threads(NULL) == RAYMAP_ERROR_USAGE);
  CHECK(raymap_set_default_threads(0) == RAYMAP_OK);
}

static void test_options(void) {
  raymap_options* options = raymap_options_create();
  CHECK(raymap_options_set_text(options, "distance", "cell") == RAYMAP_OK);
  CHECK(raymap_options_set_text(options, "sign", "rays") == RAYMAP_OK);
  CHECK(raymap_options_set_text(options, "sampling", "paper") == RAYMAP_OK);
  CHECK(raymap_options_set_text(options, "orientation", "keep") == RAYMAP_OK);
  static const char* const numbers[] = {"passes",       "threshold",    "band",      "thickness",
                                        "threads",      "memory_limit", "invert",    "close_holes",
                                        "triangle_ids", "winding",      "confidence"};
  for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; ++i)
    CHECK(raymap_options_set_number(options, numbers[i], 1) == RAYMAP_OK);
  CHECK_FAILS(raymap_options_set_text(options, "distance", "nearest"), RAYMAP_ERROR_USAGE, "neighbours");
  CHECK_FAILS(raymap_options_set_text(options, "colour", "red"), RAYMAP_ERROR_USAGE, "orientation");
  CHECK_FAILS(raymap_options_set_number(options, "threads", 1.5), RAYMAP_ERROR_USAGE, "whole");
  CHECK_FAILS(raymap_options_set_number(options, "threads", -1), RAYMAP_ERROR_USAGE, "whole");
  CHECK_FAILS(raymap_options_set_number(options, "invert", 2), RAYMAP_ERROR_USAGE, "0 to 1");
  CHECK_FAILS(raymap_options_set_number(options, "speed", 2), RAYMAP_ERROR_USAGE, "threshold");
  CHECK_FAILS(raymap_options_set_text(options, "sampling", "best"), RAYMAP_ERROR_USAGE, "raymap or paper");
  CHECK_FAILS(raymap_options_set_offsets(options, NULL, 1), RAYMAP_ERROR_USAGE, "offsets");
  CHECK(raymap_options_set_offsets(options, NULL, 0) == RAYMAP_OK);
  raymap_options_free(options);
}

/* Returns the sum of the winding numbers of the tetrahedron without its last face, over a small grid. */
static double sum_of_winding(const raymap_options* options) {
  raymap_mesh_arrays arrays = {
      .vertices = kVertices, .vertex_count = 4, .triangles = kTriangles, .triangle_count = 3};
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  const raymap_grid grid = {{6, 5, 4}, {-0.9, -0.8, -0.7}, 0.4};
  raymap_field* field = raymap_generate(mesh, &grid, options);
  CHECK(field != NULL && raymap_field_winding(field) != NULL);
  double sum = 0.0;
  for (size_t s = 0; s < sample_count(&grid); ++s) sum += raymap_field_winding(field)[s];
  raymap_field_free(field);
  raymap_mesh_free(mesh);
  return sum;
}

static void test_signless(void) {
  static const char* const arrays[] = {"winding", "confidence"};
  const raymap_grid grid = {{6, 5, 4}, {-0.9, -0.8, -0.7}, 0.4};
  raymap_mesh* mesh = make_tetrahedron();
  for (int i = 0; i < 2; ++i) {
    raymap_options* options = on_cpu();
    CHECK(raymap_options_set_text(options, "sign", "none") == RAYMAP_OK);
    CHECK(raymap_options_set_number(options, arrays[i], 1) == RAYMAP_OK);
    CHECK(raymap_generate(mesh, &grid, options) == NULL);
    CHECK(raymap_last_error() == RAYMAP_ERROR_USAGE);
    CHECK(strstr(raymap_last_error_message(), "need a sign") != NULL);
    raymap_options_free(options);
  }
  raymap_mesh_free(mesh);
}

static void test_offsets(void) {
  raymap_options* options = on_cpu();
  CHECK(raymap_options_set_number(options, "winding", 1) == RAYMAP_OK);
  CHECK(raymap_options_set_text(options, "orientation", "keep") == RAYMAP_OK);
  CHECK(raymap_options_set_text(options, "sign", "rays") == RAYMAP_OK);
  const double rays = sum_of_winding(options);
  CHECK(raymap_options_set_text(options, "sign", "paths") == RAYMAP_OK);
  const double built_in = sum_of_winding(options);
  CHECK(fabs(built_in - rays) > 1e-3);
  const int32_t zero[6] = {0, 0, 0, 0, 0, 0};
  CHECK(raymap_options_set_offsets(options, zero, 2) == RAYMAP_OK);
  CHECK(fabs(sum_of_winding(options) - rays) < 1e-3);
  const int32_t far_away[3] = {0, 9, 0};
  CHECK(raymap_options_set_offsets(options, far_away, 1) == RAYMAP_OK);
  CHECK(fabs(sum_of_winding(options) - rays) > 1e-3);
  CHECK(raymap_options_set_offsets(options, NULL, 0) == RAYMAP_OK);
  CHECK(sum_of_winding(options) == built_in);
  CHECK(raymap_options_set_text(options, "sampling", "paper") == RAYMAP_OK);
  CHECK(fabs(sum_of_winding(options) - built_in) > 1e-3);
  raymap_options_free(options);
}

struct calls {
  int progress, warnings;
  bool goes_on;
};

static bool on_progress(const char* stage, double done, void* user) {
  struct calls* calls = user;
  CHECK(strlen(stage) > 0 && done >= 0.0 && done <= 1.0);
  ++calls->progress;
  return calls->goes_on;
}

static void on_warning(const char* message, void* user) {
  struct calls* calls = user;
  CHECK(strlen(message) > 0);
  ++calls->warnings;
}

static void test_callbacks(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_grid grid = fit(mesh);
  raymap_options* options = on_cpu();
  struct calls calls = {0, 0, true};
  CHECK(raymap_options_set_progress(options, on_progress, &calls) == RAYMAP_OK);
  CHECK(raymap_options_set_warning(options, on_warning, &calls) == RAYMAP_OK);
  grid.dims[0] = 10; /* Now the solid reaches the box. */
  raymap_field* field = raymap_generate(mesh, &grid, options);
  CHECK(field != NULL && calls.progress > 0 && calls.warnings == 0);
  raymap_mesh* surface = raymap_isosurface(field, 0.0, options);
  CHECK(surface != NULL && calls.warnings == 1);
  calls.goes_on = false;
  CHECK_FAILS(raymap_generate(mesh, &grid, options), RAYMAP_ERROR_CANCELLED, "cancelled");
  raymap_generator* generator = raymap_generator_create();
  CHECK(raymap_generator_run(generator, mesh, &grid, options, field) == RAYMAP_ERROR_CANCELLED);
  CHECK(raymap_field_distance(field) == NULL);
  CHECK(raymap_options_set_progress(options, NULL, NULL) == RAYMAP_OK);
  CHECK(raymap_generator_run(generator, mesh, &grid, options, field) == RAYMAP_OK);
  raymap_generator_free(generator);
  raymap_mesh_free(surface);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* Single precision keeps half a unit of it. */
static void test_far_stl(const char* folder) {
  char path[4096];
  snprintf(path, sizeof path, "%s/c_api.stl", folder);
  raymap_mesh_arrays arrays = {0};
  arrays.vertices = kVertices;
  arrays.vertex_count = 4;
  arrays.triangles = kTriangles;
  arrays.triangle_count = 4;
  arrays.origin[0] = 5000000.2;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  raymap_options* options = raymap_options_create();
  struct calls calls = {0, 0, true};
  CHECK(raymap_options_set_warning(options, on_warning, &calls) == RAYMAP_OK);
  CHECK(raymap_mesh_write(mesh, path, options) == RAYMAP_OK && calls.warnings == 1);
  CHECK(raymap_mesh_write(mesh, path, NULL) == RAYMAP_OK && calls.warnings == 1);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_files(const char* folder) {
  char path[4096];
  raymap_mesh* mesh = make_tetrahedron();
  const raymap_grid grid = fit(mesh);
  snprintf(path, sizeof path, "%s/c_api.ply", folder);
  CHECK(raymap_mesh_write(mesh, path, NULL) == RAYMAP_OK);
  raymap_mesh* read = raymap_mesh_load(path, NULL);
  CHECK(raymap_mesh_triangle_count(read) == 4);
  test_far_stl(folder);
  raymap_field* field = raymap_generate(read, &grid, NULL);
  CHECK(field != NULL);
  snprintf(path, sizeof path, "%s/c_api.nrrd", folder);
  CHECK(raymap_field_write(field, path, NULL) == RAYMAP_OK);
  raymap_field* again = raymap_field_load(path);
  CHECK(again != NULL);
  CHECK(memcmp(raymap_field_distance(again), raymap_field_distance(field),
               sample_count(&grid) * sizeof(float)) == 0);
  CHECK_FAILS(raymap_field_write(field, path, "winding"), RAYMAP_ERROR_USAGE, "winding");
  CHECK_FAILS(raymap_mesh_load("/no/such/mesh.obj", NULL), RAYMAP_ERROR_FILE, "/no/such/mesh.obj");
  raymap_field_free(again);
  raymap_field_free(field);
  raymap_mesh_free(read);
  raymap_mesh_free(mesh);
}

static void test_devices(void) {
  raymap_devices* devices = raymap_devices_list();
  raymap_device device;
  int automatic = 0;
  CHECK(raymap_devices_count(devices) >= 1);
  CHECK(raymap_devices_get(devices, 0, &device) == RAYMAP_OK);
  CHECK(strcmp(device.id, "cpu") == 0 && strcmp(device.type, "cpu") == 0 && device.problem[0] == 0);
  for (size_t i = 0; i < raymap_devices_count(devices); ++i) {
    CHECK(raymap_devices_get(devices, i, &device) == RAYMAP_OK);
    automatic += device.is_automatic;
  }
  CHECK(automatic == 1);
  CHECK_FAILS(raymap_devices_get(devices, 1000, &device), RAYMAP_ERROR_USAGE, "1000");
  CHECK_FAILS(raymap_devices_test("cpu"), RAYMAP_ERROR_USAGE, "cpu");
  CHECK_FAILS(raymap_devices_test("vulkan:1000"), RAYMAP_ERROR_UNSUPPORTED, "vulkan:1000");
  raymap_devices_free(devices);
}

/* NULL does no harm anywhere. */
static void test_null(void) {
  raymap_grid grid = {{1, 1, 1}, {0, 0, 0}, 1};
  raymap_mesh* mesh = make_tetrahedron();
  raymap_field* field = raymap_field_create();
  double low[3];
  raymap_device device;
  raymap_stats stats;
  raymap_mesh_arrays arrays = {0};
  raymap_query_arrays results = {0};
  const raymap_result usage = RAYMAP_ERROR_USAGE;
  raymap_options_free(NULL);
  raymap_mesh_free(NULL);
  raymap_field_free(NULL);
  raymap_generator_free(NULL);
  raymap_surface_free(NULL);
  raymap_devices_free(NULL);
  CHECK(raymap_options_set_text(NULL, "device", "cpu") == usage);
  CHECK(raymap_options_set_number(NULL, "band", 1) == usage);
  CHECK(raymap_options_set_progress(NULL, NULL, NULL) == usage);
  CHECK(raymap_options_set_warning(NULL, NULL, NULL) == usage);
  CHECK(raymap_mesh_load(NULL, NULL) == NULL && raymap_mesh_from_arrays(NULL) == NULL);
  arrays.vertex_count = 3;
  CHECK_FAILS(raymap_mesh_from_arrays(&arrays), usage, "vertices is NULL");
  CHECK(raymap_mesh_vertex_count(NULL) == 0 && raymap_mesh_triangle_count(NULL) == 0);
  CHECK(raymap_mesh_copy_positions(NULL, low) == usage && raymap_mesh_copy_positions(mesh, NULL) == usage);
  CHECK(raymap_mesh_copy_triangles(NULL, NULL) == usage && raymap_mesh_copy_triangles(mesh, NULL) == usage);
  CHECK(raymap_mesh_bounds(NULL, low, low) == usage && raymap_mesh_bounds(mesh, NULL, low) == usage);
  CHECK(raymap_mesh_write(NULL, "a.ply", NULL) == usage && raymap_mesh_write(mesh, NULL, NULL) == usage);
  CHECK(raymap_fit_grid(NULL, NULL, &grid) == usage && raymap_fit_grid(mesh, NULL, NULL) == usage);
  CHECK(raymap_generate(NULL, &grid, NULL) == NULL && raymap_generate(mesh, NULL, NULL) == NULL);
  CHECK(raymap_generator_run(NULL, mesh, &grid, NULL, field) == usage);
  CHECK(raymap_field_grid(NULL, &grid) == usage && raymap_field_grid(field, NULL) == usage);
  CHECK(raymap_field_distance(NULL) == NULL && raymap_field_triangle(NULL) == NULL);
  CHECK(raymap_field_winding(NULL) == NULL && raymap_field_confidence(NULL) == NULL);
  CHECK(raymap_field_band(NULL) == 0.0 && raymap_field_device(NULL)[0] == 0);
  CHECK(raymap_field_stats(NULL, &stats) == usage && raymap_field_stats(field, NULL) == usage);
  CHECK(raymap_field_sample(NULL, low, 1, RAYMAP_OUTSIDE_BOUND, NULL, NULL) == usage);
  CHECK_FAILS(raymap_field_sample(field, low, 1, RAYMAP_OUTSIDE_BOUND, NULL, NULL), usage, "the field is empty");
  CHECK(raymap_isosurface(NULL, 0.0, NULL) == NULL);
  CHECK(raymap_surface_create(NULL, NULL) == NULL && raymap_surface_bytes(NULL) == 0);
  CHECK(raymap_surface_stats(NULL, &stats) == usage);
  CHECK(raymap_surface_query(NULL, low, 1, 0.0, NULL, &results) == usage);
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  CHECK(raymap_surface_stats(surface, NULL) == usage);
  CHECK(raymap_surface_query(surface, NULL, 1, 0.0, NULL, &results) == usage);
  CHECK(raymap_surface_query(surface, low, 1, 0.0, NULL, NULL) == usage);
  CHECK(raymap_sample_points(surface, 1, NULL, NULL, NULL) == usage);
  raymap_surface_free(surface);
  CHECK(raymap_field_load(NULL) == NULL);
  CHECK(raymap_field_write(NULL, "a.nrrd", NULL) == usage && raymap_field_write(field, NULL, NULL) == usage);
  CHECK(raymap_devices_count(NULL) == 0 && raymap_devices_get(NULL, 0, &device) == usage);
  grid.origin[1] = NAN;
  CHECK_FAILS(raymap_generate(mesh, &grid, NULL), usage, "the grid's origin has y = nan");
  raymap_field_free(field);
  raymap_mesh_free(mesh);
}

int main(int argc, char** argv) {
  CHECK(raymap_last_error() == RAYMAP_OK && raymap_last_error_message()[0] == 0);
  CHECK(raymap_version()[0] == '0' + RAYMAP_VERSION_MAJOR);
  test_meshes();
  test_other_arrays();
  test_field();
  test_surface();
  test_threads();
  test_options();
  test_signless();
  test_offsets();
  test_callbacks();
  test_files(argc > 1 ? argv[1] : ".");
  test_devices();
  test_null();
  printf("all passed\n");
  return 0;
}
