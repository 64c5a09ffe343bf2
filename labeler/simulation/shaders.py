"""The programs that run on the graphics card (GLSL 3.30).

One vertex program serves all. Colour is physically based shading in a small way: a diffuse and a GGX highlight term for
the sun with shadows from two depth maps, ambient light from above and below, and a drawn environment that glass and
paint reflect (see B. Karis, "Real Shading in Unreal Engine 4", 2013, for the terms). Random detail comes from one
tileable noise texture, since computed noise is slow without a graphics card.
"""

from labeler.simulation.materials import Semantic

VERTEX = """
#version 330 core
in vec3 in_position; in vec3 in_normal; in vec2 in_uv; in float in_layer; in vec3 in_color; in vec4 in_surface;
in float in_shading; in float in_semantic;
in vec4 in_row0; in vec4 in_row1; in vec4 in_row2; in vec4 in_paint_id;
uniform mat4 view_projection;
out vec3 world; out vec3 normal; out vec2 uv; flat out float layer; out vec3 color; out vec4 surface;
flat out float shading; flat out float semantic; flat out vec4 paint_id;
invariant gl_Position;
void main() {
  vec4 p = vec4(in_position, 1.0);
  world = vec3(dot(in_row0, p), dot(in_row1, p), dot(in_row2, p));
  normal = vec3(dot(in_row0.xyz, in_normal), dot(in_row1.xyz, in_normal), dot(in_row2.xyz, in_normal));
  uv = in_uv; layer = in_layer; color = in_color; surface = in_surface; shading = in_shading; semantic = in_semantic;
  paint_id = in_paint_id;
  gl_Position = view_projection * vec4(world, 1.0);
}
"""

_VARYINGS = """
#version 330 core
in vec3 world; in vec3 normal; in vec2 uv; flat in float layer; in vec3 color; in vec4 surface;
flat in float shading; flat in float semantic; flat in vec4 paint_id;
"""

_HOLES = """
uniform sampler2DArray colors;
void cut_holes() {
  if (shading > 0.5 && shading < 1.5 && texture(colors, vec3(uv, layer)).a < 0.42) discard;
}
"""

DEPTH = _VARYINGS + _HOLES + "void main() { cut_holes(); }"

IDENTITY = (
    _VARYINGS
    + _HOLES
    + """
out uint identity;
void main() {
  cut_holes();
  identity = (uint(paint_id.w > 0.5 ? VEHICLE_CLASS : semantic) << 24) | uint(paint_id.w);
}
""".replace("VEHICLE_CLASS", f"{float(Semantic.VEHICLE)}")
)
"""The id in the lower 24 bits, the semantic class in the upper 8."""

_SKY_FUNCTIONS = """
uniform vec3 eye; uniform vec3 sun_direction; uniform vec3 sun; uniform vec3 zenith; uniform vec3 horizon;
uniform vec3 above; uniform vec3 below; uniform float haze; uniform float clouds; uniform float exposure;
uniform sampler2D noise;
vec3 sky(vec3 d) {
  vec3 c = mix(horizon, zenith, pow(max(d.z, 0.0), 0.55));
  float s = max(dot(d, sun_direction), 0.0);
  return (c + sun * (pow(s, 8.0) * 0.03 + pow(s, 64.0) * 0.08)) * 1.15;
}
vec3 developed(vec3 c) {
  c *= exposure;
  c = (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14);
  return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2));
}
"""

_LIGHT = """
uniform sampler2DShadow near_shadow; uniform sampler2DShadow far_shadow;
uniform mat4 near_sun; uniform mat4 far_sun;
vec3 surroundings(vec3 d, float rough) {
  float turn = atan(d.y, d.x) * 0.159155;
  vec4 n = textureLod(noise, vec2(turn * 2.0, 0.3), 4.0);
  float roofs = 0.06 + 0.34 * n.r;
  vec3 houses = mix(below, above, 0.35) * mix(0.35, 0.9, n.b);
  float soft = 0.02 + rough * 0.5;
  vec3 open_sky = sky(normalize(vec3(d.xy, max(d.z, 0.02))));
  vec3 c = mix(houses, open_sky, smoothstep(roofs - soft, roofs + soft, d.z));
  return mix(below * 0.8, c, smoothstep(-soft, soft, d.z));
}
float sunlit(vec3 p, vec3 n) {
  vec3 q = (near_sun * vec4(p + n * 0.05, 1.0)).xyz * 0.5 + 0.5;
  if (all(greaterThan(q.xy, vec2(0.01))) && all(lessThan(q.xy, vec2(0.99)))) {
    vec2 t = 0.75 / vec2(textureSize(near_shadow, 0));
    float z = q.z - 0.0006;
    return 0.25 * (texture(near_shadow, vec3(q.xy - t, z)) + texture(near_shadow, vec3(q.x + t.x, q.y - t.y, z))
                 + texture(near_shadow, vec3(q.xy + t, z)) + texture(near_shadow, vec3(q.x - t.x, q.y + t.y, z)));
  }
  q = (far_sun * vec4(p + n * 0.2, 1.0)).xyz * 0.5 + 0.5;
  bool covered = all(greaterThan(q, vec3(0.0))) && all(lessThan(q, vec3(1.0)));
  return covered ? texture(far_shadow, vec3(q.xy, q.z - 0.0012)) : 1.0;
}
vec3 lit(vec3 p, vec3 n, vec3 albedo, float metal, float rough, float glass, float open) {
  vec3 v = normalize(eye - p);
  float nv = max(dot(n, v), 0.02), nl = max(dot(n, sun_direction), 0.0);
  vec3 h = normalize(v + sun_direction);
  float nh = max(dot(n, h), 0.0), vh = max(dot(v, h), 0.0);
  vec3 f0 = mix(vec3(0.04 + 0.05 * glass), albedo, metal);
  float a = rough * rough + 0.002, k = (rough + 1.0) * (rough + 1.0) / 8.0;
  float spread = nh * nh * (a * a - 1.0) + 1.0;
  float facets = min(a * a / (3.1416 * spread * spread), 40.0);
  float masking = 0.25 / ((nv * (1.0 - k) + k) * (max(nl, 0.02) * (1.0 - k) + k));
  vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - vh, 5.0);
  vec3 c = vec3(0.0);
  vec3 diffuse = albedo * (1.0 - metal) * (1.0 - fresnel) * 0.43;
  if (nl > 0.0) c = (diffuse + fresnel * facets * masking) * sun * nl * sunlit(p, n);
  c += albedo * (1.0 - metal) * mix(below, above, n.z * 0.5 + 0.5) * open;
  if (rough < 0.7) {
    vec3 mirrored = f0 + (max(vec3(1.0 - rough), f0) - f0) * pow(1.0 - nv, 5.0);
    c += surroundings(reflect(-v, n), rough) * mirrored * (1.0 - 0.55 * rough) * mix(1.0, open, 0.7);
  }
  return mix(sky(normalize(vec3((p - eye).xy, 0.05))) * 0.9, c, exp(-length(eye - p) * haze));
}
"""

STANDING = (
    _VARYINGS
    + _SKY_FUNCTIONS
    + _LIGHT
    + """
uniform sampler2DArray colors; uniform sampler2DArray surfaces;
out vec4 pixel;
void main() {
  if (shading > 3.5) { pixel = vec4(developed(paint_id.rgb / max(exposure, 0.1)), 1.0); return; }
  vec3 albedo = color; float paint = surface.x, metal = surface.y, rough = surface.z, glass = surface.w;
  if (layer >= 0.0) {
    vec4 t = texture(colors, vec3(uv, layer));
    albedo *= pow(t.rgb, vec3(2.2));
    if (shading > 1.5) {
      vec3 m = texture(surfaces, vec3(uv, layer)).rgb;
      metal = m.r; rough = max(m.g, 0.06); glass = m.b; paint = shading < 2.5 ? t.a : 0.0;
    }
  }
  albedo = mix(albedo, albedo * paint_id.rgb, paint);
  vec3 n = normalize(normal);
  if (dot(n, eye - world) < 0.0) n = -n;
  if (shading > 0.5 && shading < 1.5) n = normalize(mix(n, vec3(0.0, 0.0, 1.0), 0.4));
  float open = mix(0.55, 1.0, clamp(world.z * 1.3 + 0.1, 0.0, 1.0));
  pixel = vec4(developed(lit(world, n, albedo, metal, clamp(rough, 0.06, 1.0), glass, open)), 1.0);
}
"""
)

GROUND = (
    _VARYINGS
    + _SKY_FUNCTIONS
    + _LIGHT
    + """
out vec4 pixel;
void main() {
  vec2 p = world.xy;
  vec4 broad = texture(noise, p / 37.0), fine = texture(noise, p / 7.9);
  float near = exp(-length(eye - world) / 22.0);
  vec3 albedo = color;
  if (shading < 5.5) {
    albedo *= 0.66 + 0.34 * broad.r + 0.26 * fine.r + 0.14 * fine.g;
    float wheel = abs(mod(abs(uv.x), 3.5) - 1.75) - 0.75;
    if (abs(uv.x) < 7.2) albedo *= 1.0 - 0.15 * exp(-wheel * wheel / 0.10);
    float crack = 1.0 - smoothstep(0.0, 0.010, abs(texture(noise, p / 61.0 + 0.37).b - 0.5));
    albedo *= 1.0 - 0.40 * crack * near * smoothstep(0.45, 0.62, broad.r);
    float patchwork = step(0.80, texture(noise, floor(p / vec2(3.1, 4.7)) * 0.137).a);
    albedo *= 1.0 - 0.10 * patchwork;
  } else if (shading < 6.5) {
    albedo *= 0.72 + 0.35 * fine.r - 0.30 * smoothstep(0.52, 0.72, fine.b) * (0.4 + 0.6 * broad.b);
  } else if (shading < 7.5) {
    vec2 slab = fract(p / 1.2), gap = min(slab, 1.0 - slab);
    float joint = 1.0 - smoothstep(0.0, 0.02 + fwidth(p.x) + fwidth(p.y), min(gap.x, gap.y));
    float tone = texture(noise, floor(p / 1.2) * 0.219).g;
    albedo *= (0.72 + 0.22 * broad.r + 0.22 * fine.g + 0.14 * tone) * (1.0 - 0.35 * joint * near);
  } else {
    albedo *= 0.45 + 0.65 * fine.g + 0.5 * broad.r;
    albedo.r *= 0.75 + 0.6 * broad.b;
  }
  albedo *= 1.0 + (texture(noise, p * 1.7).a - 0.5) * 0.35 * near;
  pixel = vec4(developed(lit(world, normalize(normal), albedo, 0.0, 0.9, 0.0, 1.0)), 1.0);
}
"""
)

CONTACT = (
    _VARYINGS
    + """
out vec4 pixel;
void main() {
  vec2 q = abs(uv) - surface.xy;
  float away = length(max(q, 0.0)) + min(max(q.x, q.y), 0.0);
  pixel = vec4(vec3(1.0 - 0.62 * (1.0 - smoothstep(-0.45, 0.55, away))), 1.0);
}
"""
)

SKY_VERTEX = """
#version 330 core
in vec2 in_corner; out vec2 corner;
void main() { corner = in_corner; gl_Position = vec4(in_corner, 1.0, 1.0); }
"""

SKY = (
    """
#version 330 core
in vec2 corner;
uniform mat4 inverse_view_projection;
"""
    + _SKY_FUNCTIONS
    + """
out vec4 pixel;
void main() {
  vec4 far = inverse_view_projection * vec4(corner, 1.0, 1.0);
  vec3 d = normalize(far.xyz / far.w - eye);
  vec3 c = sky(d);
  if (d.z > 0.01) {
    vec2 u = d.xy / (d.z + 0.14) * 0.11;
    float k = texture(noise, u + 0.2).r * 0.65 + texture(noise, u * 3.1).r * 0.35;
    float cover = mix(0.78, 0.18, clouds);
    k = smoothstep(cover, cover + 0.30, k) * smoothstep(0.01, 0.20, d.z);
    c = mix(c, (horizon * 0.6 + vec3(0.42)) * (0.75 + 0.25 * length(sun) / 5.0), k * 0.75);
  }
  c += sun * smoothstep(0.9996, 0.9999, dot(d, sun_direction)) * 6.0 * (1.0 - clouds);
  pixel = vec4(developed(c), 1.0);
}
"""
)
