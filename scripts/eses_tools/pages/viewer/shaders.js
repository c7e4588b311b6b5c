// The shaders. Coordinates are in angstrom; the camera looks along -z with parallel rays, so that
// the scale bar holds at any depth.

const PLACE = `#version 300 es
precision highp float;
uniform mat3 u_rotation;
uniform vec3 u_center; // of rotation
uniform vec2 u_pan, u_scale; // angstrom; clip units per angstrom
uniform float u_range; // angstrom; visible depth on both sides of the centre
out vec3 v_place;

void put(vec3 view) {
  v_place = view;
  gl_Position = vec4((view.xy + u_pan) * u_scale, -view.z / u_range, 1.0);
}
vec3 toView(vec3 place) { return u_rotation * (place - u_center); }
`;

const LIGHT = `#version 300 es
precision highp float;
uniform vec3 u_back; // colour of the background
uniform float u_radius; // of the molecules, angstrom
uniform bool u_pick; // draws numbers instead of colours
out vec4 o_color;

vec4 number(uint id) {
  return vec4(float(id & 255u), float(id >> 8 & 255u), float(id >> 16), 255.0) / 255.0;
}
vec3 lit(vec3 color, vec3 normal, float z) {
  const vec3 light = normalize(vec3(-0.35, 0.45, 1.0)), half_way = normalize(light + vec3(0, 0, 1));
  float diffuse = max(dot(normal, light), 0.0);
  float shine = 0.07 * pow(max(dot(normal, half_way), 0.0), 36.0);
  vec3 shaded = color * (0.34 + 0.68 * diffuse) + shine;
  float fog = clamp(-z / u_radius, 0.0, 1.0); // fades what is behind the centre
  return mix(shaded, u_back, 0.45 * fog * fog);
}
`;

const SURFACE = {
  vertex: `${PLACE}
uniform vec3 u_origin;
uniform float u_step; // angstrom per unit of a_place
layout(location = 0) in vec3 a_place;
layout(location = 1) in vec2 a_normal; // octahedral, 0 to 2046
layout(location = 2) in mat4 a_classes; // of colours: red, green, blue and height of each
out vec3 v_normal;
out vec4 v_heights, v_shares; // of the classes; a class that is absent has no share
out mat4x3 v_colors; // of the classes, times their shares
flat out uint v_id;

void main() {
  put(toView(u_origin + u_step * a_place));
  vec2 e = a_normal / 1023.0 - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  v_normal = u_rotation * n;
  v_heights = vec4(a_classes[0].w, a_classes[1].w, a_classes[2].w, a_classes[3].w);
  v_shares = step(1e-3, v_heights);
  for (int i = 0; i < 4; i++) v_colors[i] = v_shares[i] * a_classes[i].rgb;
  v_id = uint(gl_VertexID) + 1u;
}`,
  fragment: `${LIGHT}
uniform float u_clip, u_opacity;
uniform float u_inner; // brightness of the inner side
in vec3 v_place, v_normal;
in vec4 v_heights, v_shares;
in mat4x3 v_colors;
flat in uint v_id;

// Returns the colour of the highest class. Classes within a pixel of it are mixed.
vec3 nearestColor() {
  float top = max(max(v_heights.x, v_heights.y), max(v_heights.z, v_heights.w));
  vec4 width = clamp(fwidth(v_heights), 1e-4, 0.25); // steeper heights are those of thin triangles
  vec4 weights = clamp(1.0 + (v_heights - top) / width, 0.0, 1.0);
  weights *= step(1e-3, v_shares); // there is no colour without a share, which may be extrapolated
  return v_colors * (weights / max(v_shares, vec4(1e-4))) / (weights.x + weights.y + weights.z + weights.w);
}

void main() {
  vec3 color = nearestColor(); // first, because derivatives need all fragments
  if (v_place.z > u_clip) discard;
  if (u_pick) { o_color = number(v_id); return; }
  vec3 normal = normalize(v_normal);
  bool is_inner = normal.z < 0.0 && !gl_FrontFacing;
  if (is_inner) color *= u_inner;
  o_color = vec4(lit(color, is_inner ? -normal : normal, v_place.z), u_opacity);
}`,
};

// Spheres are squares that face the camera; each fragment finds its point of the sphere.
const SPHERE = {
  vertex: `${PLACE}
uniform float u_shrink, u_add; // drawn radius = shrink * radius + add
uniform uint u_first;
layout(location = 0) in vec2 a_corner;
layout(location = 1) in vec4 a_sphere;
layout(location = 2) in vec3 a_color;
layout(location = 3) in uint a_atom;
out vec2 v_corner;
flat out float v_radius;
flat out vec3 v_color;
flat out uint v_id;

void main() {
  float shrink = a_sphere.w < 0.0 ? max(u_shrink, 0.55) : u_shrink; // atoms without bonds are larger
  v_radius = shrink * abs(a_sphere.w) + u_add;
  put(toView(a_sphere.xyz) + vec3(a_corner * v_radius, 0));
  v_corner = a_corner;
  v_color = a_color;
  v_id = u_first + a_atom;
}`,
  fragment: `${LIGHT}
uniform float u_range;
in vec3 v_place;
in vec2 v_corner;
flat in float v_radius;
flat in vec3 v_color;
flat in uint v_id;

void main() {
  float square = dot(v_corner, v_corner);
  if (square > 1.0) discard;
  float height = sqrt(1.0 - square), z = v_place.z + v_radius * height;
  gl_FragDepth = 0.5 - 0.5 * z / u_range;
  o_color = u_pick ? number(v_id) : vec4(lit(v_color, vec3(v_corner, height), z), 1);
}`,
};

// Sticks are prisms with the normals of a cylinder. Each half has the colour of its atom.
const STICK = {
  vertex: `${PLACE}
uniform float u_width;
uniform uint u_first;
layout(location = 0) in vec3 a_corner; // angle, 0 or 1 along the bond
layout(location = 1) in vec3 a_begin;
layout(location = 2) in vec3 a_end;
layout(location = 3) in vec3 a_begin_color;
layout(location = 4) in vec3 a_end_color;
layout(location = 5) in uvec2 a_atoms;
out vec3 v_normal;
out float v_along;
flat out vec3 v_begin_color, v_end_color;
flat out uvec2 v_ids;

void main() {
  vec3 begin = toView(a_begin), end = toView(a_end), axis = normalize(end - begin);
  vec3 side = normalize(cross(axis, abs(axis.z) < 0.9 ? vec3(0, 0, 1) : vec3(1, 0, 0)));
  v_normal = a_corner.x * side + a_corner.y * cross(axis, side);
  put(mix(begin, end, a_corner.z) + u_width * v_normal);
  v_along = a_corner.z;
  v_begin_color = a_begin_color;
  v_end_color = a_end_color;
  v_ids = a_atoms + u_first;
}`,
  fragment: `${LIGHT}
in vec3 v_place, v_normal;
in float v_along;
flat in vec3 v_begin_color, v_end_color;
flat in uvec2 v_ids;

void main() {
  bool is_begin = v_along < 0.5;
  if (u_pick) { o_color = number(is_begin ? v_ids.x : v_ids.y); return; }
  o_color = vec4(lit(is_begin ? v_begin_color : v_end_color, normalize(v_normal), v_place.z), 1);
}`,
};

const WHOLE = `#version 300 es
void main() { // one triangle that covers the picture
  gl_Position = vec4(vec2(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1), 0, 1);
}`;

// Ambient occlusion from the depth buffer (M. McGuire, M. Mara, D. Luebke, "Scalable ambient
// obscurance", High Performance Graphics 2012), with two radii: grooves and pockets.
const OCCLUSION = {
  vertex: WHOLE,
  fragment: `#version 300 es
precision highp float;
uniform highp sampler2D u_depth;
uniform float u_range, u_pixels; // pixels per angstrom
out vec4 o_color;
const int samples = 14;

float depthAt(ivec2 pixel) {
  return texelFetch(u_depth, clamp(pixel, ivec2(0), textureSize(u_depth, 0) - 1), 0).x;
}
vec3 at(ivec2 pixel) {
  return vec3(vec2(pixel) / u_pixels, (0.5 - depthAt(pixel)) * 2.0 * u_range);
}
vec3 slope(vec3 here, ivec2 pixel, ivec2 step) { // the flatter side avoids edges
  vec3 next = at(pixel + step) - here, before = here - at(pixel - step);
  return abs(next.z) < abs(before.z) ? next : before;
}
float hidden(vec3 here, vec3 normal, ivec2 pixel, float radius, float turn) {
  float sum = 0.0;
  for (int i = 0; i < samples; i++) {
    float share = (float(i) + 0.5) / float(samples);
    float angle = float(i) * 2.39996 + turn;
    ivec2 other = pixel + ivec2(round(share * radius * u_pixels * vec2(cos(angle), sin(angle))));
    if (depthAt(other) == 1.0) continue;
    vec3 away = at(other) - here;
    float square = dot(away, away), near = max(1.0 - square / (radius * radius), 0.0);
    sum += near * near * near * max((dot(away, normal) - 0.05 * radius) / (square + 0.01), 0.0);
  }
  return sum * radius / float(samples);
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  o_color = vec4(1);
  if (depthAt(pixel) == 1.0) return;
  vec3 here = at(pixel);
  vec3 normal = normalize(cross(slope(here, pixel, ivec2(1, 0)), slope(here, pixel, ivec2(0, 1))));
  float turn = 6.2832 * fract(52.9829 * fract(dot(gl_FragCoord.xy, vec2(0.06711, 0.00584))));
  float sum = 0.7 * hidden(here, normal, pixel, 3.5, turn) + hidden(here, normal, pixel, 11.0, turn);
  o_color = vec4(vec3(max(1.0 - 0.95 * sum, 0.0)), 1);
}`,
};

const COMPOSITE = {
  vertex: WHOLE,
  fragment: `#version 300 es
precision highp float;
uniform sampler2D u_picture, u_occlusion;
uniform highp sampler2D u_depth;
uniform float u_range;
uniform bool u_is_shaded;
out vec4 o_color;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(u_depth, 0) - 1;
  o_color = texelFetch(u_picture, pixel, 0);
  if (!u_is_shaded) return;
  float depth = texelFetch(u_depth, pixel, 0).x, sum = 0.0, count = 0.0;
  if (depth == 1.0) return;
  for (int x = -2; x <= 2; x++)
    for (int y = -2; y <= 2; y++) { // mean of neighbours at a similar depth
      ivec2 other = clamp(pixel + ivec2(x, y), ivec2(0), last);
      float weight = abs(texelFetch(u_depth, other, 0).x - depth) * 2.0 * u_range < 1.5 ? 1.0 : 0.0;
      sum += weight * texelFetch(u_occlusion, other, 0).x;
      count += weight;
    }
  o_color.rgb *= mix(1.0, sum / max(count, 1.0), 0.85);
}`,
};
