// Mesh in cell units: three floats per vertex, three vertex indices per triangle.

vec3 readCorner(Floats vertices, Uints triangles, uint triangle, uint corner) {
  const uint vertex = triangles.at[3 * triangle + corner];
  return vec3(vertices.at[3 * vertex], vertices.at[3 * vertex + 1], vertices.at[3 * vertex + 2]);
}
