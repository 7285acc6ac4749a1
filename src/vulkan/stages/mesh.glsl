// Mesh in cell units: three floats per vertex, three vertex indices per triangle.

vec3 readCorner(Floats vertices, Uints triangles, uint triangle, uint corner) {
  return vectorAt(vertices, triangles.at[3 * triangle + corner]);
}
