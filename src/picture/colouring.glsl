// GPU twin of picture/colouring.h and of its use in cpu/render/shade.cpp. The shader that includes it after shade.glsl has
// `valueAt`, which returns the number at a point, and `stopAt`, which returns a colour and in w its number.

vec3 colourOf(float value, uint stopCount) {
  vec3 mixed = stopAt(0).rgb;
  for (uint i = 1; i < stopCount; ++i) {
    const float low = stopAt(i - 1).w, high = stopAt(i).w;
    mixed = mix(mixed, stopAt(i).rgb, clamp((value - low) / (high - low), 0, 1));
  }
  return mixed;
}

// Returns the colour of a point inside. `pixel` is a pixel's size there. Lines lie half a step off zero: large regions
// have whole numbers.
vec3 valueColour(RenderSceneData scene, vec3 p, float pixel, uint stopCount, float lineStep) {
  const float value = valueAt(p);
  vec3 gradient;
  for (int a = 0; a < 3; ++a) {
    vec3 step = vec3(0);
    step[a] = 0.5;
    gradient[a] = valueAt(p + step) - valueAt(p - step);
  }
  const float slope = pixel * length(gradient);
  vec3 ground = colourOf(value, stopCount);
  if (slope > kPlainValues * pixel * lineStep) ground = drawIsoLines(ground, value - 0.5 * lineStep, slope, lineStep);
  const float d = fieldDistance(p);
  return isClamped(d) ? ground : drawContour(scene, ground, d, pixel);
}
