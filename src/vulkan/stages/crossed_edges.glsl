// One bit per lattice edge: whether any triangle crosses it. `words` numbers for the edges along each axis.

void markCrossed(Uints crossed, uint words, uint axis, uint edge) {
  atomicOr(crossed.at[axis * words + edge / 32], 1u << (edge % 32));
}

bool isCrossed(Uints crossed, uint words, uint axis, uint edge) {
  return (crossed.at[axis * words + edge / 32] >> (edge % 32) & 1) != 0;
}
