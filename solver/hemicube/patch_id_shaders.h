#pragma once

// GLSL of PatchIdRenderer. With MASKED defined, the shaders of quads do alpha tests; with CUT, they find the parts of
// cut cells; with REGIONS, the patches of regions.

namespace patchlight {

inline constexpr const char* kQuadVertexShader = R"(#version 450 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 st;
layout(location = 2) in vec2 shape;
layout(location = 3) in ivec3 front;
layout(location = 4) in ivec3 back;
#ifdef MASKED
layout(location = 5) in int mask;
flat out int mask_index;
#endif
uniform vec3 eye;
uniform mat3 axes;        // rows: right / width, up, forward
uniform vec2 height;      // scale and shift that map heights at distance 1 to [-1, 1]
uniform float near;
out vec2 at;
flat out vec2 corner;
flat out ivec3 grids[2];
void main() {
  vec3 p = axes * (position - eye);
  gl_Position = vec4(p.x, height.x * p.y + height.y * p.z, near, p.z);
  at = st;
  corner = shape;
  grids[0] = back;
  grids[1] = front;
#ifdef MASKED
  mask_index = mask;
#endif
}
)";

inline constexpr const char* kQuadFragmentShader = R"(#version 450 core
in vec2 at;
flat in vec2 corner;     // a, b: corner 2 in the frame of the edges
flat in ivec3 grids[2];  // back, front: the first patch's id, or ~ a region's first cell; columns, rows; zeros: unlit
layout(location = 0) out uint id;

// s = u (1 + v (a - 1)), t = v (1 + u (b - 1))
vec2 inverse_bilinear(float a, float b, float s, float t) {
  float k = a - 1.0, linear = 1.0 + (b - 1.0) * s - t * k;
  float v = 2.0 * t / (linear + sqrt(max(0.0, linear * linear + 4.0 * k * t)));
  float width = 1.0 + v * k;
  return vec2(width > 0.0 ? s / width : 0.5, v);
}

#ifdef MASKED
struct AlphaMask {
  vec4 texcoords[2];  // of corners 0 and 1, 2 and 3
  vec4 alphas;        // of the corners
  ivec4 image;        // first texel, width, height, nearest
  ivec2 wraps;
  vec2 factor;        // alpha factor, cutoff
};
layout(std430, binding = 3) readonly buffer AlphaMasks { AlphaMask masks[]; };
layout(std430, binding = 4) readonly buffer Texels { uint texels[]; };  // four bytes in each
flat in int mask_index;

int wrapped(int k, int count, int wrap) {
  if (wrap == 1) return clamp(k, 0, count - 1);
  int period = wrap == 2 ? 2 * count : count;
  k = (k % period + period) % period;
  return k < count ? k : period - 1 - k;
}

float texel(AlphaMask mask, int x, int y) {
  int k = mask.image.x + wrapped(y, mask.image.z, mask.wraps.y) * mask.image.y + wrapped(x, mask.image.y, mask.wraps.x);
  return float(texels[k >> 2] >> 8 * (k & 3) & 255u) / 255.0;
}

bool passes_alpha_test(vec2 uv) {
  AlphaMask mask = masks[mask_index];
  vec2 texel_position = mix(mix(mask.texcoords[0].xy, mask.texcoords[0].zw, uv.x), mix(mask.texcoords[1].zw, mask.texcoords[1].xy, uv.x), uv.y);
  texel_position = texel_position * vec2(mask.image.yz) - (mask.image.w != 0 ? 0.0 : 0.5);
  ivec2 low = ivec2(floor(texel_position));
  vec2 fraction = texel_position - floor(texel_position);
  float alpha = texel(mask, low.x, low.y);
  if (mask.image.w == 0)
    alpha = mix(mix(alpha, texel(mask, low.x + 1, low.y), fraction.x),
                mix(texel(mask, low.x, low.y + 1), texel(mask, low.x + 1, low.y + 1), fraction.x), fraction.y);
  float vertex_alpha = mix(mix(mask.alphas.x, mask.alphas.y, uv.x), mix(mask.alphas.w, mask.alphas.z, uv.x), uv.y);
  return mask.factor.x * alpha * vertex_alpha >= mask.factor.y;
}
#endif

#ifdef CUT
struct CutLine {
  vec4 distance;  // to the left: constant, along u, along v, times uv
  ivec2 sides;    // the number of another line, from 1, or ~patch
  ivec2 unused;
};
layout(std430, binding = 5) readonly buffer CutOf { int cut_of[]; };  // by patch: its cell's first line, from 1, or 0
layout(std430, binding = 6) readonly buffer CutLines { CutLine lines[]; };

// Beside a primitive, shaders of llvmpipe run too but read zeros, which end the loop.
uint part_of_cell(uint cell_id, vec2 uv) {
  int at = cell_id == 0u ? 0 : cut_of[cell_id - 1u];
  if (at == 0) return cell_id;
  while (at > 0) {
    vec4 d = lines[at - 1].distance;
    at = lines[at - 1].sides[d.x + uv.x * d.y + uv.y * (d.z + uv.x * d.w) < 0.0 ? 1 : 0];
  }
  return uint(~at) + 1u;
}
#endif

#ifdef REGIONS
layout(std430, binding = 7) readonly buffer RegionCells { int region_cells[]; };  // patches; ~patch near by outside
#endif

void main() {
  vec2 uv = inverse_bilinear(corner.x, corner.y, at.x, at.y);
#ifdef MASKED
  if (!passes_alpha_test(uv)) discard;
#endif
  ivec3 grid = gl_FrontFacing ? grids[1] : grids[0];
  if (!gl_FrontFacing) uv.x = 1.0 - uv.x;
  ivec2 cell = clamp(ivec2(uv * grid.yz), ivec2(0), max(grid.yz - 1, ivec2(0)));
  int number = cell.y * grid.y + cell.x;
  id = uint(grid.x + number);
#ifdef REGIONS
  if (grid.x < 0) {
    int patch_index = region_cells[~grid.x + number];
    id = uint(patch_index < 0 ? ~patch_index : patch_index) + 1u;
  }
#endif
#ifdef CUT
  id = part_of_cell(id, uv);
#endif
}
)";

inline constexpr const char* kSphereVertexShader = R"(#version 450 core
struct Sphere { vec4 ball; ivec4 rings; };  // centre, radius; first ring and number of rings, outside then inside
layout(std430, binding = 1) readonly buffer Spheres { Sphere spheres[]; };
uniform vec3 eye;
uniform mat3 axes;
uniform vec2 height;
uniform float near;
out vec3 ray;
flat out int index;
const int kCorners[36] = int[36](0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4, 2,6,3, 3,6,7, 0,4,2, 2,4,6, 1,3,5, 3,7,5);
void main() {
  int corner = kCorners[gl_VertexID];
  vec4 ball = spheres[gl_InstanceID].ball;
  vec3 box = vec3(corner & 1, (corner >> 1) & 1, corner >> 2) * 2.0 - 1.0;
  ray = ball.xyz + box * ball.w * 1.001 - eye;
  vec3 p = axes * ray;
  gl_Position = vec4(p.x, height.x * p.y + height.y * p.z, near, p.z);
  index = gl_InstanceID;
}
)";

inline constexpr const char* kSphereFragmentShader = R"(#version 450 core
struct Sphere { vec4 ball; ivec4 rings; };
layout(std430, binding = 1) readonly buffer Spheres { Sphere spheres[]; };
layout(std430, binding = 2) readonly buffer Rings { ivec2 rings[]; };  // first patch, patches
uniform vec3 eye;
uniform mat3 axes;
uniform float near;
uniform int self;         // the sphere that the eye is on, or -1
uniform bool self_inside;
in vec3 ray;
flat in int index;
layout(location = 0) out uint id;
void main() {
  vec4 ball = spheres[index].ball;
  vec3 from = eye - ball.xyz;
  float length2 = dot(ray, ray), middle = -dot(from, ray) / length2;
  vec3 nearest = from + middle * ray;
  float inside = ball.w * ball.w - dot(nearest, nearest);
  if (inside <= 0.0) discard;
  float half_chord = sqrt(inside / length2);
  float t = middle - half_chord;
  if (index == self) {
    if (!self_inside) discard;
    t = middle + half_chord;
  } else if (t <= 0.0) {
    t = middle + half_chord;
  }
  float distance = t * (axes * ray).z;
  if (t <= 0.0 || distance <= near) discard;
  gl_FragDepth = near / distance;

  vec3 n = from + t * ray;
  ivec2 side = dot(n, ray) < 0.0 ? spheres[index].rings.xy : spheres[index].rings.zw;
  if (side.y == 0) {
    id = 0u;
    return;
  }
  float turn = atan(-n.z, n.x) * 0.15915494;
  float u = turn < 0.0 ? turn + 1.0 : turn, v = atan(length(n.xz), n.y) * 0.31830989;
  ivec2 ring = rings[side.x + min(int(v * side.y), side.y - 1)];
  id = uint(ring.x + min(int(u * ring.y), ring.y - 1) + 1);
}
)";

}  // namespace patchlight
