// Fragments that the two shaders of a mesh do not draw. The shader has `push`.

const float kNoField = 1e38;

// Returns whether a point, relative to the eye, is cut away or lies behind the field's surface.
bool isHidden(vec3 place) {
  if (dot(place, push.cutNormal) > push.cutOffset) return true;
  if (push.slack >= kNoField) return false;
  const float seen = push.depth.at[uint(gl_FragCoord.y) * push.width + uint(gl_FragCoord.x)];
  return length(place) > seen + push.slack;
}
