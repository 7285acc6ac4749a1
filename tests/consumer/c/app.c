/* Reads a mesh, makes its field, samples it and writes it, and queries the mesh itself: the interface for C.
 * Runs in a folder that holds tetrahedron.dae. */

#include <raymap/c.h>
#include <stdio.h>

static int fail(void) {
  printf("failed: %s\n", raymap_last_error_message());
  return 1;
}

int main(void) {
  const double middle[3] = {0.0, 0.0, 0.0};
  float distance = 1.0f;
  raymap_grid grid;
  raymap_options* options = raymap_options_create();
  if (raymap_options_set_number(options, "resolution", 21) != RAYMAP_OK) return fail();

  raymap_mesh* mesh = raymap_mesh_load("tetrahedron.dae", NULL);
  if (!mesh || raymap_fit_grid(mesh, options, &grid) != RAYMAP_OK) return fail();
  raymap_field* field = raymap_generate(mesh, &grid, NULL);
  if (!field || raymap_field_sample(field, middle, 1, RAYMAP_OUTSIDE_NAN, &distance, NULL) != RAYMAP_OK) return fail();
  if (raymap_field_write(field, "field.vdb", NULL) != RAYMAP_OK) return fail();
  double nearest = 1.0;
  raymap_query_arrays arrays = RAYMAP_INIT(raymap_query_arrays);
  arrays.distance = &nearest;
  raymap_surface* surface = raymap_surface_create(mesh, NULL);
  if (!surface || raymap_surface_query(surface, middle, 1, NULL, &arrays) != RAYMAP_OK) return fail();
  raymap_surface_free(surface);
  raymap_options_free(options);
  raymap_field_free(field);
  raymap_mesh_free(mesh);
  if (raymap_mesh_load("missing.obj", NULL) != NULL || raymap_last_error() != RAYMAP_ERROR_FILE) return 1;
  return distance < 0.0f && nearest < 0.0 ? 0 : 1;
}
