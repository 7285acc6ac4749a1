/* Uses raymap/c.h from C11: every function, its results and its errors. Takes a folder to write to. */

#include <raymap/c.h>

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stddef.h>
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
  raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
  arrays.vertices = kVertices;
  arrays.vertex_count = 4;
  arrays.triangles = kTriangles;
  arrays.triangle_count = 4;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  CHECK(mesh != NULL);
  return mesh;
}

static raymap_options* with(const char* json) {
  raymap_options* options = raymap_options_create();
  CHECK(options != NULL);
  CHECK(raymap_options_set_json(options, json) == RAYMAP_OK);
  return options;
}

/* Returns a number of a report. */
static double number_in(const char* json, const char* keys) {
  double number = -1.0;
  CHECK(raymap_json_number(json, keys, &number) == RAYMAP_OK);
  return number;
}

static raymap_grid fit(const raymap_mesh* mesh) {
  raymap_options* options = with("{\"resolution\": 21}");
  raymap_grid grid;
  CHECK(raymap_fit_grid(mesh, options, &grid) == RAYMAP_OK);
  CHECK(grid.dims[0] == 21 && grid.spacing > 0.0);
  raymap_options_free(options);
  return grid;
}

/* The side of the tetrahedron's bounds is 2 long. */
static void test_grid_options(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_options* options = raymap_options_create();
  raymap_grid grid;
  CHECK(raymap_fit_grid(mesh, NULL, &grid) == RAYMAP_OK && grid.dims[0] == 128);
  CHECK(fabs(grid.spacing * 128 - 2.4) < 1e-9);
  const double box[6] = {0, 3, 0, 1, 7, 1};
  CHECK(raymap_options_set_json(options, "{\"padding\": 0, \"voxel_size\": 0.5}") == RAYMAP_OK);
  CHECK(raymap_options_set_numbers(options, "bounds", box, 6) == RAYMAP_OK);
  CHECK(raymap_fit_grid(mesh, options, &grid) == RAYMAP_OK && grid.dims[1] == 8 && grid.spacing == 0.5);
  CHECK(fabs(grid.origin[1] - 3.25) < 1e-9);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
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
  double positions[12], min[3], max[3];
  uint32_t indices[12];
  CHECK(raymap_mesh_vertex_count(mesh) == 4 && raymap_mesh_triangle_count(mesh) == 4);
  CHECK(raymap_mesh_copy_positions(mesh, positions) == RAYMAP_OK);
  CHECK(positions[3] == 1.0 && positions[4] == -1.0);
  CHECK(raymap_mesh_copy_triangles(mesh, indices) == RAYMAP_OK);
  CHECK(memcmp(indices, kTriangles, sizeof indices) == 0);
  CHECK(raymap_mesh_bounds(mesh, min, max) == RAYMAP_OK);
  CHECK(min[0] == -1.0 && max[2] == 1.0);
  raymap_mesh_free(mesh);
}

/* Doubles with a gap, 64-bit indices and an origin. */
static void test_other_arrays(void) {
  double vertices[4][4];
  uint64_t triangles[4][3];
  double min[3], max[3];
  raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
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
  CHECK(raymap_mesh_bounds(mesh, min, max) == RAYMAP_OK);
  CHECK(min[1] == 99.0 && max[1] == 101.0);
  triangles[2][1] = UINT64_C(5000000000);
  CHECK_FAILS(raymap_mesh_bounds(mesh, min, max), RAYMAP_ERROR_INPUT, "triangle 2 uses vertex 5000000000");
  raymap_mesh_free(mesh);
}

static void test_field(void) {
  raymap_mesh* mesh = make_tetrahedron();
  const raymap_grid grid = fit(mesh);
  raymap_options* options = on_cpu();
  CHECK(raymap_options_set_number(options, "winding", 1) == RAYMAP_OK);
  CHECK(raymap_options_set_number(options, "triangle", 1) == RAYMAP_OK);
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
  CHECK(raymap_field_clamp_distance(field) == 0.0);
  CHECK(!raymap_field_is_narrow(field) && raymap_field_leaf_count(field) == 0 && raymap_field_tile_count(field) == 0);
  CHECK(raymap_field_leaves(field) == NULL && raymap_field_tiles(field) == NULL);
  char* stats = raymap_field_json(field);
  CHECK(strstr(stats, "\"device\": \"cpu\"") != NULL && strstr(stats, "\"active\"") == NULL);
  CHECK(number_in(stats, "bytes") > (double)(sample_count(&grid) * sizeof(float)));
  CHECK(number_in(stats, "milliseconds") > 0.0 && number_in(stats, "stages.0.milliseconds") >= 0.0);
  CHECK(number_in(stats, "doubtful_share") == 0.0 && number_in(stats, "turned_faces") == 0.0);
  CHECK(number_in(stats, "orientation_fits") == 1.0);
  CHECK_FAILS(raymap_json_number(stats, "device", &(double){0}), RAYMAP_ERROR_USAGE, "no number 'device'");
  CHECK_FAILS(raymap_json_number(stats, "stages.99", &(double){0}), RAYMAP_ERROR_USAGE, "no number 'stages.99'");
  CHECK_FAILS(raymap_json_number("{", "a", &(double){0}), RAYMAP_ERROR_USAGE, "no JSON");
  CHECK(isnan(number_in("{\"a\": null}", "a")));
  raymap_text_free(stats);

  /* Positions and the numbers of a sample agree. */
  const double points[2][3] = {{grid.origin[0], grid.origin[1], grid.origin[2]}, {0, 0, 0}};
  float distances[2], gradients[2][3];
  CHECK(raymap_field_sample(field, &points[0][0], 2, RAYMAP_OUTSIDE_BOUND, distances, &gradients[0][0]) ==
        RAYMAP_OK);
  CHECK(fabsf(distances[0] - distance[0]) < 1e-5f && distances[1] < 0.0f);
  CHECK(gradients[0][0] < 0.0f);
  CHECK(raymap_field_sample(field, NULL, 0, RAYMAP_OUTSIDE_BOUND, NULL, NULL) == RAYMAP_OK);
  const double beyond[3] = {0, 0, 100}; /* The tetrahedron reaches to 1. */
  CHECK(raymap_field_sample(field, beyond, 1, RAYMAP_OUTSIDE_BOUND, distances, NULL) == RAYMAP_OK);
  CHECK(distances[0] >= 99.0f && distances[0] < 100.0f);
  CHECK(raymap_field_sample(field, beyond, 1, RAYMAP_OUTSIDE_NAN, distances, &gradients[0][0]) == RAYMAP_OK);
  CHECK(isnan(distances[0]) && isnan(gradients[0][2]));
  CHECK_FAILS(raymap_field_sample(field, beyond, 1, (raymap_outside)2, distances, NULL), RAYMAP_ERROR_USAGE,
              "there is no raymap_outside 2");

  /* The same through a generator, into a field that is reused. */
  raymap_generator* generator = raymap_generator_create();
  raymap_field* other = raymap_field_create();
  CHECK(raymap_field_distance(other) == NULL);
  for (int run = 0; run < 2; ++run)
    CHECK(raymap_generator_run(generator, mesh, &grid, options, other) == RAYMAP_OK);
  CHECK(memcmp(raymap_field_distance(other), distance, sample_count(&grid) * sizeof(float)) == 0);

  raymap_mesh* surface = raymap_isosurface(field, NULL);
  CHECK(raymap_mesh_triangle_count(surface) > 100);
  CHECK(raymap_options_set_number(options, "iso", -50.0) == RAYMAP_OK);
  CHECK_FAILS(raymap_isosurface(field, options), RAYMAP_ERROR_USAGE, "no surface at -50");

  raymap_mesh_free(surface);
  raymap_field_free(other);
  raymap_generator_free(generator);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* The surface is that of the tetrahedron. */
static void check_sample_points(const raymap_surface* surface) {
  enum { COUNT = 40 };
  double points[COUNT][3], distance[COUNT], gradient[COUNT][3], queried[COUNT];
  double centre[3] = {9, 9, 9}, scale = 0;
  raymap_options* how = with("{\"surface_share\": 0.25, \"near_share\": 0.5, \"sigmas\": [0.1]}");
  raymap_point_sample_arrays arrays = {sizeof(arrays), &points[0][0], distance, &gradient[0][0], centre, &scale};
  CHECK(raymap_sample_points(surface, COUNT, how, &arrays) == RAYMAP_OK);
  CHECK(scale == 1.0 && centre[0] == 0.0 && centre[2] == 0.0);
  raymap_query_arrays asked = RAYMAP_INIT(raymap_query_arrays);
  asked.distance = queried;
  CHECK(raymap_surface_query(surface, &points[0][0], COUNT, NULL, &asked) == RAYMAP_OK);
  for (int i = 0; i < COUNT; ++i) {
    CHECK(i < COUNT / 4 ? distance[i] == 0.0 && fabs(queried[i]) < 1e-6 : distance[i] == queried[i]);
    const double* g = gradient[i];
    CHECK(fabs(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] - 1.0) < 1e-9);
  }
  CHECK(raymap_options_set_number(how, "near_share", 2.0) == RAYMAP_OK);
  CHECK_FAILS(raymap_sample_points(surface, COUNT, how, &arrays), RAYMAP_ERROR_USAGE,
              "near must be a share from 0 to 1, not 2");
  arrays.distance = arrays.gradient = arrays.centre = arrays.scale = NULL;
  CHECK(raymap_sample_points(surface, COUNT, NULL, &arrays) == RAYMAP_OK);
  raymap_options_free(how);
  arrays.size = 0;
  CHECK_FAILS(raymap_sample_points(surface, 1, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "the size of a raymap_point_sample_arrays is 0");
}

static void test_surface(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_options* options = raymap_options_create();
  raymap_surface* surface = raymap_surface_create(mesh, options);
  raymap_mesh_free(mesh);
  CHECK(surface != NULL && raymap_surface_bytes(surface) > 1000);
  char* stats = raymap_surface_json(surface);
  CHECK(number_in(stats, "turned_faces") == 0.0 && number_in(stats, "milliseconds") > 0.0);
  raymap_text_free(stats);

  const double points[4][3] = {{0, 0, 0}, {2, 2, 2}, {NAN, 0, 0}, {0, 0, 20}};
  double distance[4], closest[4][3], barycentric[4][3], direction[4][3];
  uint32_t triangle[4];
  float winding[4], confidence[4];
  raymap_query_arrays arrays = RAYMAP_INIT(raymap_query_arrays);
  arrays.distance = distance;
  arrays.closest = &closest[0][0];
  arrays.triangle = triangle;
  arrays.barycentric = &barycentric[0][0];
  arrays.direction = &direction[0][0];
  arrays.winding = winding;
  arrays.confidence = confidence;
  CHECK(raymap_options_set_number(options, "max_distance", 10.0) == RAYMAP_OK);
  CHECK(raymap_surface_query(surface, &points[0][0], 4, options, &arrays) == RAYMAP_OK);
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
  CHECK(raymap_surface_query(surface, &points[3][0], 1, NULL, &arrays) == RAYMAP_OK);
  CHECK(distance[0] > 18.0);
  CHECK(raymap_surface_query(surface, NULL, 0, NULL, &arrays) == RAYMAP_OK);
  CHECK_FAILS(raymap_options_set_number(options, "max_distance", -1.0), RAYMAP_ERROR_USAGE,
              "max_distance must be above 0, not -1");
  check_sample_points(surface);
  raymap_surface_free(surface);

  mesh = make_tetrahedron();
  CHECK(raymap_options_set_text(options, "sign", "none") == RAYMAP_OK);
  surface = raymap_surface_create(mesh, options);
  CHECK_FAILS(raymap_surface_query(surface, &points[0][0], 1, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "made without a sign");
  arrays.winding = arrays.confidence = NULL;
  CHECK(raymap_surface_query(surface, &points[0][0], 1, NULL, &arrays) == RAYMAP_OK &&
        distance[0] > 0.5);
  raymap_surface_free(surface);
  CHECK(raymap_options_set_text(options, "sign", "rays") == RAYMAP_OK);
  CHECK_FAILS(raymap_surface_create(mesh, options), RAYMAP_ERROR_USAGE, "cannot use the sign 'rays'");
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* The tetrahedron, and its field beside it: 20 farther along x. */
static void test_scene(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  raymap_options* options = on_cpu();
  raymap_grid grid;
  CHECK(raymap_options_set_number(options, "resolution", 24) == RAYMAP_OK);
  CHECK(raymap_fit_grid(mesh, options, &grid) == RAYMAP_OK);
  raymap_field* field = raymap_generate(mesh, &grid, options);
  raymap_field* band = raymap_field_to_narrow(field, NULL);
  const double beside[16] = {1, 0, 0, 20, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  const double turned[16] = {0, -1, 0, 40, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  raymap_scene* scene = raymap_scene_create();
  CHECK(raymap_scene_size(scene) == 0 && raymap_scene_size(NULL) == 0);
  CHECK(raymap_scene_add_surface(scene, "surface", surface, NULL) == RAYMAP_OK);
  CHECK(raymap_scene_add_field(scene, "field", field, beside) == RAYMAP_OK);
  CHECK(raymap_scene_add_field(scene, "band", band, turned) == RAYMAP_OK);
  uint32_t number = 0;
  CHECK(raymap_scene_number(scene, "band", &number) == RAYMAP_OK && number == 2);
  CHECK_FAILS(raymap_scene_number(scene, "arm", &number), RAYMAP_ERROR_USAGE, "no body 'arm'");
  CHECK_FAILS(raymap_scene_add_surface(scene, "band", surface, NULL), RAYMAP_ERROR_USAGE, "a body 'band'");
  CHECK_FAILS(raymap_scene_add_surface(scene, NULL, surface, NULL), RAYMAP_ERROR_USAGE, "the name is NULL");
  CHECK_FAILS(raymap_scene_add_field(scene, "x", NULL, NULL), RAYMAP_ERROR_USAGE, "the field is NULL");
  CHECK(raymap_scene_remove(scene, "band") == RAYMAP_OK && raymap_scene_size(scene) == 2);

  const double points[2][3] = {{2, 2, 2}, {22, 2, 2}};
  double distance[4], closest[4][3], gradient[4][3], distances[4][2];
  uint32_t body[4];
  raymap_scene_arrays arrays = RAYMAP_INIT(raymap_scene_arrays);
  arrays.distance = distance;
  arrays.body = body;
  arrays.closest = &closest[0][0];
  arrays.gradient = &gradient[0][0];
  arrays.distances = &distances[0][0];
  CHECK(raymap_scene_query(scene, &points[0][0], 2, NULL, options, &arrays) == RAYMAP_OK);
  CHECK(fabs(distance[0] - sqrt(3.0)) < 1e-6 && body[0] == 0 && body[1] == 1);
  CHECK(distances[0][0] == distance[0] && distances[0][1] > 10.0 && distances[1][1] == distance[1]);
  for (int a = 0; a < 3; ++a)
    CHECK(fabs(closest[0][a] - 1.0) < 1e-6 && fabs(gradient[0][a] - sqrt(1.0 / 3.0)) < 1e-6);

  const uint32_t without = 0;
  uint32_t triangle[2];
  arrays.triangle = triangle;
  arrays.without = &without;
  arrays.without_count = 1;
  CHECK(raymap_options_set_number(options, "max_distance", 25) == RAYMAP_OK);
  CHECK(raymap_scene_query(scene, &points[0][0], 2, NULL, options, &arrays) == RAYMAP_OK);
  CHECK(body[0] == 1 && body[1] == 1 && isnan(distances[0][0]) && triangle[1] == UINT32_MAX);
  arrays.without = NULL;
  CHECK_FAILS(raymap_scene_query(scene, &points[0][0], 2, NULL, options, &arrays), RAYMAP_ERROR_USAGE,
              "the array of bodies to leave out is NULL");
  CHECK(raymap_options_set_number(options, "max_distance", 0.5) == RAYMAP_OK);
  arrays.without_count = 0;
  CHECK(raymap_scene_query(scene, &points[0][0], 2, NULL, options, &arrays) == RAYMAP_OK);
  CHECK(body[0] == UINT32_MAX && distances[1][0] == 0.5);
  CHECK(raymap_scene_query(scene, &points[0][0], 2, NULL, NULL, &arrays) == RAYMAP_OK);
  CHECK(body[0] == 0 && triangle[0] < 4 && triangle[1] == UINT32_MAX);
  CHECK(raymap_options_set_number(options, "max_distance", INFINITY) == RAYMAP_OK);

  double poses[2][2][16]; /* In the first configuration, both change places. */
  memcpy(poses[0][0], beside, sizeof beside);
  CHECK(raymap_scene_set_pose(scene, "field", beside) == RAYMAP_OK);
  memcpy(poses[1][1], beside, sizeof beside);
  for (int k = 0; k < 16; ++k) poses[0][1][k] = poses[1][0][k] = k % 5 == 0;
  const uint32_t pairs[2] = {0, 2};
  CHECK(raymap_scene_add_surface(scene, "other", surface, beside) == RAYMAP_OK);
  raymap_surface_pair apart, same;
  CHECK(raymap_scene_distances(scene, pairs, 1, NULL, options, &apart) == RAYMAP_OK);
  CHECK(raymap_surface_distance(surface, surface, beside, options, &same) == RAYMAP_OK);
  CHECK(memcmp(&apart, &same, sizeof same) == 0 && apart.bound == apart.distance);
  CHECK(fabs(apart.other_point[0] - apart.point[0] - apart.distance) < 1e-9 && apart.triangle < 4);
  CHECK(raymap_surface_hausdorff(surface, surface, beside, 0.0, true, options, &same) == RAYMAP_OK);
  CHECK(same.distance > apart.distance && same.bound >= same.distance && same.bound < 20.1);
  CHECK(raymap_surface_hausdorff(surface, surface, NULL, 0.0, false, NULL, &same) == RAYMAP_OK);
  CHECK(same.distance < 1e-9);
  CHECK_FAILS(raymap_surface_hausdorff(surface, NULL, NULL, 0.0, true, NULL, &same), RAYMAP_ERROR_USAGE,
              "the other surface is NULL");
  CHECK_FAILS(raymap_scene_distances(scene, NULL, 1, NULL, options, &apart), RAYMAP_ERROR_USAGE,
              "the array of pairs is NULL");
  CHECK(raymap_scene_remove(scene, "other") == RAYMAP_OK);
  raymap_field* ofScene = raymap_scene_generate(scene, &grid, options);
  raymap_field* bandOfScene = raymap_scene_generate_band(scene, &grid, options);
  CHECK(ofScene != NULL && bandOfScene != NULL && raymap_field_is_narrow(bandOfScene));
  const double at[3] = {grid.origin[0], grid.origin[1], grid.origin[2]};
  double there;
  raymap_scene_arrays one = RAYMAP_INIT(raymap_scene_arrays);
  one.distance = &there;
  CHECK(raymap_scene_query(scene, at, 1, NULL, options, &one) == RAYMAP_OK);
  CHECK(raymap_field_distance(ofScene)[0] == (float)there);
  CHECK(raymap_scene_generate(scene, NULL, options) == NULL);
  raymap_field_free(ofScene);
  raymap_field_free(bandOfScene);
  raymap_configurations both = RAYMAP_INIT(raymap_configurations);
  both.poses = &poses[0][0][0];
  both.count = 2;
  double found[4];
  arrays = RAYMAP_INIT(raymap_scene_arrays);
  arrays.distance = found;
  arrays.body = body;
  CHECK(raymap_scene_query(scene, &points[0][0], 2, &both, options, &arrays) == RAYMAP_OK);
  CHECK(body[0] == 1 && body[1] == 0 && body[2] == 0 && body[3] == 1);
  CHECK(found[2] == distance[0] && found[3] == distance[1]);
  both.has_own_points = true;
  CHECK(raymap_scene_query(scene, &points[0][0], 2, &both, options, &arrays) == RAYMAP_OK);
  CHECK(body[0] == 1 && body[1] == 1 && found[1] == distance[1]);
  poses[1][1][15] = 2.0;
  CHECK_FAILS(raymap_scene_query(scene, &points[0][0], 2, &both, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "the pose of body 'field' in configuration 1 is no scaled rigid motion");
  CHECK_FAILS(raymap_scene_set_pose(scene, "field", poses[1][1]), RAYMAP_ERROR_USAGE, "the last row");
  both.poses = NULL;
  CHECK_FAILS(raymap_scene_query(scene, &points[0][0], 2, &both, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "the array of poses is NULL");
  CHECK_FAILS(raymap_scene_query(NULL, &points[0][0], 2, NULL, NULL, &arrays), RAYMAP_ERROR_USAGE,
              "the scene is NULL");
  raymap_scene_free(scene);
  raymap_scene_free(NULL);
  raymap_field_free(band);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_surface_free(surface);
  raymap_mesh_free(mesh);
}

/* A narrow band in C, with the triangles: leaves, tiles, widths, and what is made of it. */
static void test_band(const char* folder) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_options* options = with("{\"device\": \"cpu\", \"resolution\": 96, \"triangle\": true}");
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  raymap_grid grid, same;
  CHECK(raymap_fit_grid(mesh, options, &grid) == RAYMAP_OK);
  raymap_field* band = raymap_surface_generate_band(surface, &grid, options);
  const size_t leaf_count = raymap_field_leaf_count(band);
  char* json = raymap_field_json(band);
  const double outside = number_in(json, "outside"), inside = number_in(json, "inside");
  CHECK(raymap_field_is_narrow(band) && outside == 3 * grid.spacing && inside == 3 * grid.spacing);
  CHECK(raymap_field_clamp_distance(band) == inside);
  CHECK(leaf_count > 100 && raymap_field_tile_count(band) > 0);
  CHECK(number_in(json, "bytes") > (double)(leaf_count * 512 * 8));
  CHECK(raymap_field_grid(band, &same) == RAYMAP_OK && same.dims[2] == grid.dims[2]);
  CHECK(same.spacing == grid.spacing && same.origin[1] == grid.origin[1]);
  CHECK(raymap_field_winding(band) == NULL && raymap_field_confidence(band) == NULL);

  const int32_t *leaves = raymap_field_leaves(band), *tiles = raymap_field_tiles(band);
  CHECK(leaves[0] % 8 == 0 && tiles[3] % 8 == 0 && raymap_field_triangle(band) != NULL);
  CHECK(number_in(json, "active") > 0.0);
  raymap_text_free(json);

  raymap_field* dense = raymap_field_to_dense(band, NULL);
  CHECK(!raymap_field_is_narrow(dense));
  const float* all = raymap_field_distance(dense);
  for (size_t l = 0; l < leaf_count; ++l) { /* The second sample along x of each leaf. */
    const size_t x = (size_t)leaves[3 * l] + 1, y = (size_t)leaves[3 * l + 1], z = (size_t)leaves[3 * l + 2];
    CHECK(all[(z * 96 + y) * 96 + x] == raymap_field_distance(band)[512 * l + 1]);
  }
  const double points[2][3] = {{0.33, 0.33, -0.33}, {9, 9, 9}};
  float values[2], gradients[2][3];
  CHECK(raymap_field_sample(band, &points[0][0], 2, RAYMAP_OUTSIDE_NAN, values, &gradients[0][0]) == RAYMAP_OK);
  CHECK(fabs(values[0]) < 0.01 && isnan(values[1]) && gradients[0][0] > 0.5f);
  CHECK_FAILS(raymap_field_sample(band, NULL, 2, RAYMAP_OUTSIDE_NAN, values, NULL), RAYMAP_ERROR_USAGE,
              "the array of points is NULL");
  CHECK_FAILS(raymap_field_to_dense(dense, NULL), RAYMAP_ERROR_USAGE, "the field is dense");
  CHECK_FAILS(raymap_field_to_narrow(band, NULL), RAYMAP_ERROR_USAGE, "the field is a narrow band");

  char path[4096];
  snprintf(path, sizeof path, "%s/c_api_band.nrrd", folder);
  CHECK_FAILS(raymap_field_write(band, path, NULL), RAYMAP_ERROR_USAGE, "holds no narrow bands");
  raymap_generator* generator = raymap_generator_create(); /* It makes a dense field of any. */
  grid = fit(mesh);
  CHECK(raymap_generator_run(generator, mesh, &grid, options, band) == RAYMAP_OK && !raymap_field_is_narrow(band));
  raymap_generator_free(generator);
  raymap_field_free(dense);
  raymap_field_free(band);
  raymap_surface_free(surface);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_region(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  raymap_options* options = on_cpu();
  const raymap_grid lattice = {{1000001, 1000001, 1000001}, {-2, -2, -2}, 4e-6};
  const int32_t low[3] = {500000, 500000, 500000}, extent[3] = {3, 2, 1}, none[3] = {3, 0, 1};
  CHECK(raymap_options_set_number(options, "winding", 1) == RAYMAP_OK);
  raymap_field* region = raymap_surface_generate_region(surface, &lattice, low, extent, options);
  raymap_grid grid;
  CHECK(raymap_field_grid(region, &grid) == RAYMAP_OK);
  CHECK(grid.dims[0] == 3 && grid.dims[1] == 2 && grid.dims[2] == 1 && fabs(grid.origin[0]) < 1e-12);
  CHECK(fabs(raymap_field_distance(region)[0] + sqrt(1.0 / 3.0)) < 1e-6);
  CHECK(raymap_field_winding(region)[5] == 1.0f && raymap_field_triangle(region) == NULL);
  raymap_field_free(region);
  CHECK(raymap_options_set_number(options, "band", 10) == RAYMAP_OK);

  size_t bytes = 0, fewer = 0;
  double far = 0.0;
  CHECK(raymap_surface_far_distance(surface, &lattice, low, extent, options, &far) == RAYMAP_OK);
  CHECK(fabs(far + 4e-5) < 1e-12);
  CHECK(raymap_surface_far_distance(surface, &lattice, low, extent, NULL, &far) == RAYMAP_OK && isnan(far));
  CHECK_FAILS(raymap_surface_far_distance(surface, &lattice, lattice.dims, extent, options, &far),
              RAYMAP_ERROR_USAGE, "region");
  CHECK(raymap_surface_region_bytes(surface, extent, options, &bytes) == RAYMAP_OK);
  CHECK(raymap_surface_region_bytes(surface, extent, NULL, &fewer) == RAYMAP_OK);
  CHECK(fewer > raymap_surface_bytes(surface) && bytes == fewer + 6 * sizeof(float));
  CHECK_FAILS(raymap_surface_region_bytes(surface, none, options, &bytes), RAYMAP_ERROR_USAGE,
              "a region needs a sample along y");
  CHECK_FAILS(raymap_surface_generate_region(surface, &lattice, lattice.dims, extent, options), RAYMAP_ERROR_USAGE,
              "but the lattice has 1000001");
  raymap_options_free(options);
  raymap_surface_free(surface);
  raymap_mesh_free(mesh);
}

static void test_memory(void) {
  const uint64_t most = (uint64_t)1 << 30;
  CHECK(raymap_memory_left() > 0);
  CHECK(raymap_limit_memory(most, 0) == RAYMAP_OK);
  CHECK(raymap_memory_left() > 0 && raymap_memory_left() < most);
  CHECK(raymap_limit_memory(1, 0) == RAYMAP_OK && raymap_memory_left() == 0);
  CHECK(raymap_limit_memory(0, 0) == RAYMAP_OK && raymap_memory_left() > 0);
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
  CHECK(raymap_options_set_text(options, "sampling", "paper") == RAYMAP_OK);
  CHECK(raymap_options_set_number(options, "threshold", 1) == RAYMAP_OK);
  CHECK_FAILS(raymap_options_set_text(options, "distance", "nearest"), RAYMAP_ERROR_USAGE, "neighbours");
  CHECK_FAILS(raymap_options_set_text(options, "colour", "red"), RAYMAP_ERROR_USAGE, "no option 'colour'");
  CHECK_FAILS(raymap_options_set_number(options, "speed", 2), RAYMAP_ERROR_USAGE, "no option 'speed'");
  CHECK_FAILS(raymap_options_set_number(options, "threads", 1.5), RAYMAP_ERROR_USAGE,
              "threads must be a whole number, not 1.5");
  CHECK_FAILS(raymap_options_set_numbers(options, "offsets", NULL, 3), RAYMAP_ERROR_USAGE, "values is NULL");
  CHECK(raymap_options_set_numbers(options, "offsets", NULL, 0) == RAYMAP_OK);
  CHECK(raymap_options_set_json(options, "{\"bounds\": [[0, 0, 0], [1, 1, 1]], \"seed\": 7, \"cut\": true}") == RAYMAP_OK);
  CHECK_FAILS(raymap_options_set_json(options, "[]"), RAYMAP_ERROR_USAGE, "no object");
  CHECK_FAILS(raymap_options_set_json(options, "{"), RAYMAP_ERROR_USAGE, "no JSON");
  CHECK_FAILS(raymap_options_set_json(options, "{\"down\": [0, \"x\", 1]}"), RAYMAP_ERROR_USAGE, "list of numbers");
  raymap_options_free(options);
}

struct calls {
  int progress, warnings;
  bool goes_on;
  char code[32]; /* Of the last warning. */
};

static bool on_progress(const char* stage, double done, void* user) {
  struct calls* calls = user;
  CHECK(strlen(stage) > 0 && done >= 0.0 && done <= 1.0);
  ++calls->progress;
  return calls->goes_on;
}

static void on_warning(const char* code, const char* message, void* user) {
  struct calls* calls = user;
  snprintf(calls->code, sizeof calls->code, "%s", code);
  CHECK(strlen(message) > 0);
  ++calls->warnings;
}

static void test_callbacks(void) {
  raymap_mesh* mesh = make_tetrahedron();
  raymap_grid grid = fit(mesh);
  raymap_options* options = on_cpu();
  struct calls calls = {0, 0, true, ""};
  CHECK(raymap_options_set_progress(options, on_progress, &calls) == RAYMAP_OK);
  CHECK(raymap_options_set_warning(options, on_warning, &calls) == RAYMAP_OK);
  grid.dims[0] = 10; /* Now the solid reaches the box. */
  raymap_field* field = raymap_generate(mesh, &grid, options);
  CHECK(field != NULL && calls.progress > 0 && calls.warnings == 0);
  raymap_mesh* surface = raymap_isosurface(field, options);
  CHECK(surface != NULL && calls.warnings == 1 && strcmp(calls.code, "box_reached") == 0);
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

/* Structs as a later version may have them. */
typedef struct {
  raymap_scene_arrays known;
  int32_t later[2];
} later_scene_arrays;

static void test_sizes(void) {
  raymap_scene* scene = raymap_scene_create();
  later_scene_arrays arrays = {{.size = sizeof arrays}, {0, 0}};
  CHECK(raymap_scene_query(scene, NULL, 0, NULL, NULL, &arrays.known) == RAYMAP_OK);
  arrays.later[1] = 1;
  CHECK_FAILS(raymap_scene_query(scene, NULL, 0, NULL, NULL, &arrays.known), RAYMAP_ERROR_USAGE,
              "of a raymap_scene_arrays is not 0");
  arrays.known.size = sizeof(raymap_scene_arrays);
  CHECK(raymap_scene_query(scene, NULL, 0, NULL, NULL, &arrays.known) == RAYMAP_OK);
  arrays.known.size = (size_t)-1;
  CHECK_FAILS(raymap_scene_query(scene, NULL, 0, NULL, NULL, &arrays.known), RAYMAP_ERROR_USAGE, "the size of a");
  raymap_scene_free(scene);

  const raymap_mesh_arrays mesh_arrays = {0};
  CHECK_FAILS(raymap_mesh_from_arrays(&mesh_arrays), RAYMAP_ERROR_USAGE, "RAYMAP_INIT(raymap_mesh_arrays)");
  raymap_mesh* mesh = make_tetrahedron();
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  const raymap_query_arrays results = {0};
  CHECK_FAILS(raymap_surface_query(surface, NULL, 0, NULL, &results), RAYMAP_ERROR_USAGE,
              "RAYMAP_INIT(raymap_query_arrays)");
  const raymap_thickness_arrays thickness = {0};
  CHECK_FAILS(raymap_surface_thickness(surface, NULL, NULL, 0, NULL, &thickness), RAYMAP_ERROR_USAGE,
              "RAYMAP_INIT(raymap_thickness_arrays)");
  raymap_surface_free(surface);
  raymap_mesh_free(mesh);
}

/* A box from (0, 0, 0) to (4, 2, 1), with all faces outwards. */
static const float kBox[8][3] = {{0, 0, 0}, {4, 0, 0}, {0, 2, 0}, {4, 2, 0}, {0, 0, 1}, {4, 0, 1}, {0, 2, 1}, {4, 2, 1}};
static const uint32_t kBoxFaces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};

static raymap_mesh* make_box(size_t faces) {
  raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
  arrays.vertices = kBox;
  arrays.vertex_count = 8;
  arrays.triangles = kBoxFaces;
  arrays.triangle_count = faces;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  CHECK(mesh != NULL);
  return mesh;
}

static void test_thickness(void) {
  raymap_mesh* mesh = make_box(12);
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  const double points[2][3] = {{2, 0.9, 1}, {2, 1.1, 0}}; /* On the top and on the bottom, 1 apart. */
  const uint32_t triangles[2] = {2, 1}, missing = 12;
  float diameter[2], inward[2][3];
  int32_t part[2];
  raymap_thickness_arrays arrays = RAYMAP_INIT(raymap_thickness_arrays);
  CHECK(raymap_surface_thickness(surface, &points[0][0], triangles, 2, NULL, &arrays) == RAYMAP_OK);
  arrays.diameter = diameter;
  arrays.part = part;
  arrays.inward = &inward[0][0];
  CHECK(raymap_surface_thickness(surface, &points[0][0], triangles, 2, NULL, &arrays) == RAYMAP_OK);
  CHECK(part[0] == RAYMAP_PART_WALL && part[1] == RAYMAP_PART_WALL);
  CHECK(fabsf(diameter[0] - 1.0f) < 1e-3f && fabsf(diameter[1] - 1.0f) < 1e-3f);
  CHECK(fabsf(inward[0][2] + 1.0f) < 1e-6f && fabsf(inward[1][2] - 1.0f) < 1e-6f && inward[1][0] == 0.0f);
  CHECK_FAILS(raymap_surface_thickness(surface, &points[0][0], &missing, 1, NULL, &arrays),
              RAYMAP_ERROR_USAGE, "12");
  raymap_surface_free(surface);
  raymap_mesh_free(mesh);
}

static void test_inspection(void) {
  raymap_mesh* mesh = make_box(12);
  char* json = raymap_inspect(mesh, NULL);
  CHECK(strstr(json, "\"kind\": \"clean_solid\"") != NULL && strstr(json, "\"remedy\": \"none\"") != NULL);
  CHECK(number_in(json, "watertight") == 1.0 && number_in(json, "signed_volume") == 8.0);
  CHECK(number_in(json, "bounds.1.0") == 4.0 && number_in(json, "self_intersections.pairs") == 0.0);
  CHECK(isnan(number_in(json, "verdict.thinnest")));
  raymap_text_free(json);
  raymap_text_free(NULL);

  struct calls calls = {.goes_on = false};
  raymap_options* options = raymap_options_create();
  CHECK(raymap_options_set_progress(options, on_progress, &calls) == RAYMAP_OK);
  CHECK(raymap_inspect(mesh, options) == NULL && raymap_last_error() == RAYMAP_ERROR_CANCELLED);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_repair(void) {
  raymap_mesh* mesh = make_box(10);
  raymap_grid grid;
  raymap_options* options = on_cpu();
  CHECK(raymap_fit_repair_grid(mesh, NULL, &grid) == RAYMAP_OK && grid.dims[0] == 256);
  CHECK(raymap_options_set_number(options, "resolution", 40) == RAYMAP_OK);
  CHECK(raymap_fit_repair_grid(mesh, options, &grid) == RAYMAP_OK && grid.dims[0] == 40);
  /* The hole alone is closed. */
  char* report = NULL;
  raymap_mesh* repaired = raymap_repair(mesh, &grid, options, &report);
  CHECK(raymap_mesh_triangle_count(repaired) == 12);
  CHECK(strstr(report, "\"depth\": \"mended\"") != NULL && number_in(report, "closed_holes") == 1.0);
  CHECK(number_in(report, "after.watertight") == 1.0 && number_in(report, "solids") == 1.0);
  CHECK(fabs(number_in(report, "after.signed_volume") - 8.0) < 1e-9);
  raymap_text_free(report);
  raymap_mesh_free(repaired);

  CHECK(raymap_options_set_text(options, "sign", "none") == RAYMAP_OK);
  CHECK(raymap_repair(mesh, &grid, options, NULL) == NULL && raymap_last_error() == RAYMAP_ERROR_USAGE);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_simplify(void) {
  raymap_mesh* box = make_box(12);
  const raymap_grid grid = fit(box);
  raymap_options* options = with("{\"device\": \"cpu\", \"tolerance\": 0.01, \"step\": 0.05}");
  raymap_field* field = raymap_generate(box, &grid, options);
  raymap_mesh* fine = raymap_isosurface(field, options);
  char* report = NULL;
  raymap_mesh* coarse = raymap_simplify(fine, options, &report);
  CHECK(raymap_mesh_triangle_count(coarse) >= 12);
  CHECK(raymap_mesh_triangle_count(coarse) < raymap_mesh_triangle_count(fine) / 4);
  CHECK(number_in(report, "triangles_after") == (double)raymap_mesh_triangle_count(coarse));
  raymap_text_free(report);
  raymap_mesh* open = make_box(10);
  CHECK(raymap_simplify(open, options, NULL) == NULL && raymap_last_error() == RAYMAP_ERROR_INPUT);
  CHECK_FAILS(raymap_options_set_number(options, "tolerance", -1.0), RAYMAP_ERROR_USAGE, "tolerance must be 0 or more");
  raymap_mesh_free(open);
  raymap_mesh_free(coarse);
  raymap_mesh_free(fine);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(box);
}

static int is_red(const uint8_t* pixel) {
  return pixel[0] > 150 && pixel[1] < 100 && pixel[2] < 100;
}

/* Returns whether a file holds a text. */
static int file_holds(const char* path, const char* text) {
  FILE* file = fopen(path, "rb");
  if (file == NULL) return 0;
  fseek(file, 0, SEEK_END);
  const size_t bytes = (size_t)ftell(file);
  char* content = calloc(bytes + 1, 1);
  rewind(file);
  const int found = fread(content, 1, bytes, file) == bytes && strstr(content, text) != NULL;
  free(content);
  fclose(file);
  return found;
}

static void test_pictures(const char* folder) {
  char path[4096];
  raymap_mesh* mesh = make_box(10);
  raymap_options* options = on_cpu();
  CHECK(raymap_options_set_json(options, "{\"width\": 90, \"height\": 60}") == RAYMAP_OK);
  raymap_picture* defects = raymap_render_defects(mesh, options);
  CHECK(raymap_picture_width(defects) == 90 && raymap_picture_height(defects) == 60);
  int red = 0;
  for (size_t p = 0; p < 90 * 60; ++p) red += is_red(raymap_picture_rgb(defects) + 3 * p);
  CHECK(red > 20); /* The edges of the hole. */
  snprintf(path, sizeof path, "%s/c_api.png", folder);
  CHECK(raymap_picture_write_png(defects, path) == RAYMAP_OK);
  FILE* file = fopen(path, "rb");
  char start[4];
  CHECK(file != NULL && fread(start, 1, 4, file) == 4 && memcmp(start + 1, "PNG", 3) == 0);
  fclose(file);
  CHECK_FAILS(raymap_picture_write_png(defects, "/no/such/folder/a.png"), RAYMAP_ERROR_FILE, "/no/such/folder");
  raymap_picture_free(defects);

  const raymap_grid grid = fit(mesh);
  raymap_field* field = raymap_generate(mesh, &grid, options);
  raymap_picture* drawn = raymap_render_field(field, options);
  CHECK(raymap_options_set_number(options, "cut", 1) == RAYMAP_OK);
  raymap_picture* cut = raymap_render_field(field, options);
  CHECK(memcmp(raymap_picture_rgb(drawn), raymap_picture_rgb(cut), 90 * 60 * 3) != 0);
  CHECK_FAILS(raymap_options_set_number(options, "width", -1), RAYMAP_ERROR_USAGE, "width must be 1 or more");
  raymap_picture_free(cut);
  raymap_picture_free(drawn);

  raymap_picture* slice = raymap_render_slice(field, 2, -1, NULL);
  CHECK(raymap_picture_width(slice) == 1024 && raymap_picture_height(slice) < 1024);
  raymap_picture_free(slice);
  CHECK_FAILS(raymap_render_slice(field, 3, -1, NULL), RAYMAP_ERROR_USAGE, "axis");
  CHECK_FAILS(raymap_options_set_text(options, "array", "colour"), RAYMAP_ERROR_USAGE, "confidence");
  raymap_options* winding = with("{\"array\": \"winding\"}");
  CHECK_FAILS(raymap_render_slice(field, 2, -1, winding), RAYMAP_ERROR_USAGE, "winding");

  snprintf(path, sizeof path, "%s/c_api.html", folder);
  CHECK(raymap_write_page(field, path, NULL, NULL, options) == RAYMAP_OK);
  CHECK(file_holds(path, "<h1>c_api</h1>") && !file_holds(path, "\"name\":\"Holes\""));
  CHECK(raymap_options_set_json(options, "{\"title\": \"a box\", \"max_size\": 5}") == RAYMAP_OK);
  CHECK(raymap_write_page(field, path, mesh, NULL, options) == RAYMAP_OK);
  CHECK(file_holds(path, "<h1>a box</h1>") && file_holds(path, "\"name\":\"Holes\"") && file_holds(path, "\"dims\":[5,"));
  CHECK(raymap_options_set_text(options, "other_title", "another box") == RAYMAP_OK);
  CHECK(raymap_write_page(field, path, mesh, field, options) == RAYMAP_OK);
  CHECK(file_holds(path, "<h1>a box and another box</h1>"));
  CHECK(raymap_options_set_number(options, "max_size", 1) == RAYMAP_OK);
  CHECK_FAILS(raymap_write_page(field, path, NULL, NULL, options), RAYMAP_ERROR_USAGE, "at least 2 samples");
  CHECK_FAILS(raymap_write_page(field, path, NULL, NULL, winding), RAYMAP_ERROR_USAGE, "winding");
  CHECK_FAILS(raymap_write_page(NULL, path, NULL, NULL, NULL), RAYMAP_ERROR_USAGE, "the field");
  raymap_options_free(winding);
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* Single precision keeps half a unit of it. */
static void test_far_stl(const char* folder) {
  char path[4096];
  snprintf(path, sizeof path, "%s/c_api.stl", folder);
  raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
  arrays.vertices = kVertices;
  arrays.vertex_count = 4;
  arrays.triangles = kTriangles;
  arrays.triangle_count = 4;
  arrays.origin[0] = 5000000.2;
  raymap_mesh* mesh = raymap_mesh_from_arrays(&arrays);
  raymap_options* options = raymap_options_create();
  struct calls calls = {0, 0, true, ""};
  CHECK(raymap_options_set_warning(options, on_warning, &calls) == RAYMAP_OK);
  CHECK(raymap_mesh_write(mesh, path, options) == RAYMAP_OK && calls.warnings == 1);
  CHECK(raymap_mesh_write(mesh, path, NULL) == RAYMAP_OK && calls.warnings == 1);
  CHECK(strcmp(calls.code, "rounding") == 0);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

/* An empty mesh is an error, and on request a field that is far everywhere. */
static void test_empty(const char* folder) {
  char path[4096];
  snprintf(path, sizeof path, "%s/empty.obj", folder);
  FILE* file = fopen(path, "w");
  CHECK(file != NULL && fputs("v 0 0 0\n", file) >= 0 && fclose(file) == 0);
  raymap_options* options = raymap_options_create();
  CHECK_FAILS(raymap_mesh_load(path, options), RAYMAP_ERROR_INPUT, "no triangles");
  CHECK(raymap_options_set_number(options, "allow_empty", 1) == RAYMAP_OK);
  raymap_mesh* mesh = raymap_mesh_load(path, options);
  CHECK(mesh != NULL && raymap_mesh_triangle_count(mesh) == 0);
  const raymap_grid grid = {{2, 3, 4}, {0, 0, 0}, 0.5};
  CHECK_FAILS(raymap_generate(mesh, &grid, NULL), RAYMAP_ERROR_INPUT, "allow empty meshes");
  raymap_field* field = raymap_generate(mesh, &grid, options);
  CHECK(field != NULL && raymap_field_distance(field)[23] == FLT_MAX);
  raymap_field_free(field);
  raymap_mesh_free(mesh);
  raymap_options_free(options);
}

static void count_warning(const char* code, const char* message, void* user) {
  CHECK(strcmp(code, "file_content") == 0 && strstr(message, "'heat'") != NULL);
  ++*(int*)user;
}

/* A file that holds more than a field is read with a warning. */
static void test_left_out(const char* folder) {
  char path[4096];
  snprintf(path, sizeof path, "%s/more.vti", folder);
  FILE* file = fopen(path, "w");
  CHECK(file != NULL &&
        fputs("<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 0 0 0\">"
              "<Piece Extent=\"0 1 0 0 0 0\"><PointData>"
              "<DataArray type=\"Float32\" Name=\"distance\" format=\"ascii\">1 2</DataArray>"
              "<DataArray type=\"Float32\" Name=\"heat\" format=\"ascii\">1 2</DataArray>"
              "</PointData></Piece></ImageData></VTKFile>",
              file) >= 0 &&
        fclose(file) == 0);
  int warnings = 0;
  raymap_options* options = raymap_options_create();
  CHECK(raymap_options_set_warning(options, count_warning, &warnings) == RAYMAP_OK);
  raymap_field* field = raymap_field_load(path, options);
  CHECK(field != NULL && raymap_field_distance(field)[1] == 2.0f && warnings == 1);
  raymap_field_free(field);
  raymap_options_free(options);
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
  test_empty(folder);
  test_left_out(folder);
  raymap_field* field = raymap_generate(read, &grid, NULL);
  CHECK(field != NULL);
  snprintf(path, sizeof path, "%s/c_api.nrrd", folder);
  CHECK(raymap_field_write(field, path, NULL) == RAYMAP_OK);
  raymap_field* again = raymap_field_load(path, NULL);
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

/* A field beyond the limit of memory becomes a file in slabs, with the values of the field in memory. */
static void test_generate_file(const char* folder) {
  char path[4096], winding[4096];
  snprintf(path, sizeof path, "%s/c_api_slabs.nrrd", folder);
  snprintf(winding, sizeof winding, "%s/c_api_winding.nrrd", folder);
  raymap_mesh* mesh = make_tetrahedron();
  raymap_options* options = with(
      "{\"device\": \"cpu\", \"threads\": 1, \"band\": 3, \"resolution\": 160, \"memory_limit\": 15728640}");
  raymap_grid grid;
  CHECK(raymap_fit_grid(mesh, options, &grid) == RAYMAP_OK);
  raymap_field_files files = RAYMAP_INIT(raymap_field_files);
  CHECK_FAILS(raymap_generate_file(mesh, &grid, &files, options, NULL), RAYMAP_ERROR_USAGE,
              "the path of the distance is NULL");
  files.distance = path;
  char* report = NULL;
  CHECK(raymap_generate_file(mesh, &grid, &files, options, &report) == RAYMAP_OK);
  CHECK(strstr(report, "\"form\": \"slabs\"") != NULL && number_in(report, "plan.planes") < 160.0);
  CHECK(number_in(report, "stats.bytes") < 15728640.0);
  raymap_text_free(report);
  files.winding = winding;
  files.grid_name = "name";
  CHECK_FAILS(raymap_generate_file(mesh, &grid, &files, options, NULL), RAYMAP_ERROR_USAGE, "has a grid's name");
  files.grid_name = NULL;
  grid = fit(mesh);
  CHECK(raymap_generate_file(mesh, &grid, &files, NULL, &report) == RAYMAP_OK);
  CHECK(strstr(report, "\"form\": \"whole\"") != NULL);
  raymap_text_free(report);
  raymap_field* field = raymap_field_load(winding, NULL);
  CHECK(field != NULL && raymap_field_winding(field) != NULL);
  CHECK_FAILS(raymap_generate_file(NULL, &grid, &files, NULL, NULL), RAYMAP_ERROR_USAGE, "the mesh is NULL");
  CHECK_FAILS(raymap_generate_file(mesh, NULL, &files, NULL, NULL), RAYMAP_ERROR_USAGE, "the grid is NULL");
  CHECK_FAILS(raymap_generate_file(mesh, &grid, NULL, NULL, NULL), RAYMAP_ERROR_USAGE, "raymap_field_files is NULL");
  raymap_field_free(field);
  raymap_options_free(options);
  raymap_mesh_free(mesh);
}

static void test_devices(void) {
  char* devices = raymap_devices_json();
  CHECK(strstr(devices, "\"id\": \"cpu\"") != NULL && number_in(devices, "0.threads") >= 1.0);
  int automatic = 0;
  for (const char* at = devices; (at = strstr(at, "\"chosen_by_auto\": true")) != NULL; ++at) ++automatic;
  CHECK(automatic == 1);
  raymap_text_free(devices);
  CHECK_FAILS(raymap_devices_test("cpu"), RAYMAP_ERROR_USAGE, "cpu");
  CHECK_FAILS(raymap_devices_test("vulkan:1000"), RAYMAP_ERROR_UNSUPPORTED, "vulkan:1000");
}

/* NULL does no harm to bands and regions. */
static void test_null_of_bands(const raymap_surface* surface, const raymap_grid* grid) {
  const raymap_result usage = RAYMAP_ERROR_USAGE;
  const int32_t whole[3] = {1, 1, 1};
  size_t bytes;
  CHECK(raymap_surface_generate_band(NULL, grid, NULL) == NULL);
  CHECK_FAILS(raymap_surface_generate_band(surface, NULL, NULL), usage, "the grid is NULL");
  CHECK(raymap_surface_generate_region(NULL, grid, whole, whole, NULL) == NULL);
  CHECK_FAILS(raymap_surface_generate_region(surface, NULL, whole, whole, NULL), usage, "lattice is NULL");
  CHECK_FAILS(raymap_surface_generate_region(surface, grid, NULL, whole, NULL), usage, "sample of the region is NULL");
  CHECK_FAILS(raymap_surface_generate_region(surface, grid, whole, NULL, NULL), usage, "extent of the region is NULL");
  double far = 0.0;
  CHECK(raymap_surface_far_distance(NULL, grid, whole, whole, NULL, &far) == usage);
  CHECK(raymap_surface_far_distance(surface, NULL, whole, whole, NULL, &far) == usage);
  CHECK(raymap_surface_far_distance(surface, grid, whole, whole, NULL, NULL) == usage);
  CHECK(raymap_surface_region_bytes(NULL, whole, NULL, &bytes) == usage);
  CHECK(raymap_surface_region_bytes(surface, whole, NULL, NULL) == usage);
  CHECK(raymap_field_to_narrow(NULL, NULL) == NULL && raymap_field_to_dense(NULL, NULL) == NULL);
  CHECK(raymap_field_leaves(NULL) == NULL && raymap_field_tiles(NULL) == NULL && !raymap_field_is_narrow(NULL));
  CHECK(raymap_field_leaf_count(NULL) == 0 && raymap_field_tile_count(NULL) == 0);
}

/* NULL does no harm anywhere. */
static void test_null(void) {
  raymap_grid grid = {{1, 1, 1}, {0, 0, 0}, 1};
  raymap_mesh* mesh = make_tetrahedron();
  raymap_field* field = raymap_field_create();
  double low[3];
  raymap_mesh_arrays arrays = RAYMAP_INIT(raymap_mesh_arrays);
  raymap_query_arrays results = RAYMAP_INIT(raymap_query_arrays);
  const raymap_result usage = RAYMAP_ERROR_USAGE;
  raymap_options_free(NULL);
  raymap_mesh_free(NULL);
  raymap_field_free(NULL);
  raymap_generator_free(NULL);
  raymap_surface_free(NULL);
  raymap_picture_free(NULL);
  CHECK(raymap_options_set_text(NULL, "device", "cpu") == usage);
  CHECK(raymap_options_set_number(NULL, "band", 1) == usage && raymap_options_set_json(NULL, "{}") == usage);
  CHECK(raymap_options_set_numbers(NULL, "down", low, 0) == usage);
  CHECK(raymap_json_number(NULL, "a", low) == usage && raymap_json_number("{}", NULL, low) == usage);
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
  CHECK(raymap_field_clamp_distance(NULL) == 0.0 && raymap_field_json(NULL) == NULL);
  CHECK(raymap_field_sample(NULL, low, 1, RAYMAP_OUTSIDE_BOUND, NULL, NULL) == usage);
  CHECK_FAILS(raymap_field_sample(field, low, 1, RAYMAP_OUTSIDE_BOUND, NULL, NULL), usage, "the field is empty");
  CHECK(raymap_isosurface(NULL, NULL) == NULL);
  CHECK(raymap_surface_create(NULL, NULL) == NULL && raymap_surface_bytes(NULL) == 0);
  CHECK(raymap_surface_json(NULL) == NULL);
  CHECK(raymap_surface_query(NULL, low, 1, NULL, &results) == usage);
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  CHECK(raymap_surface_query(surface, NULL, 1, NULL, &results) == usage);
  CHECK(raymap_surface_query(surface, low, 1, NULL, NULL) == usage);
  CHECK(raymap_sample_points(surface, 1, NULL, NULL) == usage);
  raymap_thickness_arrays thickness = RAYMAP_INIT(raymap_thickness_arrays);
  CHECK(raymap_surface_thickness(NULL, low, NULL, 0, NULL, &thickness) == usage);
  CHECK(raymap_surface_thickness(surface, low, NULL, 0, NULL, NULL) == usage);
  CHECK_FAILS(raymap_surface_thickness(surface, low, NULL, 1, NULL, &thickness), usage, "triangles is NULL");
  test_null_of_bands(surface, &grid);
  raymap_surface_free(surface);
  CHECK(raymap_inspect(NULL, NULL) == NULL);
  CHECK(raymap_repair(NULL, &grid, NULL, NULL) == NULL && raymap_repair(mesh, NULL, NULL, NULL) == NULL);
  CHECK(raymap_fit_repair_grid(NULL, NULL, &grid) == usage && raymap_fit_repair_grid(mesh, NULL, NULL) == usage);
  CHECK(raymap_simplify(NULL, NULL, NULL) == NULL);
  CHECK(raymap_render_field(NULL, NULL) == NULL && raymap_render_defects(NULL, NULL) == NULL);
  CHECK(raymap_render_slice(NULL, 0, 0, NULL) == NULL && raymap_picture_rgb(NULL) == NULL);
  CHECK(raymap_picture_width(NULL) == 0 && raymap_picture_height(NULL) == 0);
  CHECK(raymap_picture_write_png(NULL, "a.png") == usage);
  CHECK(raymap_field_load(NULL, NULL) == NULL);
  CHECK(raymap_field_write(NULL, "a.nrrd", NULL) == usage && raymap_field_write(field, NULL, NULL) == usage);
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
  test_grid_options();
  test_field();
  test_surface();
  test_scene();
  test_band(argc > 1 ? argv[1] : ".");
  test_region();
  test_memory();
  test_threads();
  test_options();
  test_callbacks();
  test_sizes();
  test_thickness();
  test_inspection();
  test_repair();
  test_simplify();
  test_pictures(argc > 1 ? argv[1] : ".");
  test_files(argc > 1 ? argv[1] : ".");
  test_generate_file(argc > 1 ? argv[1] : ".");
  test_devices();
  test_null();
  printf("all passed\n");
  return 0;
}
