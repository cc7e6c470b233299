#include "render/shaders.h"

namespace render::shaders {

/// One triangle that covers the whole picture.
const char* const background_vertex = R"(#version 330 core
out float height;
void main() {
    vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    height = 0.5 + 0.5 * p.y;
    gl_Position = vec4(p, 0.0, 1.0);
}
)";

/// A gradient from bottom to top, dithered to avoid visible bands.
const char* const background_fragment = R"(#version 330 core
uniform vec3 top;
uniform vec3 bottom;
in float height;
out vec4 color;
void main() {
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    color = vec4(mix(bottom, top, smoothstep(0.0, 1.0, height)) + (noise - 0.5) / 255.0, 1.0);
}
)";

const char* const mesh_vertex = R"(#version 330 core
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 normal;
layout(location = 2) in float tint;
uniform mat4 view_from_body;
uniform mat4 clip_from_view;
uniform vec4 section; // in the body's frame: keeps points with dot(xyz, p) <= w
uniform vec3 colors[2];
out vec3 towards;
out vec3 facing;
out vec3 base;
void main() {
    vec4 p = view_from_body * vec4(place, 1.0);
    towards = -p.xyz;
    facing = mat3(view_from_body) * normal;
    base = colors[tint > 0.5 ? 1 : 0];
    gl_ClipDistance[0] = section.w - dot(section.xyz, place);
    gl_Position = clip_from_view * p;
}
)";

/// Light from the sky and from a lamp over the left shoulder; faces at grazing angles get a rim.
const char* const mesh_fragment = R"(#version 330 core
uniform vec3 sky;      // upwards in the view's frame
uniform vec3 eye_axis; // towards the eye without perspective, else 0
uniform vec4 rim;      // colour and strength
uniform float alpha;
uniform float glass;   // 1: faces at grazing angles are more opaque
uniform float shine;
uniform sampler2D hollows; // ambient occlusion
uniform vec2 to_hollows;   // from pixels; 0: there is no such texture
in vec3 towards;
in vec3 facing;
in vec3 base;
out vec4 color;
const vec3 lamp = vec3(-0.3746, 0.5619, 0.7376);
const vec3 fill = vec3(0.8165, -0.1, 0.5687);
void main() {
    vec3 eye = dot(eye_axis, eye_axis) > 0.0 ? eye_axis : normalize(towards);
    vec3 n = normalize(facing);
    n = gl_FrontFacing ? n : -n;
    float up = 0.5 + 0.5 * dot(n, sky);
    float lit = 0.36 + 0.27 * up * up + 0.47 * max(dot(n, lamp), 0.0)
                + 0.20 * max(dot(n, fill), 0.0);
    float grazing = 1.0 - max(dot(n, eye), 0.0);
    float edge = grazing * grazing * grazing;
    float gleam = pow(max(dot(n, normalize(lamp + eye)), 0.0), 28.0) * shine;
    if (to_hollows.x > 0.0) lit *= texture(hollows, gl_FragCoord.xy * to_hollows).r;
    vec3 seen = base * lit + vec3(gleam);
    seen = mix(seen, rim.rgb, rim.a * edge);
    color = vec4(seen, mix(alpha, alpha + (1.0 - alpha) * 0.75 * edge, glass));
}
)";

/// Lines along edges, a little nearer to the eye than the faces that meet there.
const char* const edge_vertex = R"(#version 330 core
layout(location = 0) in vec3 place;
uniform mat4 view_from_body;
uniform mat4 clip_from_view;
uniform vec4 section;
uniform vec2 nearer; // factor of the position, and offset of its z
void main() {
    vec4 p = view_from_body * vec4(place, 1.0);
    p.xyz = p.xyz * nearer.x + vec3(0.0, 0.0, nearer.y);
    gl_ClipDistance[0] = section.w - dot(section.xyz, place);
    gl_Position = clip_from_view * p;
}
)";

const char* const edge_fragment = R"(#version 330 core
uniform vec4 ink;
out vec4 color;
void main() { color = ink; }
)";

/// Six corners for each piece between two points. The points come from a texture, so that wide
/// lines need no other data. w: block << 4 | state << 2 | rapid << 1 | begins.
const char* const line_vertex = R"(#version 330 core
uniform usamplerBuffer points;
uniform mat4 view_from_scene;
uniform mat4 clip_from_view;
uniform vec2 nearer;
uniform vec2 half_size; // of the picture, pixels
uniform vec4 inks[4];   // by state
uniform float widths[4]; // half widths, pixels
uniform vec4 rapid_ink;
uniform vec4 ink;       // if a > 0: replaces that of the state
uniform float wider;    // added to the half width
uniform float later;    // opacity of pieces after the current block
uniform uint current;
flat out vec4 color_of_line;
flat out float half_width;
flat out float dashed;
noperspective out float across;
noperspective out float along;
void main() {
    int piece = gl_VertexID / 6;
    int corner = gl_VertexID - 6 * piece;
    uvec4 a = texelFetch(points, piece);
    uvec4 b = texelFetch(points, piece + 1);
    uint state = (b.w >> 2) & 3u;
    bool rapid = (b.w & 2u) != 0u;
    vec4 pa = view_from_scene * vec4(uintBitsToFloat(a.xyz), 1.0);
    vec4 pb = view_from_scene * vec4(uintBitsToFloat(b.xyz), 1.0);
    pa.xyz = pa.xyz * nearer.x + vec3(0.0, 0.0, nearer.y);
    pb.xyz = pb.xyz * nearer.x + vec3(0.0, 0.0, nearer.y);
    vec4 ca = clip_from_view * pa, cb = clip_from_view * pb;
    float front = 1e-3 * max(abs(ca.w), abs(cb.w));
    bool hidden = (b.w & 1u) != 0u || (ca.w <= front && cb.w <= front);
    if (ca.w < front) ca = mix(ca, cb, (front - ca.w) / (cb.w - ca.w));
    if (cb.w < front) cb = mix(cb, ca, (front - cb.w) / (ca.w - cb.w));
    vec2 sa = ca.xy / ca.w * half_size, sb = cb.xy / cb.w * half_size;
    vec2 by = sb - sa;
    float size = length(by);
    vec2 direction = size > 1e-4 ? by / size : vec2(1.0, 0.0);
    half_width = widths[state] + wider;
    dashed = rapid && ink.a <= 0.0 ? 1.0 : 0.0;
    color_of_line = ink.a > 0.0 ? ink : (rapid && state < 2u ? rapid_ink : inks[state]);
    if ((b.w >> 4) > current) color_of_line.a *= later;
    bool at_end = corner == 1 || corner == 2 || corner == 4;
    float side = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;
    float reach = half_width + 1.0;
    across = side * reach;
    along = at_end ? size : 0.0;
    vec4 c = at_end ? cb : ca;
    float over = at_end ? 0.5 : -0.5;
    vec2 s = (at_end ? sb : sa) + direction * over + vec2(-direction.y, direction.x) * across;
    gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(s / half_size * c.w, c.z, c.w);
}
)";

const char* const line_fragment = R"(#version 330 core
flat in vec4 color_of_line;
flat in float half_width;
flat in float dashed;
noperspective in float across;
noperspective in float along;
out vec4 color;
void main() {
    float cover = clamp(half_width + 0.5 - abs(across), 0.0, 1.0);
    if (dashed > 0.5) cover *= clamp(4.5 - abs(mod(along, 12.0) - 4.0), 0.0, 1.0);
    if (cover <= 0.0) discard;
    color = vec4(color_of_line.rgb, color_of_line.a * cover);
}
)";

/// A square in the plane of a section.
const char* const cap_vertex = R"(#version 330 core
uniform mat4 clip_from_scene;
uniform vec3 middle;
uniform vec3 sides[2];
void main() {
    vec2 at = vec2((gl_VertexID & 1) != 0 ? 1.0 : -1.0, (gl_VertexID & 2) != 0 ? 1.0 : -1.0);
    gl_Position = clip_from_scene * vec4(middle + at.x * sides[0] + at.y * sides[1], 1.0);
}
)";

/// Hatched like a section in a drawing.
const char* const cap_fragment = R"(#version 330 core
uniform vec3 base;
uniform vec4 hatch;
uniform float spacing; // pixels
out vec4 color;
void main() {
    float off = abs(mod(gl_FragCoord.x + gl_FragCoord.y, spacing) - 0.5 * spacing);
    color = vec4(mix(base, hatch.rgb, hatch.a * clamp(1.3 - off, 0.0, 1.0)), 1.0);
}
)";

/// A rectangle on the ground.
const char* const shadow_vertex = R"(#version 330 core
uniform mat4 view_from_body;
uniform mat4 clip_from_view;
uniform vec2 nearer;
uniform vec2 corner;
uniform vec2 size;
uniform vec4 section;
out vec2 at;
void main() {
    at = vec2((gl_VertexID & 1) != 0 ? 1.0 : 0.0, (gl_VertexID & 2) != 0 ? 1.0 : 0.0);
    vec4 p = view_from_body * vec4(corner + at * size, 0.0, 1.0);
    p.xyz = p.xyz * nearer.x + vec3(0.0, 0.0, nearer.y);
    gl_ClipDistance[0] = section.w - dot(section.xyz, vec3(corner + at * size, 0.0));
    gl_Position = clip_from_view * p;
}
)";

const char* const shadow_fragment = R"(#version 330 core
uniform sampler2D mask;
uniform vec4 ink;
in vec2 at;
out vec4 color;
void main() { color = vec4(ink.rgb, ink.a * texture(mask, at).r); }
)";

/// Lines on the ground. w: how strong the line is.
const char* const grid_vertex = R"(#version 330 core
layout(location = 0) in vec4 place;
uniform mat4 view_from_body;
uniform mat4 clip_from_view;
uniform vec2 nearer;
out vec2 ground;
flat out float strength;
void main() {
    vec4 p = view_from_body * vec4(place.xyz, 1.0);
    p.xyz = p.xyz * nearer.x + vec3(0.0, 0.0, nearer.y);
    ground = place.xy;
    strength = place.w;
    gl_Position = clip_from_view * p;
}
)";

/// Lines that fade away from the middle of the view.
const char* const grid_fragment = R"(#version 330 core
uniform vec2 middle;
uniform float reach;
uniform float fine_reach;
uniform vec4 ink;
in vec2 ground;
flat in float strength;
out vec4 color;
void main() {
    float end = strength < 1.0 ? fine_reach : reach;
    float left = clamp(1.0 - distance(ground, middle) / end, 0.0, 1.0);
    color = vec4(ink.rgb, ink.a * strength * left);
}
)";

/// The fraction of the sky over a point that is hidden by nearby surfaces, from depths alone.
/// Source: McGuire, Mara, Luebke: Scalable Ambient Obscurance, 2012.
const char* const hollow_fragment = R"(#version 330 core
uniform sampler2D depths;
uniform mat4 view_from_clip;
uniform float reach;       // mm
uniform float pixels;      // of that reach at depth 1 (w)
uniform mat4 clip_from_view;
out vec4 color;
vec3 place(ivec2 at, vec2 size) {
    float z = texelFetch(depths, at, 0).r;
    vec4 p = view_from_clip * vec4((vec2(at) + 0.5) / size * 2.0 - 1.0, 2.0 * z - 1.0, 1.0);
    return p.xyz / p.w;
}
void main() {
    ivec2 whole = textureSize(depths, 0);
    vec2 size = vec2(whole);
    ivec2 at = ivec2(gl_FragCoord.xy);
    if (texelFetch(depths, at, 0).r >= 1.0) { color = vec4(1.0); return; }
    vec3 p = place(at, size);
    vec3 left = p - place(at - ivec2(1, 0), size), right = place(at + ivec2(1, 0), size) - p;
    vec3 down = p - place(at - ivec2(0, 1), size), up = place(at + ivec2(0, 1), size) - p;
    vec3 across = abs(left.z) < abs(right.z) ? left : right;
    vec3 along = abs(down.z) < abs(up.z) ? down : up;
    vec3 n = normalize(cross(across, along));
    float disc = pixels / (clip_from_view * vec4(p, 1.0)).w;
    float turn = float((at.x & 3) * 4 + (at.y & 3)) * 2.3562;
    float sum = 0.0;
    const int samples = 14;
    for (int i = 0; i < samples; ++i) {
        float share = (float(i) + 0.5) / float(samples);
        float angle = turn + float(i) * 2.39996;
        ivec2 to = at + ivec2(round(disc * share * vec2(cos(angle), sin(angle))));
        to = clamp(to, ivec2(0), whole - 1);
        vec3 v = place(to, size) - p;
        float near = dot(v, v);
        float fade = max(reach * reach - near, 0.0) / (reach * reach);
        sum += fade * fade * max((dot(v, n) - 0.02 * reach) / (sqrt(near) + 0.05 * reach), 0.0);
    }
    color = vec4(vec3(max(1.0 - 2.4 * sum / float(samples), 0.2)), 1.0);
}
)";

/// The mean over the block of pixels whose sample patterns are rotated differently, using only
/// pixels of similar depth.
const char* const smooth_fragment = R"(#version 330 core
uniform sampler2D depths;
uniform sampler2D hollows;
out vec4 color;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
    float own = texelFetch(depths, at, 0).r;
    float step = abs(texelFetch(depths, min(at + ivec2(1, 1), last), 0).r - own)
                 + 0.02 * (1.0 - own);
    float sum = 0.0, count = 0.0;
    for (int j = -2; j < 2; ++j)
        for (int i = -2; i < 2; ++i) {
            ivec2 to = clamp(at + ivec2(i, j), ivec2(0), last);
            float weight = abs(texelFetch(depths, to, 0).r - own) <= 4.0 * step ? 1.0 : 0.001;
            sum += weight * texelFetch(hollows, to, 0).r;
            count += weight;
        }
    color = vec4(vec3(sum / count), 1.0);
}
)";

} // namespace render::shaders
