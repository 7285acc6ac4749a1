// Mesh in cell units: three floats per vertex, three vertex indices per triangle.

mat3 cornersOf(Floats vertices, Uints triangles, uint triangle) {
  return mat3(vectorAt(vertices, triangles.at[3 * triangle]), vectorAt(vertices, triangles.at[3 * triangle + 1]),
              vectorAt(vertices, triangles.at[3 * triangle + 2]));
}
