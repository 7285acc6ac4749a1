// Barill et al. 2018: the winding number of the triangles of a surface tree, from its moments. A work group
// computes it for one point. Its invocations are nodes, or triangles of leaves. Subgroups play no role, and all
// barriers are in control flow that is uniform in the group.

// Invocations of a group: a multiple of kTreeArity.
layout(constant_id = 1) const uint kInvocations = 8;

// Nodes or leaves opened at once, at most.
const uint kBatch = kInvocations / kTreeArity;

// Stack of nodes to open; none is a leaf. Each turn puts at most kInvocations nodes there, over what is left of an
// earlier turn's nodes. The least deep of these is less deep than all of the new ones, whatever their order. Hence
// nodes of at most one turn per level lie there: levels between the root's and the leaves'.
shared uint nodes[kInvocations * (kMostTreeLevels - 2)];
shared uint leaves[kInvocations + kBatch];  // Leaves to be summed triangle by triangle.
shared uint pushedNodes, pushedLeaves;      // Since the walk began.
shared int angleHigh, errorHigh;            // See Sum.
shared uint angleLow, errorLow;

// Returns half the solid angle of the triangle seen from p; zero in its plane (Van Oosterom & Strackee 1983).
float halfSolidAngle(Triangle t, vec3 p) {
  const vec3 q = p - t.a;
  const float u = dot(q, t.x), v = dot(q, t.y), w = dot(q, t.z);
  const vec3 a = vec3(-u, -v, -w), b = vec3(t.bx - u, -v, -w), c = vec3(t.cx - u, t.cy - v, -w);
  const float la = length(a), lb = length(b), lc = length(c);
  const float volume = -w * t.bx * t.cy;
  const float denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return volume == 0 ? 0 : arcTangent(volume, denominator);
}

float halfSolidAngle(Moments m, vec3 r, float r2) {
  const float inverse2 = 1.0 / r2;
  const float second = dot(r * r, m.squares) + 2.0 * dot(r * r.yzx, m.products);
  const float trace = m.squares.x + m.squares.y + m.squares.z;
  return 0.5 * (dot(r, m.area) + trace - 3.0 * second * inverse2) * inverse2 * inversesqrt(r2);
}

// Sum as an integer, in units of 2^-36: the same for any order and any group size.
struct Sum {
  int high;  // In units of 2^-12.
  uint low;  // In units of 2^-36, below 2^24.
};
const float kHighUnits = 4096.0, kLowUnits = 16777216.0;
const float kMostTerm = 262144.0;  // Keeps what is not finite out of the conversion to an integer.

Sum angles, squaredErrors;  // Half solid angles, and the squares of their errors.
uint poppedNodes, poppedLeaves;
uint turns = 0;  // Batches of nodes or leaves so far, in all walks.

// Adds terms in both units.
void addTerms(inout Sum sum, int high, uint low) {
  sum.low += low;
  sum.high += high + int(sum.low >> 24);
  sum.low &= 0xffffffu;
}

void add(inout Sum sum, float term) {
  const float scaled = clamp(term, -kMostTerm, kMostTerm) * kHighUnits, whole = floor(scaled);
  addTerms(sum, int(whole), uint((scaled - whole) * kLowUnits + 0.5));
}

// Adds the node's dipole if the node is distant. Otherwise the node waits to be opened.
void visit(uint node, vec3 p, float distant) {
  const Disc disc = readDisc(push.discs, node);
  if (disc.radius < 0) return;  // Fills up the level.
  const vec3 r = disc.centre - p;
  const float r2 = dot(r, r), reach2 = disc.radius * disc.radius + disc.halfThickness * disc.halfThickness;
  if (r2 > distant * distant * reach2) {
    const float angle = halfSolidAngle(readMoments(node), r, r2), error = angle * reach2 / r2;
    add(angles, angle);
    add(squaredErrors, error * error);
  } else if (node >= push.firstLeaf)
    leaves[atomicAdd(pushedLeaves, 1) - poppedLeaves] = node;
  else
    nodes[atomicAdd(pushedNodes, 1) - poppedNodes] = node;
}

void openNodes(uint waiting, vec3 p, float distant) {
  const uint taken = min(waiting, kBatch), ofMine = gl_LocalInvocationIndex / kTreeArity;
  const uint parent = nodes[waiting - taken + min(ofMine, taken - 1)];
  poppedNodes += taken;
  barrier();
  if (ofMine < taken) visit(kTreeArity * parent + 1 + gl_LocalInvocationIndex % kTreeArity, p, distant);
  barrier();
}

void sumLeaves(uint waiting, vec3 p) {
  const uint taken = min(waiting, kBatch), ofMine = gl_LocalInvocationIndex / kTreeArity;
  const uint leaf = leaves[waiting - taken + min(ofMine, taken - 1)];
  poppedLeaves += taken;
  const uint triangle = (leaf - push.firstLeaf) * kTreeArity + gl_LocalInvocationIndex % kTreeArity;
  if (ofMine < taken && triangle < push.triangleCount)
    add(angles, halfSolidAngle(readTriangle(push.frames, triangle), p));
}

void startWalk(vec3 p, float distant) {
  angles = squaredErrors = Sum(0, 0);
  poppedNodes = poppedLeaves = 0;
  barrier();  // All that the last walk wrote has been read.
  if (gl_LocalInvocationIndex == 0) {
    pushedNodes = pushedLeaves = angleLow = errorLow = 0;
    angleHigh = errorHigh = 0;
    visit(0, p, distant);
  }
  barrier();
}

float total(int high, uint low) {
  Sum sum = Sum(0, 0);
  addTerms(sum, high, low);
  return float(sum.high) / kHighUnits + float(sum.low) / (kHighUnits * kLowUnits);
}

struct Winding {
  float number;
  float error;   // How far the number may be wrong.
  bool isWhole;  // Whether it took at most the allowed turns; else it means nothing.
};

// Returns the winding number of the triangles around p, the same in the whole group.
Winding windingNumber(vec3 p, float distant, uint mostTurns) {
  startWalk(p, distant);
  uint waitingNodes = pushedNodes, waitingLeaves = pushedLeaves;
  // Two loops, because devices that only mask branches would run both bodies in every turn of one.
  while (waitingNodes + waitingLeaves > 0 && turns < mostTurns) {
    for (; waitingNodes > 0 && waitingLeaves < kBatch && turns < mostTurns; ++turns) {
      openNodes(waitingNodes, p, distant);
      waitingNodes = pushedNodes - poppedNodes;
      waitingLeaves = pushedLeaves - poppedLeaves;
    }
    for (; waitingLeaves >= (waitingNodes > 0 ? kBatch : 1) && turns < mostTurns; ++turns) {
      sumLeaves(waitingLeaves, p);
      waitingLeaves = pushedLeaves - poppedLeaves;
    }
  }
  atomicAdd(angleHigh, angles.high);
  atomicAdd(angleLow, angles.low);
  atomicAdd(errorHigh, squaredErrors.high);
  atomicAdd(errorLow, squaredErrors.low);
  barrier();
  return Winding(total(angleHigh, angleLow) / (2.0 * kPi),
                 kErrorOfDipoles / (2.0 * kPi) * sqrt(total(errorHigh, errorLow)),
                 waitingNodes + waitingLeaves == 0);
}
