// A mesh in cell units: three floats a vertex, three numbers of vertices a triangle.

vec3 readCorner(Floats vertices, Uints triangles, uint triangle, uint corner) {
  const uint vertex = triangles.at[3 * triangle + corner];
  return vec3(vertices.at[3 * vertex], vertices.at[3 * vertex + 1], vertices.at[3 * vertex + 2]);
}
